"""``petalfoil orbit``: the journal through time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.cli import parsing
from petalfoil.cli.failures import handled
from petalfoil.cli.options import (
    Animate,
    CaseFile,
    Duration,
    Initial,
    Json,
    Load,
    Out,
    Plot,
    Ramp,
    Restart,
    Revolutions,
    Tolerance,
)
from petalfoil.cli.outputs import Export, Outputs
from petalfoil.cli.progress import bar
from petalfoil.errors import UsageError

if TYPE_CHECKING:
    import xarray as xr


def orbit(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    revolutions: Revolutions = None,
    duration: Duration = None,
    initial: Initial = None,
    ramp: Ramp = None,
    load: Load = None,
    restart: Restart = None,
    tolerance: Tolerance = "1e-3",
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
    animate: Animate = None,
) -> None:
    """Follow a rigid rotor through time: film, petals, contacts and journal move together.

    Mass and unbalance stand in the case's section rotor. With --out the file
    is rewritten as the motion grows; Ctrl-C keeps what is done, and --restart
    goes on from it.

    Example: petalfoil orbit case.toml --revolutions 60 --plot orbit.png
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot, exports=_exports(animate))
        _refuse_contradictions(restart, out, initial)
        place, lasts, speeds = parsing.initial(initial), parsing.duration(duration), parsing.ramp(ramp)
        force, error = parsing.load(load), parsing.tolerance(tolerance)

        from petalfoil.analysis.orbit import Orbit, OrbitRequest
        from petalfoil.case import Case
        from petalfoil.cli.following import follow

        course = OrbitRequest(revolutions, lasts, place, speeds, force, error)
        definition, before = Case.load(case), _earlier(restart)

        with bar("orbit") as report:
            answer = follow(Orbit(definition, course, before), out, report)
        outputs.deliver(answer)


def _refuse_contradictions(restart: Path | None, out: Path | None, initial: str | None) -> None:
    if restart is None:
        return
    if initial is not None:
        raise UsageError("--initial says nothing beside --restart, which goes on from where the motion ended")
    if out is not None and out.resolve() == restart.resolve():
        raise UsageError(f"--out: {out} is the motion to go on from; give another name, or it would be lost")


def _earlier(restart: Path | None) -> xr.Dataset | None:
    """The motion to go on from."""
    if restart is None:
        return None
    from petalfoil.results.store import load

    return load(restart)


def _exports(animate: Path | None) -> tuple[Export, ...]:
    """The animation, whose place is checked before the run."""
    if animate is None:
        return ()

    def write(ds: xr.Dataset, path: Path) -> None:
        from petalfoil import plot

        plot.animate(ds, path)

    return (Export(option="--animate", path=animate, suffixes=(".html", ".gif"), write=write),)
