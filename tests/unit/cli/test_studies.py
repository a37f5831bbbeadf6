"""Studies on the command line: sweep, study show, resume and export, and what is refused before anything runs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from petalfoil.case import Case
from petalfoil.cli.app import app
from petalfoil.results.store import load
from tests.cases import EXAMPLES

PATH = str(EXAMPLES / "plain_journal.toml")
VARY = ["--vary", "operation.eccentricity.y=0 um, -20 um, -1 mm", "--vary", "model.cells_per_pitch=16, 20"]


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.studies.study_page.write_page", lambda folder, ds: None)


def run(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


@pytest.fixture(scope="module")
def two_d(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("cases") / "plain.toml"
    path.write_text(Case.load(PATH).replace(**{"model.kind": "2d"}).to_toml())
    return str(path)


@pytest.fixture(scope="module")
def swept(two_d: str, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    folder = tmp_path_factory.mktemp("study") / "sweep"
    return folder, run("sweep", two_d, *VARY, "--out", str(folder), "--workers", "0")


def test_a_sweep_tells_counts_ranges_and_reasons(swept: tuple[Path, Result]) -> None:
    folder, done = swept
    assert done.exit_code == 0, done.output
    assert "sweep of solve: 6 cases, 4 converged, 2 invalid case" in done.stdout
    assert "operation.eccentricity.y = 0 um, -20 um, -1 mm" in done.stdout
    assert "bearing force" in done.stdout
    assert f"Folder: {folder}" in done.stdout
    assert "2 without an answer (-1 mm, 16; -1 mm, 20): invalid case: operation.eccentricity: the" in done.stderr
    assert " ".join(done.stdout.split()).count("0 m, 16 0 m, 20 -20 µm, 16") == 1  # a column for each of a few cases
    assert "processor time: " in done.stderr


@pytest.mark.slow
def test_a_study_is_shown_again_and_drawn(swept: tuple[Path, Result], tmp_path: Path) -> None:
    shown = run("study", "show", str(swept[0]), "--json", "--of", "bearing_force", "--plot", str(tmp_path / "f.png"))
    assert shown.exit_code == 0, shown.output
    told = json.loads(shown.stdout)
    assert told["cases"] == {"converged": 4, "invalid case": 2}
    assert told["results"]["bearing_force"]["least"] < told["results"]["bearing_force"]["greatest"]
    assert (tmp_path / "f.png").stat().st_size > 5_000
    again = run("show", str(swept[0] / "study.nc"), "--json", "--plot", str(tmp_path / "h.png"))
    assert json.loads(again.stdout)["results"] == told["results"]
    assert (tmp_path / "h.png").stat().st_size > 5_000
    wrong = run("study", "show", str(swept[0]), "--of", "bearing_forc", "--plot", str(tmp_path / "g.png"))
    assert wrong.exit_code == 2
    assert "the study has no result 'bearing_forc'; it has" in wrong.stderr


def test_a_study_goes_on(swept: tuple[Path, Result]) -> None:
    again = run("study", "resume", str(swept[0]), "--workers", "0")
    assert again.exit_code == 0, again.output
    assert "6 cases, 4 converged" in again.stdout


def test_a_study_is_exported(swept: tuple[Path, Result], tmp_path: Path) -> None:
    for name in ("all.nc", "all.csv"):
        assert run("study", "export", str(swept[0]), "--to", str(tmp_path / name)).exit_code == 0
    assert load(tmp_path / "all.nc").identical(load(swept[0] / "study.nc"))
    assert (tmp_path / "all.csv").read_bytes() == (swept[0] / "table.csv").read_bytes()
    target = tmp_path / "three.toml"
    assert run("study", "export", str(swept[0]), "--case", "3", "--to", str(target)).exit_code == 0
    made = Case.load(target)
    assert made.operation.eccentricity == (0.0, -20e-6)
    assert made.cells_per_pitch == 20
    assert "is there already" in run("study", "export", str(swept[0]), "--case", "3", "--to", str(target)).stderr
    missing = run("study", "export", str(swept[0]), "--case", "9", "--to", str(tmp_path / "x.toml"))
    assert "there is no case 9; allowed: 0 to 5" in missing.stderr


def test_options_are_those_of_the_analysis_that_is_asked() -> None:
    assert "--eccentricity" in run("sweep", "--help").stdout
    helped = run("sweep", "--ask", "balance", "--help").stdout
    assert "--load" in helped
    assert "--eccentricity" not in helped
    assert "sweep" in run("--help").stdout


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--vary", "operation.sped=1,2"], "Did you mean 'operation.speed'?"),
        (["--vary", "operation.speed"], "is no PATH=VALUES"),
        (["--vary", "operation.speed=1,2", "--vary", "operation.speed=3"], "operation.speed is given twice"),
        (["--vary", "operation.speed=1 N,2 N"], "measures something else"),
        (["--vary", "operation.speed=1,2", "--ask", "blance"], "Did you mean 'balance'?"),
        (
            ["--vary", "operation.speed=1,2", "--ask", "balance", "--load", "3 m"],
            "--load: '3 m' measures something else",
        ),
        (["--vary", "operation.speed=1,2", "--speed", "3"], "operation.speed varies, but speed of solve"),
        (["--vary", "operation.speed=1,2", "--sample", "lsh 20"], "is no sample"),
        (["--vary", "operation.speed=1,2", "--memory", "1 MB"], "at least 256 MiB"),
        (["--vary", "operation.speed=1,2", "--memory", "1 N"], "--memory: '1 N'"),
        (["--vary", "petals.thickness=1,2"], "The case has no table [petals]."),
    ],
)
def test_bad_input_is_refused_before_anything_runs(words: list[str], told: str, tmp_path: Path) -> None:
    refused = run("sweep", PATH, *words, "--out", str(tmp_path / "study"))
    assert refused.exit_code == 2, refused.output
    assert told in refused.stderr
    assert not (tmp_path / "study").exists()


def test_a_study_without_any_answer_has_an_exit_code(two_d: str, tmp_path: Path) -> None:
    words = ["sweep", two_d, "--vary", "operation.eccentricity.y=-1 mm, -2 mm", "--workers", "0"]
    failed = run(*words, "--out", str(tmp_path / "study"), "--json")
    assert failed.exit_code == 3
    assert json.loads(failed.stdout)["cases"] == {"invalid case": 2}


@pytest.mark.slow
def test_tolerance_tells_how_likely_limits_are_kept(two_d: str, tmp_path: Path) -> None:
    words = ["tolerance", two_d, "--scatter", "gas.viscosity=± 2 %", "--eccentricity", "0 um, -20 um"]
    words_of_run = ["--limit", "bearing_force > 1 N", "--samples", "8", "--workers", "0", "--out", str(tmp_path / "t")]
    done = run(*words, *words_of_run)
    assert done.exit_code == 0, done.output
    assert "tolerance of solve: 8 cases, 8 converged" in done.stdout
    assert "100.0 %   63.1 to 100.0 %" in done.stdout
    assert "first order" in done.stdout
    refused = run(*words, "--limit", "bearing_forc > 1 N", "--out", str(tmp_path / "u"))
    assert "Did you mean 'bearing_force'?" in refused.stderr


@pytest.mark.slow
def test_optimize_tells_the_best_design(two_d: str, tmp_path: Path) -> None:
    words = ["optimize", two_d, "--vary", "operation.speed=1000 rad/s : 9000 rad/s", "--eccentricity", "0 um, -10 um"]
    goal = ["--maximize", "bearing_force", "--subject", "power_loss < 30 W", "--budget", "20", "--workers", "0"]
    done = run(*words, *goal, "--out", str(tmp_path / "o"), "--json")
    assert done.exit_code == 0, done.output
    (best,) = json.loads(done.stdout)["optimum"]["best"]
    assert best["results"]["power_loss"] == pytest.approx(30.0, rel=1e-3)
    shown = run("study", "show", str(tmp_path / "o"))
    assert "optimize of solve: " in shown.stdout
    assert "1 best" in shown.stdout
    refused = run(*words, "--out", str(tmp_path / "p"))
    assert "nothing to optimize" in refused.stderr
    assert run(*words, *goal, "--method", "sqp", "--out", str(tmp_path / "p")).exit_code == 2


@pytest.mark.slow
def test_sensitivity_with_samples_is_a_study(two_d: str, tmp_path: Path) -> None:
    words = ["sensitivity", two_d, "--samples", "8", "--vary", "gas.viscosity=± 2 %", "--vary", "operation.speed=± 5 %"]
    done = run(
        *words, "--eccentricity", "0 um, -5 um", "--of", "bearing_force", "--workers", "0", "--out", str(tmp_path / "s")
    )
    assert done.exit_code == 0, done.output
    assert "sobol of solve: 32 cases, 32 converged" in done.stdout
    assert "operation.speed" in done.stdout
    assert "8 of 8" in done.stdout
    assert "PATH=RANGE" in run("sensitivity", "--samples", "8", "--help").stdout
    assert "PATH=RANGE" not in run("sensitivity", "--help").stdout
