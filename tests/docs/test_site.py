"""The site is complete: pages are listed, keys described, analyses and figures shown in the gallery."""

from __future__ import annotations

import math
import re
import runpy
from typing import Any

import pytest

import petalfoil
from petalfoil import plot
from petalfoil.analysis import known_verbs
from petalfoil.case import Case
from petalfoil.case import keys as case_keys
from tests.docs.site import GALLERY, listed
from tests.docs.texts import DOCS, ROOT, text

NO_FIGURES = {"animate", "register", "save", "study", "study_figures", "summary"}
"""Names of `petalfoil.plot` that draw no figure of their own."""


def test_every_page_stands_in_a_table_of_contents() -> None:
    written = set(DOCS.rglob("*.md")) - {DOCS / "index.md"}
    lost = sorted(path.relative_to(DOCS).as_posix() for path in written - listed() if "gallery" not in path.parts)
    assert lost == [], "move them to docs/how-to or docs/tutorials, or name them in an index.md"


def test_every_key_of_a_case_is_described() -> None:
    described = list(case_keys.keys(Case))
    for name, definition in case_keys.sections().items():
        described += case_keys.keys(definition, f"{name}.")
    assert len(described) > 40
    assert [key.name for key in described if not key.meaning] == [], "write a text below the key in its definition"


def test_the_reference_reads_units_ranges_and_defaults() -> None:
    keys = {key.name: key for section in case_keys.sections().values() for key in case_keys.keys(section)}
    thickness = keys["contact_film_thickness"]
    assert (thickness.symbol, thickness.unit, thickness.default) == ("h_c", "m", "1 µm")
    assert thickness.allowed == "greater than 0 m and at most 0.01 m"
    assert keys["mount"].allowed == '`"hinged"`, `"clamped"`'
    assert keys["mount"].default == "required"
    assert keys["root_tilt"].allowed.endswith('or `"chordal"`')
    assert keys["root_tilt"].default == '`"chordal"`'
    assert (keys["load"].unit, keys["load"].default) == ("N", "–")
    assert keys["symmetry"].allowed == "`true`, `false`"


def test_every_analysis_has_a_script_in_the_gallery() -> None:
    shown = {path.stem.removeprefix("plot_") for path in GALLERY}
    assert set(known_verbs.summaries()) - shown == set(), "add examples/gallery/plot_<verb>.py"


def test_every_figure_is_in_the_gallery() -> None:
    drawn = {name for path in GALLERY for name in re.findall(r"\bplot\.(\w+)\(", text(path))}
    assert set(plot.__all__) - NO_FIGURES - drawn == set()


@pytest.mark.slow
def test_the_tutorial_sizes_a_bearing_that_meets_its_requirements(monkeypatch: pytest.MonkeyPatch) -> None:
    path = ROOT / "examples" / "tutorials" / "plot_size_a_turbocharger_bearing.py"
    monkeypatch.chdir(path.parent)
    names = runpy.run_path(str(path))
    assert float(names["result"]["min_film_thickness"]) >= 2e-6
    assert float(names["result"]["contact_fraction"]) == 0.0
    assert float(names["result"]["max_bending_stress"]) <= 600e6
    assert float(names["liftoff"]["liftoff_speed"][0]) <= 40000.0 * math.pi / 30.0
    assert float(petalfoil.balance(names["first"])["min_film_thickness"]) < 2e-6  # the first guess does not


@pytest.mark.slow
def test_the_tutorial_of_whirl_tells_what_it_says(monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    path = ROOT / "examples" / "tutorials" / "plot_stiffness_damping_whirl.py"
    monkeypatch.chdir(path.parent)
    names = runpy.run_path(str(path))
    assert float(names["stability"]["whirl_ratio"]) == pytest.approx(0.5, abs=0.02)
    assert abs(names["cross"]) < 0.1 * names["direct"]
    masses = [float(mass) for mass in re.findall(r"N: critical mass (\S+) kg", capsys.readouterr().out)]
    assert masses == sorted(masses)
    assert len(masses) == 3
