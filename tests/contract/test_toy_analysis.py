"""A new analysis is one file: declared here, it has a function, a command, JSON, table, file, figure and refusals."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner, Result

import petalfoil
from petalfoil import plot
from petalfoil.analysis.arguments import Load, NumbersWithUnit, NumberWithUnit, Speed
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.known_verbs import forget
from petalfoil.analysis.operating_point import at
from petalfoil.analysis.records import asked_position, geometry
from petalfoil.analysis.runs import Points
from petalfoil.case import Case
from petalfoil.cli.app import app
from petalfoil.equilibrium.run_context import Progress
from petalfoil.errors import UnitError, UsageError
from petalfoil.results.layout import Series, SinglePoint, at_speed
from petalfoil.results.parts import RunOutcome, scalars_of
from petalfoil.results.record import Record
from petalfoil.results.schema import COORDINATES, FIELDS, SCALARS, VARIABLES
from petalfoil.results.store import load as load_result
from petalfoil.results.variable import Role, TableLabel, Variable
from tests.cases import EXAMPLES, case

PLAIN = case("plain_journal")
PATH = str(EXAMPLES / "plain_journal.toml")
RPM = 3.141592653589793 / 30.0

# ---------------------------------------------------------------------------------------------- the analysis

Gap = Annotated[float, NumberWithUnit(unit="m", help='Film thickness of the estimate: "30 um".', above=0.0)]
Several = Annotated[
    Sequence[float] | None, NumbersWithUnit(unit="rad/s", metavar="LIST", help="Several speeds.", above=0.0)
]

RESULTS = {
    "petroff_torque": Variable(
        (), "N m", "torque of a concentric journal", "M_P", shown=TableLabel("Petroff torque", "mN·m", 1e3)
    ),
    "petroff_gap": Variable(
        (), "m", "film thickness of the estimate", "h_P", role=Role.GIVEN, shown=TableLabel("gap", "µm", 1e6)
    ),
}


@dataclass(frozen=True)
class Estimate:
    """What the analysis finds."""

    petroff_torque: float
    petroff_gap: float


def install() -> None:
    """Declare the analysis."""

    @analysis(SinglePoint(), Series(at=at_speed), excludes={"speed": ("speeds",)}, results=RESULTS)
    def petroff(
        case: Case,
        gap: Gap = 30e-6,
        *,
        load: Load = None,
        speed: Speed = None,
        speeds: Several = None,
        progress: Progress | None = None,
    ) -> Record | Points:
        """Estimate the torque of a concentric journal.

        The film has the same thickness all round.

        Example: petalfoil petroff case.toml --gap "30 um"
        """
        del load, progress
        if speeds is None:
            return estimate(at(case, speed), gap)
        return Points(over(case, speeds, gap), len(speeds))


def over(case: Case, speeds: Sequence[float], gap: float) -> Iterator[Record]:
    for number, speed in enumerate(speeds):
        if STOP_AT[-1] == number:
            raise KeyboardInterrupt
        yield estimate(at(case, speed), gap)


STOP_AT = [-1]
"""Point at which the user presses Ctrl-C; none if negative."""


def estimate(case: Case, gap: float) -> Record:
    radius, length = case.bearing.journal_radius, case.bearing.length
    torque = 2.0 * 3.141592653589793 * case.gas.viscosity * case.operation.speed * radius**3 * length / gap
    scalars = scalars_of(*geometry(case), asked_position(case), Estimate(torque, gap), RunOutcome())
    return Record(analysis="petroff", scalars=scalars, case_toml=case.to_toml(), title=case.title)


# ---------------------------------------------------------------------------------------------- its faces

Call = Callable[..., Result]


@pytest.fixture(autouse=True)
def declared() -> Iterator[None]:
    """The analysis, for one test."""
    install()
    yield
    forget("petroff")
    for name in RESULTS:
        for table in (SCALARS, FIELDS, COORDINATES, VARIABLES):
            table.pop(name, None)


@pytest.fixture
def cli() -> Call:
    return lambda *arguments: CliRunner().invoke(app, list(arguments), prog_name="petalfoil")


def torque(speed: float, gap: float) -> float:
    case = PLAIN
    radius, length = case.bearing.journal_radius, case.bearing.length
    return 2.0 * 3.141592653589793 * case.gas.viscosity * speed * radius**3 * length / gap


def test_it_is_a_function_of_numbers_and_texts() -> None:
    ds = petalfoil.petroff(PLAIN, "20 um", speed="60000 rpm")
    assert_allclose(float(ds["petroff_torque"]), torque(60000.0 * RPM, 20e-6), rtol=1e-12)
    assert ds["petroff_torque"].attrs["units"] == "N m"
    again = petalfoil.petroff(PLAIN, 20e-6, speed=60000.0 * RPM)
    assert_allclose(float(again["petroff_torque"]), float(ds["petroff_torque"]), rtol=1e-12)
    several = petalfoil.petroff(PLAIN, speeds=["100 rad/s", 200.0])
    assert_allclose(several["petroff_torque"], [torque(100.0, 30e-6), torque(200.0, 30e-6)], rtol=1e-12)
    assert "gap : NumberWithUnit, optional" in petalfoil.petroff.__doc__


def test_it_is_a_command_with_options_and_help(cli: Call) -> None:
    assert "petroff" in cli("--help").stdout
    assert "Estimate the torque of a concentric journal." in cli("--help").stdout
    shown = cli("petroff", "--help").stdout
    for text in ("--gap", "--load", "--speeds", "--json", "--out", "--plot", "3e-05 m", "Example: petalfoil petroff"):
        assert text in shown


def test_json_table_file_and_show(cli: Call, tmp_path: Path) -> None:
    out = str(tmp_path / "petroff.nc")
    answer = json.loads(cli("petroff", PATH, "--gap", "20 um", "--json").stdout)
    assert_allclose(answer["petroff_torque"], torque(PLAIN.operation.speed, 20e-6), rtol=1e-12)
    for options in (["--gap", "20 um"], ["--speeds", "100 rad/s : 300 rad/s : 3"]):
        for flags in ([], ["--json"]):
            run, again = cli("petroff", PATH, *options, *flags, "--out", out), cli("show", out, *flags)
            assert (run.exit_code, run.stderr) == (0, "")
            assert again.stdout == run.stdout
    assert load_result(out).sizes["point"] == 3
    table = cli("petroff", PATH, "--gap", "20 um").stdout
    (row,) = (line.split() for line in table.splitlines() if line.startswith("Petroff torque"))
    assert row == ["Petroff", "torque", f"{1e3 * torque(PLAIN.operation.speed, 20e-6):.3f}", "mN·m"]


def test_it_is_drawn(cli: Call, tmp_path: Path) -> None:
    for name, options in (("point.png", []), ("series.svg", ["--speeds", "100 : 300 : 3"])):
        assert cli("petroff", PATH, *options, "--plot", str(tmp_path / name)).exit_code == 0
        assert (tmp_path / name).stat().st_size > 1000
    (ax,) = plot.summary(petalfoil.petroff(PLAIN, speeds="100 : 300 : 3")).axes
    (line,) = ax.lines
    for drawn in (line.get_xdata(), line.get_ydata()):  # in the units of the figure, both grow with the speed
        assert_allclose(drawn / drawn[0], [1.0, 2.0, 3.0], rtol=1e-12)


def test_an_interrupt_keeps_what_is_finished(cli: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.contract.test_toy_analysis.STOP_AT", [2])
    out = tmp_path / "petroff.nc"
    result = cli("petroff", PATH, "--speeds", "100 rad/s : 300 rad/s : 3", "--json", "--out", str(out))
    assert result.exit_code == 130
    assert result.stderr == "interrupted: 2 of 3 points are finished and kept\n"
    assert (len(json.loads(result.stdout)["points"]), load_result(out).sizes["point"]) == (2, 2)


def test_refusals_name_argument_or_option_and_unit(cli: Call) -> None:
    with pytest.raises(UnitError, match="gap: '20 N' measures something else"):
        petalfoil.petroff(PLAIN, "20 N")
    with pytest.raises(UsageError, match=r"gap: 0\.0 is outside its range; allowed: greater than 0 m"):
        petalfoil.petroff(PLAIN, 0.0)
    with pytest.raises(UsageError, match="speed says nothing beside speeds"):
        petalfoil.petroff(PLAIN, speed=1.0, speeds=[1.0])
    for options, reason in (
        (["--gap", "20 N"], "--gap: '20 N' measures something else"),
        (["--gap", "-1 um"], "--gap: '-1 um' is outside its range"),
        (["--speed", "1", "--speeds", "1, 2"], "--speed says nothing beside --speeds"),
        (["--out", "x.txt"], "--out: x.txt has the suffix '.txt'"),
    ):
        result = cli("petroff", PATH, *options)
        assert (result.exit_code, result.stdout) == (2, "")
        assert reason in result.stderr


def test_a_result_keeps_its_declaration() -> None:
    other = Variable((), "N m", "another torque", "M")
    with pytest.raises(ValueError, match="'petroff_torque' is already declared"):
        analysis(SinglePoint(), results={"petroff_torque": other})(lambda case: None)
