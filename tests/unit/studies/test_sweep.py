"""A sweep in this process: labelled data, cases without an answer, a folder that goes on."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import petalfoil
from petalfoil import plot
from petalfoil.errors import StoreError, UsageError
from petalfoil.plot.study_views import in_unit, of_cases, parameters, result, shown_results
from petalfoil.results.store import load
from petalfoil.studies import study_store as folders
from petalfoil.studies.case_engine import InThisProcess
from petalfoil.studies.question import CONVERGED, INVALID, CaseOutcome, CaseTask, Question, answered
from petalfoil.studies.run import Execution, resume, stored
from petalfoil.studies.study_definition import Study
from petalfoil.studies.study_summary import results
from petalfoil.studies.sweep import sweep, sweep_study
from tests.cases import case

PLAIN = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 16})
ALONE = Execution(workers=0)
VARY = {"bearing.journal_radius": [24.95e-3, 24.96e-3], "operation.speed": "3000 rad/s : 5000 rad/s : 3"}


def a_sweep(out: Path | None = None, **changes: object) -> xr.Dataset:
    return sweep(PLAIN, VARY, "solve", out=out, execution=Execution(**{"workers": 0, **changes}))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, xr.Dataset]:
    folder = tmp_path_factory.mktemp("study") / "sweep"
    return folder, a_sweep(folder)


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures take longer than these cases; the study of the fixture above has them."""
    monkeypatch.setattr("petalfoil.studies.study_page.write_page", lambda folder, ds: None)


def test_results_have_the_parameters_as_dimensions(swept: tuple[Path, xr.Dataset]) -> None:
    _, ds = swept
    assert ds["bearing_force"].dims == ("journal_radius", "speed")
    assert ds["converged"].values.all()
    assert ds["journal_radius"].attrs["path"] == "bearing.journal_radius"
    one = petalfoil.solve(PLAIN.replace(**{"bearing.journal_radius": 24.96e-3, "operation.speed": 4000.0}))
    assert float(ds["bearing_force"].sel(journal_radius=24.96e-3, speed=4000.0)) == float(one["bearing_force"])


