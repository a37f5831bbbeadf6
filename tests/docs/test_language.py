"""The texts speak the field's words: a table of words that are not to be used, each with the word in its place.

`ROOTS` names what is searched. A phrase is matched whole, in any case, across line breaks and comment signs; the only
exception is the table of renamed keys in the changelog, which no root holds.
"""

from __future__ import annotations

import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.texts import ROOT, name_of, text

ROOTS = ("README.md", "CONTRIBUTING.md", "docs", "examples", "benchmarks", "src")
"""Files and folders that are searched."""

TABLE_OF_WRONG_WORDS = ROOT / "src" / "petalfoil" / "case" / "hints.py"
"""Answers a wrong or former key with the right one, and so must name it."""

GENERATED = {ROOT / "docs" / "gallery", ROOT / "docs" / "tutorials" / "worked"}
"""Folders that building the site fills from scripts that are searched themselves."""

SUFFIXES = {".md", ".py", ".toml", ".csv"}

READ = {"COMMENT", "STRING", "FSTRING_MIDDLE"}
"""Tokens of a module that a reader reads as text."""

WORDS = {
    # film and pressure
    "(smallest|thinnest|least) films?( thickness)?": "minimum film thickness",
    "(largest|highest) (absolute )?pressures?": "peak pressure",
    "(largest|highest) (bending )?stress": "maximum bending stress",
    "(gas )?content(?![-=:])": "gas inventory; stopping criterion",
    "defects?( of)?": "mass-balance error, energy-balance error, residual",
    # foil pack
    "rooms?(?! temperature)": "radial clearance; clearance above the solid pack height; folder",
    "packages? (is )?at rest": "foil pack at zero speed",
    "assembled package": "assembled pack",
    "press(ed|es|ing)? solid": "bottomed out",
    "solid package": "bottomed-out pack",
    "rigid(ly)? (mounts?|mounted|roots?)": "clamped",
    "gives? way": "deflects; is replaced by",
    # contact
    "push(es|ed)? (of film and contact )?on the journal": "normal force on the journal",
    "pushes on (it|the journal)": "normal force",
    "(?<!solid\\s)contacts? (still )?carr(y|ies)": "solid contact carries",
    "contact shares?": "contact fraction",
    "contacts' share|share of the contacts": "contact fraction",
    "closed gaps?|gaps? (that )?(is|are) closed": "active contacts",
    "touch(es)? again": "touchdown speed",
    "touch-downs?": "touchdown",
    "(journal|which|that|it) floats|floats (at|below|above|under|where)": "is above lift-off speed",
    "journal sits|sits (at|under|where)": "journal position",
    "(journal central|central journal)": "centred journal",
    # grid
    "(cells|nodes) (along )?a (pitch|petal)": "cells per pitch",
    "(vanishing cells|vanishing mesh)": "grid-converged value",
    "(?<![.-])flat(?! (plate|numbers?|nodes?|index))": "2-D",
    "spatial(ly)?": "3-D",
    "in space": "in 3-D",
    "(steps|pictures|points|factorisations|factorizations) a (turn|step|point|pitch|curve|mode|frequency)": "per",
    "film floor": "contact film thickness",
    "(the|a|loaded|foil|leaf) package (did|does|takes|no clearance|at|as|there)": "foil pack",
    # rotor and whirl
    "let(s|ting)? (it |them )?go": "releases the rotor",
    "no (rotor )?mass whirls": "stable for any rotor mass",
    "(smallest|least) (mass|rotor)( of a rigid rotor)? (that|which) whirls": "critical rotor mass",
    "smallest whirling mass": "critical rotor mass",
    "dominating": "dominant",
    "against the rotation": "backward whirl",
    "circle with the rotation": "forward whirl",
    "turns of the shaft|turns? the shaft has made": "revolutions",
    # numbers and how they were found
    "(every|each|derived|all|own|no) figures?(?! (\\d|of the page|and (its|claims|data)))": "quantity, result",
    "figures (of (the|a) (state|step|run|point|failed run)|are|stand)\\b": "quantities, results",
    "way up from rest": "continuation from zero speed",
    "exact to the linear response": "linearised about the equilibrium (two digits on petals)",
    # riddles and sayings
    "for ever": "(say how long, or leave out)",
    "is content|was content": "the stopping criterion is met",
    "what is not (farther|further)": "(say it forward)",
    "wanted (is|are)": "(subject first)",
    "(thin|thick) (end|side) decides?": "(name the mean)",
    "friction's stick|(the|its) stick(?!s|ing|-)": "sticking stiffness",
    "wants both to": "requires both to",
    "finds? wanting": "is missing from",
    "slip of the pen": "typing mistake",
}
"""Words not to be used, as regular expressions with a space for any break, and what is said in their place."""

