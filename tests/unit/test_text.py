"""Foreign text made safe for terminal, figure and page."""

from __future__ import annotations

import html
import tomllib
import unicodedata
from html.parser import HTMLParser

import matplotlib.figure
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from petalfoil.text import for_figure, for_html, for_terminal
from tests.cases import FAULTS

HOSTILE = tomllib.loads((FAULTS / "escape_title.toml").read_text(encoding="utf-8"))["title"]


def test_plain_text_stays_as_it_is() -> None:
    for title in ("Paper, 8 petals, L/D = 1", "Größe µm × 2 − 日本語", "100 % \\alpha", "क्‍ष"):
        assert for_terminal(title) == title
    assert for_figure("Größe 25 µm") == "Größe 25 µm"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("\x1b[31mRED\x1b[0m", r"\x1b[31mRED\x1b[0m"),
        ("\x1b]0;window\x07", r"\x1b]0;window\x07"),
        ("\x9b31m", r"\x9b31m"),  # the same in one character
        ("a\r\nb\tc\x00", r"a\r\nb\tc\x00"),
        ("\u202egnp.exe", r"\u202egnp.exe"),
        ("a\u2028b", r"a\u2028b"),
        ("\ud800", r"\ud800"),
        ("\U000e0041", r"\U000e0041"),
    ],
)
def test_what_a_terminal_obeys_is_shown_by_its_code(text: str, expected: str) -> None:
    assert for_terminal(text) == expected


@given(st.text(st.characters(), max_size=40))
@example(HOSTILE)
def test_nothing_that_a_terminal_obeys_is_left(text: str) -> None:
    clean = for_terminal(text)
    assert not any(unicodedata.category(character) in {"Cc", "Zl", "Zp", "Cs"} for character in clean)
    assert for_terminal(clean) == clean
    clean.encode("utf-8")


@pytest.mark.parametrize("title", [HOSTILE, "cost $_$ per unit", r"\$", "$x", r"\\$ $\frac{a$", "$" * 5])
def test_a_figure_draws_any_title_letter_for_letter(title: str) -> None:
    figure = matplotlib.figure.Figure()
    drawn = figure.text(0.0, 0.5, for_figure(title))
    figure.canvas.draw()
    string, mathematical = drawn._preprocess_math(drawn.get_text())  # type: ignore[attr-defined]
    assert mathematical is False
    assert string == for_terminal(title)


class Page(HTMLParser):
    """What a browser makes of a page: its tags and its text."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[tuple[str, list[tuple[str, str | None]]]] = []
        self.texts: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, attrs))

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


@given(st.text(max_size=30))
@example(HOSTILE)
@example("\"><img src=x onerror='alert(1)'>&amp;")
def test_a_page_holds_no_tag_but_ours(title: str) -> None:
    page = Page()
    page.feed(f'<p title="{for_html(title)}">{for_html(title)}</p>')
    page.close()
    assert page.tags == [("p", [("title", for_terminal(title))])]
    assert "".join(page.texts) == for_terminal(title)
    assert html.unescape(for_html(title)) == for_terminal(title)
