"""Every example is a case that solves; the scripts do what their first lines say."""

from __future__ import annotations

import importlib.util
import re
import runpy
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.case import Case, warnings_of
from petalfoil.results.store import load
from tests.cases import EXAMPLES
from tests.docs.texts import ROOT, text

CASES = sorted(EXAMPLES.glob("*.toml"))
SCRIPTS = sorted(EXAMPLES.glob("*.py"))

# Grid that takes no time; load [N] and friction torque [N m] grid-converged, displaced as the example
# says (`petalfoil converge`, `docs/paper-values.md`); how far off that grid may be.
SMALL = {
    "paper_n6": (32, None, 0.4696, 16.214e-3, 0.02),
    "paper_n8": (32, None, 8.10, 27.33e-3, 0.02),
    "paper_n10": (32, None, 6.713, 33.19e-3, 0.03),
    "paper_n8_spatial": (32, 16, 8.09, 25.33e-3, 0.04),
    "plain_journal": (64, 16, 80.775, 8.5949e-3, 0.008),
    "two_plain_bearings": (64, 16, 20.0, 7.677e-3, 0.002),
    "bump_foil": (64, 32, 50.144, 7.8225e-3, 0.002),
    "single_pad_bump_foil": (64, 32, 537.0, 61.9e-3, 0.1),
    "measured_bump_foil": (64, 32, 50.0, 5.2748e-3, 0.001),
    "orbit_n8": (32, None, 29.616, 27.634e-3, 0.03),
    "backed_petals": (32, None, 9.50, 27.42e-3, 0.03),
    "unequal_petals": (32, None, 8.15, 27.32e-3, 0.02),
    "rig": (32, None, 0.0, 62.2e-3, 0.06),
    "rig_hot": (32, None, 46.4, 38.17e-3, 0.04),
    "unequal_bearings": (32, None, 4.708, 27.35e-3, 0.02),
}

MEANT = {
    "rig": ["min_film_thickness"],
    "rig_hot": ["min_film_thickness"],
    "single_pad_bump_foil": ["contact_fraction"],
}
"""Warnings: the rig ran just above its lift-off speed, on films of a few times its roughness; the single pad carries
the largest load that was measured on it."""


def test_every_example_is_tried() -> None:
    assert {path.stem for path in CASES} == set(SMALL)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_an_example_names_its_assumptions_and_writes_itself(path: Path) -> None:
    case = Case.load(path)
    assert Case.from_toml(case.to_toml()) == case
    assert case.title
    assert case.petals is None or "# assumption" in text(path)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name == "paper_n8_spatial" else ()) for name in SMALL]
)
def test_an_example_solves_without_a_warning_that_is_not_meant(name: str) -> None:
    cells, axial, bearing_force, torque, tolerance = SMALL[name]
    case = Case.load(EXAMPLES / f"{name}.toml").replace(**{"model.cells_per_pitch": cells, "model.axial_cells": axial})
    point = petalfoil.solve(case)
    assert bool(point["converged"])
    assert bool(point["stable"])
    assert float(point["residual"]) <= 1e-8
    assert_allclose(float(point["bearing_force"]), bearing_force, rtol=tolerance, atol=1e-5)
    assert_allclose(float(point["friction_torque"]), torque, rtol=tolerance)
    told = warnings_of(case, {name: value.item() for name, value in point.data_vars.items() if not value.dims})
    assert [line.partition(":")[0] for line in told] == MEANT.get(name, [])


# ---------------------------------------------------------------------------------------------- scripts


