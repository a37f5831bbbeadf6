"""The options all verbs share, declared once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import typer

CaseFile: TypeAlias = Annotated[Path, typer.Argument(metavar="CASE", help="Case to run, a TOML file.")]
ResultFile: TypeAlias = Annotated[Path, typer.Argument(metavar="RESULT", help="Result to show, written by --out.")]

Speed: TypeAlias = Annotated[
    str | None,
    typer.Option(metavar="QUANTITY", help='Speed instead of the case\'s: "8000 rad/s", "60000 rpm".'),
]
Position: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--eccentricity",
        metavar="X,Y",
        help='Displacement of the journal instead of the case\'s: "0 um, -100 um".',
    ),
]
Displacements: TypeAlias = Annotated[
    str,
    typer.Option(
        "--eccentricity",
        metavar="START:STOP:COUNT",
        help='Displacements along the direction: "0 um : 280 um : 15"; or a list or single one: "100 um".',
    ),
]
Direction: TypeAlias = Annotated[
    str,
    typer.Option(metavar="ANGLE", help="Direction of the displacements, from x toward y."),
]
Load: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="LOAD",
        help='Load on the journal instead of the case\'s: "0 N, -50 N"; a single value acts along -y.',
    ),
]
Loads: TypeAlias = Annotated[
    str,
    typer.Option("--load", metavar="LOADS", help='Loads along -y: "46.4 N, 55.6 N", or "10 N : 100 N : 10".'),
]
Share: TypeAlias = Annotated[
    str,
    typer.Option(metavar="SHARE", help="Share of the contacts below which the journal floats."),
]
Top: TypeAlias = Annotated[
    str,
    typer.Option("--to", metavar="QUANTITY", help='Speed to run up to, and back from: "30000 rpm".'),
]
Points: TypeAlias = Annotated[int, typer.Option(metavar="COUNT", help="Speeds on the way up, rest included.")]
Frequencies: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--frequency",
        metavar="LIST",
        help='Whirl frequencies: "4000 rad/s, 8000 rad/s", or "0 rad/s : 9000 rad/s : 10"; by default the speed.',
    ),
]
Amplitude: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="QUANTITY",
        help='Amplitude of the whirl at which petals with friction rub: "1 um"; by default they stick.',
    ),
]
Speeds: TypeAlias = Annotated[
    str | None,
    typer.Option(metavar="LIST", help='Several speeds instead of one: "20000 rpm : 60000 rpm : 5".'),
]
ChartLoads: TypeAlias = Annotated[
    str | None,
    typer.Option("--loads", metavar="LIST", help='Several loads along -y instead of one: "10 N, 20 N".'),
]
Mass: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="QUANTITY",
        help="Mass of the rotor on this bearing: \"2 kg\"; by default the case's rotor's, or the load's.",
    ),
]
Revolutions: TypeAlias = Annotated[
    float | None,
    typer.Option(metavar="TURNS", help="Turns of the shaft to follow; by default to the end of the ramp, else 20."),
]
Duration: TypeAlias = Annotated[
    str | None,
    typer.Option(metavar="QUANTITY", help='Time to follow, instead of turns: "10 ms".'),
]
Initial: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="X,Y",
        help='Where the journal is let go, instead of the case\'s eccentricity: "10 um, 0 um", or balance for where '
        "the constant load is balanced.",
    ),
]
Loop: TypeAlias = Annotated[
    bool, typer.Option("--loop", help="There, back and there again: the hysteresis of petals with friction.")
]
Ramp: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="FROM:TO:DURATION",
        help='Speed that changes: "0 rpm : 60000 rpm : 2 s"; several segments with commas between, one joining the '
        "other. Time counts from the start of the motion, also in a restart.",
    ),
]
Restart: TypeAlias = Annotated[
    Path | None,
    typer.Option(metavar="FILE.nc", help="Go on from the end of a motion that --out wrote, of the same bearing."),
]
Tolerance: TypeAlias = Annotated[
    str,
    typer.Option(metavar="NUMBER", help="Local error of a step in reference films and ambient pressures."),
]
Animate: TypeAlias = Annotated[
    Path | None,
    typer.Option(metavar="FILE.html", help="Animate the last turns: a page of its own (.html) or a picture (.gif)."),
]
Csv: TypeAlias = Annotated[
    Path | None,
    typer.Option("--csv", metavar="FILE.csv", help="Write the coefficients as a table, units in its header."),
]
Ross: TypeAlias = Annotated[
    Path | None,
    typer.Option("--ross", metavar="FILE.toml", help="Write them for ROSS 3: .toml or .json; needs 5 speeds or more."),
]
Levels: TypeAlias = Annotated[int, typer.Option(metavar="COUNT", help="Number of grids, each twice as fine.")]
Coarsest: TypeAlias = Annotated[
    int | None,
    typer.Option(
        metavar="CELLS",
        help="Cells along a pitch of the coarsest grid; by default the case's own grid is the finest, if it can be.",
    ),
]
ErrorBars: TypeAlias = Annotated[
    bool,
    typer.Option("--error", help="Add error bars, from a study on the case's grid and two more."),
]
Json: TypeAlias = Annotated[
    bool,
    typer.Option("--json", help="Print one JSON object in SI units instead of the table."),
]
Out: TypeAlias = Annotated[
    Path | None,
    typer.Option(metavar="FILE.nc", help="Write the whole result to a NetCDF file."),
]
Plot: TypeAlias = Annotated[
    Path | None,
    typer.Option(metavar="FILE.png", help="Draw a figure: .png, .svg or .pdf."),
]

DOWNWARD = "-90 deg"