def test_the_folder_holds_data_table_figures_and_page(swept: tuple[Path, xr.Dataset]) -> None:
    folder, ds = swept
    assert load(folder / "study.nc").identical(ds)
    assert stored(folder).identical(ds)
    lines = (folder / "table.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 7
    assert lines[0].startswith("journal_radius [m],speed [rad s-1],converged,status,reason")
    assert (folder / "figures" / "results.png").stat().st_size > 10_000
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "6 cases, 6 converged" in page
    assert "http" not in page.replace("http://www.w3.org", "")


def test_a_case_without_an_answer_is_data() -> None:
    ds = sweep(PLAIN, {"operation.eccentricity.y": [0.0, "-1 mm"]}, "solve", execution=ALONE)
    assert ds["status"].values.tolist() == [CONVERGED, INVALID]
    assert "touches the bushing" in str(ds["reason"].values[1])
    assert np.isnan(ds["bearing_force"].values[1])
    assert ds["converged"].values.tolist() == [True, False]


def test_a_series_has_its_points_as_a_dimension() -> None:
    ds = sweep(
        PLAIN, {"operation.speed": [3000.0, 4000.0]}, "curve", execution=ALONE, eccentricities=[0.0, 10e-6, 20e-6]
    )
    assert ds["bearing_force"].dims == ("speed", "point")
    assert (np.diff(ds["bearing_force"].values, axis=1) > 0.0).all()


class Killed(BaseException):
    """Stands for a process that is ended."""


class Dying(InThisProcess):
    """Dies after a number of cases."""

    def __init__(self, after: int) -> None:
        super().__init__()
        self.after = after

    def outcomes(self, tasks: Iterable[CaseTask]) -> Iterator[CaseOutcome]:
        for number, outcome in enumerate(super().outcomes(tasks)):
            if number == self.after:
                raise Killed
            yield outcome


def test_a_study_goes_on_where_it_was_stopped(
    swept: tuple[Path, xr.Dataset], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from petalfoil.studies import run as running

    with monkeypatch.context() as patch:
        patch.setattr(running, "engine", lambda *_: _given(Dying(4)))
        with pytest.raises(Killed):
            a_sweep(tmp_path)
    (tmp_path / ".study.nc.1-ab.part").write_text("left by a killed process")
    half = stored(tmp_path)
    assert int(half["converged"].sum()) == 4
    assert "not asked" in half["status"].values
    asked: list[str] = []
    monkeypatch.setattr("petalfoil.studies.case_engine.answered", lambda task: asked.append(task.key) or answered(task))
    whole = resume(tmp_path, ALONE)
    assert len(asked) == 2
    assert whole.identical(swept[1])
    assert not list(tmp_path.glob(".*.part"))


def _given(engine: InThisProcess) -> object:
    from contextlib import nullcontext

    return nullcontext(engine)


def test_a_finished_study_asks_nothing_again(swept: tuple[Path, xr.Dataset], monkeypatch: pytest.MonkeyPatch) -> None:
    folder, ds = swept
    monkeypatch.setattr("petalfoil.studies.case_engine.answered", lambda task: pytest.fail("asked again"))
    assert resume(folder, ALONE).identical(ds)


def test_another_study_is_refused_or_replaced(swept: tuple[Path, xr.Dataset], tmp_path: Path) -> None:
    sweep(PLAIN, {"operation.speed": [3000.0]}, "solve", out=tmp_path, execution=ALONE)
    with pytest.raises(UsageError, match=r"holds another study \(not the same: what varies\).*--anew"):
        a_sweep(tmp_path)
    assert a_sweep(tmp_path, anew=True).identical(swept[1])


def test_another_version_is_refused(tmp_path: Path) -> None:
    study = sweep_study(PLAIN, {"operation.speed": [3000.0]}, Question("solve"))
    tmp_path.mkdir(exist_ok=True)
    Study(**{**study.__dict__, "version": "0.0.1"}).save(tmp_path)
    with pytest.raises(UsageError, match=r"petalfoil 0\.0\.1 began this study"):
        resume(tmp_path, ALONE)
    with pytest.raises(UsageError, match="the version of petalfoil"):
        sweep(PLAIN, {"operation.speed": [3000.0]}, "solve", out=tmp_path, execution=ALONE)


def test_a_definition_comes_back_from_its_file(swept: tuple[Path, xr.Dataset]) -> None:
    study = Study.load(swept[0])
    assert study.differences(sweep_study(PLAIN, VARY, Question("solve"))) == []


def test_two_processes_do_not_run_one_study(tmp_path: Path) -> None:
    study = sweep_study(PLAIN, {"operation.speed": [3000.0]}, Question("solve"))
    with folders.begun(tmp_path, study), pytest.raises(UsageError, match="is being run by another process"):
        sweep(PLAIN, {"operation.speed": [3000.0]}, "solve", out=tmp_path, execution=ALONE)


def test_a_folder_of_others_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years")
    with pytest.raises(UsageError, match=r"holds other files \(thesis.tex\)"):
        a_sweep(tmp_path, anew=True)
    assert (tmp_path / "thesis.tex").read_text() == "years"
    with pytest.raises(StoreError, match="is no folder of a study"):
        stored(tmp_path)


def test_a_damaged_index_is_a_store_error(tmp_path: Path) -> None:
    sweep(PLAIN, {"operation.speed": [3000.0]}, "solve", out=tmp_path, execution=ALONE)
    for name in ("index.sqlite-wal", "index.sqlite-shm"):
        (tmp_path / name).unlink(missing_ok=True)
    (tmp_path / "index.sqlite").write_bytes(b"no database" * 1000)
    with pytest.raises(StoreError, match=r"index\.sqlite cannot be read"):
        stored(tmp_path)


def test_one_key_for_one_case_and_question() -> None:
    question, base = Question("solve"), PLAIN.to_toml()
    key = question.key(base, {"a": 1.0, "b": 2})
    assert key == question.key(base, {"b": 2, "a": 1.0})
    others = [question.key(base, {"a": 1.0, "b": 3}), Question("static").key(base, {"a": 1.0, "b": 2})]
    others += [
        question.key(base + " ", {"a": 1.0, "b": 2}),
        Question("solve", {"speed": 1.0}).key(base, {"a": 1.0, "b": 2}),
    ]
    assert key not in others


def test_the_index_keeps_one_row_a_case(tmp_path: Path) -> None:
    study = sweep_study(PLAIN, {"operation.speed": [3000.0]}, Question("solve"))
    with folders.begun(tmp_path, study) as store:
        store.add(CaseOutcome("k", {}, CONVERGED, records=[{"bearing_force": 1.0 / 3.0}]))
        store.add(CaseOutcome("k", {}, CONVERGED, records=[{"bearing_force": 2.0}]))
        kept = store.get("k")
    assert kept is not None
    assert kept.records == [{"bearing_force": 1.0 / 3.0}]
    rows = sqlite3.connect(tmp_path / "index.sqlite").execute("SELECT COUNT(*) FROM cases").fetchone()
    assert rows == (1,)


def test_fields_are_written_where_they_are_asked_for(tmp_path: Path) -> None:
    sweep(PLAIN, {"operation.speed": [3000.0]}, "solve", out=tmp_path, execution=Execution(workers=0, fields=True))
    (file,) = (tmp_path / "fields").glob("*.nc")
    assert_allclose(load(file)["speed"], 3000.0)
    assert "pressure" in load(file)


def test_progress_tells_rate_and_time_left() -> None:
    told: list[tuple[float, str]] = []
    sweep(
        PLAIN,
        {"operation.eccentricity.y": [0.0, "-1 mm"]},
        "solve",
        execution=Execution(workers=0, progress=lambda part, text: told.append((part, text))),
    )
    assert [part for part, _ in told] == [0.5, 1.0]
    assert "2 of 2 cases" in told[-1][1]
    assert "a second, 0 s left, 1 without an answer" in told[-1][1]


@pytest.mark.parametrize(
    ("ask", "arguments", "words"),
    [
        ("blance", {}, "Did you mean 'balance'?"),
        ("balance", {"lod": "3 N"}, "balance has no argument 'lod'; known: load"),
        ("balance", {"load": "3 m"}, "load: '3 m' measures something else"),
        ("solve", {"speed": "3000 rad/s"}, "operation.speed varies, but speed of solve stands in for it"),
        ("orbit", {"restart": "before.nc"}, "restart is the result of one case"),
    ],
)
def test_a_question_that_cannot_be_is_refused(ask: str, arguments: dict[str, str], words: str) -> None:
    with pytest.raises(petalfoil.PetalfoilError) as refused:
        sweep(PLAIN, {"operation.speed": [1.0, 2.0]}, ask, execution=ALONE, **arguments)
    assert words in str(refused.value)


def test_nothing_that_varies_is_refused() -> None:
    with pytest.raises(UsageError, match="nothing varies"):
        sweep(PLAIN, {}, "solve", execution=ALONE)
    with pytest.raises(UsageError, match=r"is not a range"):
        sweep(PLAIN, {"operation.speed": "1000 rpm : 2000 rpm"}, "solve", execution=ALONE)


def test_the_force_of_a_centred_journal_is_zero_in_tables_and_figures(swept: tuple[Path, xr.Dataset]) -> None:
    """Rounding of 1e-11 N that scatters from case to case is no result that varies."""
    _, ds = swept
    assert "bearing_force" in results(ds)
    rounded = ds.assign({name: 1e-11 / ds["speed"] * (ds[name] * 0.0 + 1.0) for name in ("bearing_force", "force_y")})
    assert not {"bearing_force", "force_y"} & {*results(rounded), *shown_results(rounded)}
    assert_allclose(in_unit(rounded, "bearing_force", result(rounded, "bearing_force")), 0.0, atol=0.0)


def test_a_grid_of_three_parameters_is_drawn_and_one_of_a_single_level_is_no_dimension() -> None:
    vary = {
        "operation.speed": [3000.0, 4000.0],
        "gas.viscosity": [1.8e-5, 1.9e-5, 2e-5],
        "bearing.length": [0.04, 0.05],
    }
    ds = sweep(PLAIN, vary, "solve", execution=ALONE)
    lines = plot.study(ds, ("bearing_force",)).axes[0].lines
    assert len(lines) >= 12  # one for each case
    ends = {float(line.get_ydata()[1]) for line in lines if len(line.get_ydata()) == 4}
    assert ends == {0.0, 0.5, 1.0}  # the three levels of the second parameter
    single = ds.isel(length=[0])
    assert parameters(of_cases(single)) == ["speed", "viscosity"]
    assert of_cases(single)["converged"].dims == ("speed", "viscosity")
    assert set(plot.study_figures(single)) == {"results"}


def test_a_load_finds_the_position_so_that_a_design_need_not_fit_at_that_of_the_case() -> None:
    displaced = PLAIN.replace(**{"operation.eccentricity": (0.0, -20e-6)})
    tight = {"bearing.journal_radius": [PLAIN.bearing.bushing_radius - 15e-6]}
    found = sweep(displaced, tight, "balance", load=20.0, execution=ALONE)
    assert found["status"].values.tolist() == [CONVERGED]
    assert sweep(displaced, tight, "solve", execution=ALONE)["status"].values.tolist() == [INVALID]