NAMES = {
    "Moving|Course|Slid|Rubbed|Rubbing": "TimeState, SpeedSchedule, FrictionState, FrictionStep",
    "film_floor": "contact_film_thickness",
    "(min|smallest)_film(?!_)": "min_film_thickness",
    "contact_share": "contact_fraction",
    "contact_total": "contact_normal_force",
    "room(?! temperature)|room_left": "radial_clearance, pack_clearance, fraction_to_boundary",
    "(?:Gas)?Content|gas_content": "GasInventory",
    "Package(?:Error)?|packages?_(?:of|with|problems)|(?:case|of)\\.packages?": "PackGeometry, PackError, pack_of",
    "pressed_solid|SPATIAL|FLAT|RIGID": "bottomed_out, THREE_D, TWO_D, CLAMPED",
}
"""The same for names, in their own case."""

GAP = r"(?:\s|\n\s*(?:#|//|\*|>)\s*)+"


def pattern(phrase: str) -> str:
    """The regular expression of a phrase: whole words, any white space or comment sign for a space."""
    return rf"(?<![\w/-])(?:{phrase.replace(' ', GAP)})(?![\w-])"


SPOKEN = [(re.compile(pattern(old), re.IGNORECASE), new) for old, new in WORDS.items()]
NAMED = [(re.compile(pattern(old)), new) for old, new in NAMES.items()]

ANY = re.compile(r"(?<![\w/-])(?=\w)(?:" + "|".join(WORDS).replace(" ", GAP) + ")", re.IGNORECASE)
"""Begins wherever one of the phrases does: one search in place of sixty."""


def files(root: str) -> list[Path]:
    """Texts of a root."""
    path = ROOT / root
    inside = [path] if path.is_file() else sorted(f for f in path.rglob("*") if f.suffix in SUFFIXES)
    return [file for file in inside if file != TABLE_OF_WRONG_WORDS and not GENERATED & set(file.parents)]


def prose(path: Path) -> str:
    """What a reader reads in a file: comments and strings of a module, all of a page."""
    code = text(path)
    return of_module(code) if path.suffix == ".py" and ANY.search(code) else code


def of_module(code: str) -> str:
    """Comments and strings of a module, each in its line; the code between them is blank."""
    lines = code.splitlines()
    kept = [" " * len(line) for line in lines]
    for token in tokenize.generate_tokens(io.StringIO(code).readline):
        if tokenize.tok_name[token.type] in READ:
            for row in range(token.start[0] - 1, token.end[0]):
                left = token.start[1] if row == token.start[0] - 1 else 0
                right = token.end[1] if row == token.end[0] - 1 else len(lines[row])
                kept[row] = kept[row][:left] + lines[row][left:right] + kept[row][right:]
    return "\n".join(kept)


def found_in(words: str, table: list[tuple[re.Pattern[str], str]] = SPOKEN) -> Iterator[str]:
    """Every phrase of a table in `words`: line, phrase, what is said in its place."""
    for old, new in table if table is not SPOKEN or ANY.search(words) else ():
        for hit in old.finditer(words):
            line = words.count("\n", 0, hit.start()) + 1
            yield f"line {line}: {' '.join(hit.group().split())!r} -> {new}"


@pytest.mark.parametrize("root", ROOTS)
def test_the_texts_speak_the_words_of_the_field(root: str) -> None:
    found = [f"{name_of(path)}, {hit}" for path in files(root) for hit in found_in(prose(path))]
    found += [f"{name_of(path)}, {hit}" for path in files(root) for hit in found_in(text(path), NAMED)]
    assert found == [], "\n" + "\n".join(found)


def test_every_root_has_texts() -> None:
    assert all(files(root) for root in ROOTS)


@pytest.mark.parametrize(
    "words",
    [
        "the Smallest\n# film of 3 µm",
        "on 64 cells a pitch",
        "its limit for vanishing cells",
        "petals are pressed solid",
        "contacts carry 3 %",
        "the package at rest",
        "no mass whirls",
        "a rigid mount",
        "one pattern for ever",
        "it is content",
        "the room left",
        "it lets it go",
    ],
)
def test_the_search_finds(words: str) -> None:
    assert list(found_in(words))


def test_the_search_finds_names() -> None:
    assert len(list(found_in("film_floor = 1\nx: Moving\n", NAMED))) == 2


def test_the_search_reads_comments_and_strings() -> None:
    code = (
        'flat = x.flat  # flat model\ndef f() -> str:\n    """The room\n    left."""\n    return f"{x} cells a pitch"\n'
    )
    assert len(list(found_in(of_module(code)))) == 3


@pytest.mark.parametrize(
    "words", ["minimum film thickness", "cells per pitch", "at room temperature", "load capacity at 3 µm", "flatten it"]
)
def test_the_search_leaves_the_words_of_the_field_alone(words: str) -> None:
    assert list(found_in(words)) == []