def module(path: Path) -> ModuleType:
    """A script of the examples as a module."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = found  # dataclasses look their module up
    spec.loader.exec_module(found)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_without_a_place_to_write_says_how_it_is_called(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [str(path)])
    with pytest.raises(SystemExit) as end:  # a text as its code is printed to standard error, with exit code 1
        runpy.run_path(str(path), run_name="__main__")
    assert str(end.value.code).startswith(f"usage: python examples/{path.name} ")
    assert capsys.readouterr().out == ""


@pytest.mark.slow
def test_the_demo_writes_tables_figures_and_data(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    demo = module(EXAMPLES / "demo.py")
    small = [demo.Task(f"paper_n{n}", f"{n} petals", 64, "0 um : 280 um : 3", (280,), levels=3) for n in (6, 8, 10)]
    space = demo.Task("paper_n8_spatial", "8 petals in 3-D", 16, "0 um : 100 um : 2", (), levels=2)
    monkeypatch.setattr(demo, "TWO_D", small)
    monkeypatch.setattr(demo, "THREE_D", space)
    demo.main(tmp_path)
    printed = capsys.readouterr()
    assert "24.92 ± " in printed.out  # 8 petals at 280 µm on 64 cells per pitch
    assert "8 petals in 3-D: done" in printed.err
    written = {path.name for path in tmp_path.iterdir()}
    assert {f"curve_{task.name}.nc" for task in (*small, space)} <= written
    assert {
        "figure6_7_pressure_and_film.png",
        "figure8_load_characteristic.png",
        "maps_paper_n8_spatial.png",
    } <= written
    curve = load(tmp_path / "curve_paper_n8.nc")
    assert_allclose(curve["bearing_force"].values, [0.0, 11.6, 24.85], rtol=0.02, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "e"), [("2d", 280), ("3d", 100)])
def test_the_paper_s_values_are_those_of_the_script(kind: str, e: int) -> None:
    values = module(EXAMPLES / "paper_values.py")
    page = text(ROOT / "docs" / "paper-values.md")
    (day,) = re.findall(r"Written on\s(\d{4}-\d\d-\d\d) by", page)
    assert page.startswith(values.head(day))
    study = values.run(values.Task(6, kind, e))
    shown = [values.text(study[name], factor) for name, factor in values.RUNNING.items()]
    assert f"| 6 | {e} | {' | '.join(shown)} |" in page


def test_bars_of_the_paper_s_values_are_below_half_a_per_cent() -> None:
    bars = re.findall(r"([\d.]+) ± ([\d.]+)", text(ROOT / "docs" / "paper-values.md"))
    assert len(bars) == 2 * (3 * 12 - 3 + 3 * 2)  # 12 positions in 2-D and 3-D, no force at three; three packs at rest
    assert max(float(bar) / float(value) for value, bar in bars) < 5e-3


def test_values_show_the_digits_that_their_bars_leave() -> None:
    values = module(EXAMPLES / "paper_values.py")
    trusted = values.Extrapolation(limit=17.9603e-6, order=2.1, error=0.0031e-6, trusted=True)
    plain = values.Extrapolation(limit=8.0941, order=np.nan, error=0.42, trusted=False)
    zero = values.Extrapolation(limit=3e-13, order=np.nan, error=2.5e-6, trusted=True)
    assert values.text(trusted, 1e6) == "**17.9603 ± 0.0031**"
    assert values.text(plain, 1.0) == "8.09 ± 0.42"
    assert values.text(zero, 1.0) == "0"


@pytest.mark.slow
def test_the_paper_s_bearing_is_optimized_within_its_limits(tmp_path: Path) -> None:
    script = module(EXAMPLES / "optimize_paper.py")
    found = script.optimized(8, tmp_path, workers=0, budget=16)
    (best,) = found["best"]
    assert best["results"]["bearing_force"] > found["paper"]["bearing_force"]
    assert best["results"]["min_film_thickness"] > 5e-6 * (1.0 - 1e-4)
    assert best["results"]["max_bending_stress"] < 350e6 * (1.0 + 1e-4)
    assert "8 petals: " in script.line(found)


@pytest.mark.long
def test_petals_that_differ_scatter_the_lift_off_of_the_rig(tmp_path: Path) -> None:
    script = module(EXAMPLES / "scatter_rig.py")
    coarse = script.Case.load(EXAMPLES / "rig.toml").replace(**{"model.cells_per_pitch": 32})
    told = script.scattered("± 5 um each", tmp_path, workers=0, samples=8, case=coarse)
    assert told["cases"] == 8.0
    assert told["quantile_95"] > told["quantile_05"]
    assert "each: nominal " in script.line("each", told)
