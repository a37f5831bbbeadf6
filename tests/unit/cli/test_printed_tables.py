"""Lines of label, value and unit as the terminal shows them."""

from __future__ import annotations

import pytest
from rich.console import Console

from petalfoil.cli.printed_tables import _headed, _parts, _rows
from petalfoil.results.tables import TextColumn, TextTable

LINES = [
    ("status", "converged", ""),
    ("speed", "76394", "rpm"),
    ("petal friction", "relaxed: no friction forces between the petals, as vibrations leave the pack", ""),
    ("time", "1.5", "s"),
]


def printed(lines: list[tuple[str, ...]], width: int) -> list[str]:
    console = Console(width=width, markup=False, highlight=False)
    with console.capture() as capture:
        console.print(_rows(TextTable(lines=lines)))
    return [line.rstrip() for line in capture.get().splitlines()]


def test_a_long_text_does_not_move_the_numbers() -> None:
    status, speed, friction, time = printed(LINES, 120)
    assert status == "status          converged"
    assert speed == "speed               76394  rpm"
    assert time == "time                  1.5  s"
    assert friction.startswith("petal friction  relaxed: no friction")


def test_a_long_text_folds_below_its_beginning() -> None:
    _, _, *friction, _ = printed(LINES, 60)
    assert len(friction) == 2
    assert friction[1].startswith(" " * 16)
    assert " ".join(" ".join(friction).split()) == " ".join(LINES[2][:2])


def test_a_name_that_is_wider_than_its_column_is_folded_not_cut() -> None:
    content = TextTable((TextColumn("parameter"), TextColumn("effect")), [("petals.bend_radius", "-3.852")])
    console = Console(width=20, markup=False, highlight=False)
    with console.capture() as capture:
        console.print(_headed(content))
    said = capture.get()
    assert "…" not in said
    assert "petals.bend_radius" in "".join(line.split("  ")[0].strip() for line in said.splitlines()[3:])


def test_error_bars_stand_between_value_and_unit() -> None:
    (line, _) = printed([("force", "5.000", "± 0.20", "N"), ("force x", "-12.0", "", "N")], 60)
    assert line == "force    5.000  ± 0.20  N"


def test_a_table_without_numbers() -> None:
    assert printed([LINES[2]], 120) == ["  ".join(LINES[2][:2])]


WIDE = TextTable(
    (TextColumn("speed", "rpm"), *(TextColumn(f"K_{k}", "N/m") for k in range(8)), TextColumn("", of_numbers=False)),
    [("76394", *(f"{k}114078 ± 1234" for k in range(8)), ""), *[("80000", *["-"] * 8, "failed")]],
)


@pytest.mark.parametrize(("width", "parts"), [(200, 1), (120, 2), (80, 3), (60, 4), (40, 8)])
def test_a_table_wider_than_the_page_comes_in_parts_with_whole_numbers(width: int, parts: int) -> None:
    """Each part has the keys, and says which lines failed."""
    console = Console(width=width, markup=False, highlight=False)
    with console.capture() as capture:
        for part in _parts(WIDE, width):
            console.print(part)
    said = capture.get()
    assert max(map(len, said.splitlines())) <= width
    assert said.count("76394") == said.count("failed") == parts
    assert all(f"{k}114078 ± 1234" in said for k in range(8))


def test_a_number_wider_than_the_page_is_folded_not_cut() -> None:
    (part,) = _parts(WIDE, 12)
    console = Console(width=12, markup=False, highlight=False)
    with console.capture() as capture:
        console.print(part)
    assert "…" not in capture.get()
