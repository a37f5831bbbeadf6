r"""Foreign text (titles, keys, file names) made safe to show, one function for each kind of output.

A title in a case or in a result file of someone else may hold anything: escape sequences that recolour a terminal or
rename its window, marks that turn the order of letters around, `$` that starts a formula in a figure, tags that a
browser runs. Nothing is dropped silently: what is not shown as it is, is shown by its code, as in ``\x1b[31m``.
"""

from __future__ import annotations

import html
import unicodedata

_CODED = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}
"""Categories of Unicode shown by code: controls, marks of direction, halves of pairs, unassigned, line separators."""

_JOINERS = "\u200c\u200d"
"""Marks inside words of Persian and Indic scripts and inside emoji, which change no order: kept."""


def for_terminal(text: str) -> str:
    """Return `text` as one line without control characters; each is shown by its code.

    The markup of `rich` is not escaped: print foreign text as `rich.text.Text`, or with ``markup=False``.
    """
    return "".join(_shown(character) for character in text)


def for_figure(text: str) -> str:
    """Return `text` as one line that matplotlib sets letter for letter, without formulas."""
    return for_terminal(text).replace("$", r"\$")


def for_html(text: str) -> str:
    """Return `text` as one line for the inside of an element or for a quoted attribute."""
    return html.escape(for_terminal(text), quote=True)


def _shown(character: str) -> str:
    if character in _JOINERS or unicodedata.category(character) not in _CODED:
        return character
    return character.encode("unicode_escape").decode("ascii")
