"""A design keeps what was typed, makes the same case as the file, and reaches no file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from petalfoil.case import Case
from petalfoil.errors import DefinitionError
from petalfoil.studio.design import MOST_BYTES, STARTING_CASE, Design, without_files
from tests.cases import EXAMPLES

NAMES = sorted(path.stem for path in EXAMPLES.glob("*.toml"))


@pytest.mark.parametrize("name", NAMES)
def test_a_design_makes_the_case_of_its_file_and_writes_it_back(name: str) -> None:
    path = EXAMPLES / f"{name}.toml"
    design = Design.from_file(path)
    assert design.case() == Case.load(path)
    assert Case.from_toml(design.to_toml()) == Case.load(path)


def test_texts_stay_as_they_were_typed() -> None:
    design = Design.starting().with_value("petals.thickness", "0.18 mm")
    assert 'thickness = "0.18 mm"' in design.to_toml()
    assert design.with_value("petals.coating", None).get("petals.coating") is None
    assert Design.starting().to_toml().strip() == STARTING_CASE.strip().replace('["0 N", "-15 N"]', design_load())


def design_load() -> str:
    return '[\n    "0 N",\n    "-15 N",\n]'


def test_a_change_leaves_the_design_before_as_it_was() -> None:
    before = Design.starting()
    after = before.with_value("petals.count", 9).with_value("rotor", {})
    assert before.get("petals.count") == 8
    assert "rotor" not in before.tables
    assert after.changes_from(before) == "petals.count 8 → 9"
    assert before.changes_from(before) == "the same"


def test_all_problems_are_told_by_key() -> None:
    design = Design.starting().with_value("petals.thickness", "12 N").with_value("petals.cuont", 3)
    with pytest.raises(DefinitionError) as caught:
        design.case()
    problems = dict(caught.value.problems)
    assert set(problems) == {"petals.thickness", "petals.cuont"}
    assert "Did you mean 'count'?" in problems["petals.cuont"]


@pytest.mark.parametrize("shape", ["/etc/passwd", "shape.csv", "../shape.csv"])
def test_a_case_of_a_browser_names_no_file(shape: str) -> None:
    opened: list[str] = []
    text = Design.starting().with_value("petals.free_shape", shape).to_toml()
    watch(opened)
    with pytest.raises(DefinitionError, match="reads no files"):
        Design.from_toml(text)
    with pytest.raises(DefinitionError, match="reads no files"):
        Design.starting().with_value("petals.free_shape", shape).case()
    watch(None)
    assert [path for path in opened if path.endswith(Path(shape).name)] == []


_LISTS: list[list[str] | None] = [None]


def watch(opened: list[str] | None) -> None:
    """Note the files that are opened, from now on."""
    if not _HOOKED:
        sys.addaudithook(_note)
        _HOOKED.append(True)
    _LISTS[0] = opened


_HOOKED: list[bool] = []


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "open" and _LISTS[0] is not None:
        _LISTS[0].append(str(arguments[0]))


def test_a_measured_shape_of_a_file_becomes_rows(tmp_path: Path) -> None:
    case = Case.load(EXAMPLES / "paper_n8.toml")
    (tmp_path / "shape.csv").write_text("angle [deg], radius [mm]\n0, 25.9\n40, 22.0\n90, 24.0\n99.4, 25.0\n")
    text = case.to_toml().replace("bend_radius = 0.04", 'free_shape = "shape.csv"').replace("0.000176", "0.00005")
    (tmp_path / "case.toml").write_text(text)
    design = Design.from_file(tmp_path / "case.toml")
    assert len(design.get("petals.free_shape")) == 4
    assert design.case().petals == Case.load(tmp_path / "case.toml").petals


def test_a_large_text_is_no_case() -> None:
    with pytest.raises(DefinitionError, match=r"has 65,\d+ bytes"):
        without_files("#" * (MOST_BYTES + 1))


def test_the_lines_of_python_ask_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    title = 'a """ b \\ <script>'
    design = Design.starting().with_value("title", title)
    asked: dict[str, Any] = {}
    monkeypatch.setattr("petalfoil.balance", lambda case, **given: asked.update(case=case, given=given), raising=False)
    exec(design.python("balance", {"speed": "60000 rpm"}), {"print": lambda _: None})
    assert asked["case"] == design.case()
    assert asked["case"].title == title
    assert asked["given"] == {"speed": "60000 rpm"}
