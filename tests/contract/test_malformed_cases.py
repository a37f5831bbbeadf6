"""Whatever is wrong with a case: one message with the key's path, what was given, what is allowed, the nearest name.

A case is refused when it is read; nothing but the errors of this package comes out, whatever goes in.
"""

import datetime
import math
import os
import tempfile
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import example, given, settings
from hypothesis import strategies as st

from petalfoil.case import Case
from petalfoil.case.toml import MAX_BYTES
from petalfoil.errors import DefinitionError, PackError, PetalfoilError, UnitError
from tests.cases import DELETE, EXAMPLES, put, tables

BAR = 1e5
PLAIN, PETALS, SPATIAL = "plain_journal", "paper_n8", "paper_n8_spatial"

# name: (example, path, value, error, parts of the message)
MALFORMED: dict[str, tuple[str, str, Any, type[DefinitionError], tuple[str, ...]]] = {
    # types
    "length is a list": (PETALS, "bearing.length", [1.0], UnitError, ("bearing.length", "[1.0]", "a length")),
    "length is true": (PETALS, "bearing.length", True, UnitError, ("bearing.length", "True", "a length")),
    "length is a date": (PETALS, "bearing.length", datetime.date(2024, 1, 1), UnitError, ("bearing.length", "2024")),
    "length is nan": (PETALS, "bearing.length", math.nan, UnitError, ("bearing.length", "not finite")),
    "length is infinite": (PETALS, "bearing.length", math.inf, UnitError, ("bearing.length", "not finite")),
    "length is words": (PETALS, "bearing.length", "long", UnitError, ("bearing.length", "'long'", "'25 um'")),
    "count is a fraction": (PETALS, "petals.count", 8.5, DefinitionError, ("petals.count", "8.5", "a whole number")),
    "count is a text": (PETALS, "petals.count", "8", DefinitionError, ("petals.count", "'8'", "a whole number")),
    "count is true": (PETALS, "petals.count", True, DefinitionError, ("petals.count", "True", "a whole number")),
    "symmetry is a number": (PETALS, "model.symmetry", 1, DefinitionError, ("model.symmetry", "true or false")),
    "title is a number": (PETALS, "title", 8, DefinitionError, ("title", "8", "a text")),
    "petals is a number": (PETALS, "petals", 8, DefinitionError, ("petals", "8", "a table [petals]")),
    "gas is a list": (PETALS, "gas", [1, 2], DefinitionError, ("gas", "[1, 2]", "a table [gas]")),
    "eccentricity is a number": (PETALS, "operation.eccentricity", 1e-5, DefinitionError, ("eccentricity", "[x, y]")),
    "eccentricity is three": (PETALS, "operation.eccentricity", [0, 0, 0], DefinitionError, ("[0, 0, 0]", "[x, y]")),
    "eccentricity holds a weight": (PETALS, "operation.eccentricity", [0, "1 kg"], UnitError, ("ricity[1]", "mass")),
    "load is a weight in kilograms": (PETALS, "operation.load", "5 kg", UnitError, ("operation.load", "'50 N'")),
    "load is three": (PETALS, "operation.load", [0, 0, 0], DefinitionError, ("operation.load", "[x, y]")),
    # units
    "length in kilograms": (PETALS, "bearing.length", "50 kg", UnitError, ("bearing.length", "'50 kg'", "mass")),
    "length in parsnips": (PETALS, "bearing.length", "50 parsnip", UnitError, ("unknown unit 'parsnip'", "a length")),
    "length squared": (PETALS, "bearing.length", "50 mm^2", UnitError, ("bearing.length", "length^2")),
    "speed in hertz": (PETALS, "operation.speed", "100 Hz", UnitError, ("'6000 rpm'", "'100 rad/s'")),
    "viscosity in gauge pressure": (PETALS, "gas.ambient_pressure", "14 psig", UnitError, ("gauge pressure (psig)",)),
    "modulus in small letters": (PETALS, "petals.youngs_modulus", "200 gpa", UnitError, ("did you mean 'GPa'?",)),
    "viscosity in pascals": (PETALS, "gas.viscosity", "18.5 uPa", UnitError, ("gas.viscosity", "'18.5 uPa*s'")),
    "modulus in metres": (PETALS, "petals.youngs_modulus", "200 m", UnitError, ("petals.youngs_modulus", "1 bar")),
    "angle in metres": (PETALS, "petals.first_root", "1 m", UnitError, ("petals.first_root", "an angle", "45 deg")),
    "ratio in degrees": (PETALS, "petals.poisson_ratio", "0.3 deg", UnitError, ("petals.poisson_ratio", "an angle")),
    "a decimal comma": (PETALS, "bearing.length", "0,05 m", UnitError, ("a decimal point, '0.05 m'",)),
    "a sum": (PETALS, "bearing.length", "25 mm + 25 mm", UnitError, ("bearing.length", "'+'")),
    # ranges
    "no radius": (PETALS, "bearing.journal_radius", 0, DefinitionError, ("journal_radius", "greater than 0 m")),
    "negative length": (PETALS, "bearing.length", "-5 mm", DefinitionError, ("'-5 mm'", "greater than 0 m")),
    "a length in millimetres": (
        PETALS, "bearing.length", 50, DefinitionError, ("50 (a bare number is read in m)", "at most 20 m"),
    ),
    "a text without a unit": (PETALS, "bearing.length", "50", DefinitionError, ("'50' (a bare number is read in m)",)),
    "one petal": (PETALS, "petals.count", 1, DefinitionError, ("petals.count", "at least 2 and at most 64")),
    "a hundred petals": (PETALS, "petals.count", 100, DefinitionError, ("petals.count", "100", "at most 64")),
    "negative coating": (PETALS, "petals.coating", "-1 um", DefinitionError, ("petals.coating", "at least 0 m")),
    "incompressible": (PETALS, "petals.poisson_ratio", 0.5, DefinitionError, ("poisson_ratio", "less than 0.5")),
    "an upright root": (PETALS, "petals.root_tilt", "90 deg", DefinitionError, ("root_tilt", "less than 1.5 rad")),
    "below absolute zero": (PETALS, "gas.temperature", "-300 degC", DefinitionError, ("gas.temperature", "0 K")),
    "vacuum": (PETALS, "gas.ambient_pressure", 0.0, DefinitionError, ("gas.ambient_pressure", "greater than 0 Pa")),
    "no contact film thickness": (
        PETALS,
        "surface.contact_film_thickness",
        0,
        DefinitionError,
        ("surface.contact_film_thickness", "greater than 0 m"),
    ),
    "negative friction": (PETALS, "surface.friction_coefficient", -0.1, DefinitionError, ("at least 0",)),
    "backwards": (PETALS, "operation.speed", "-100 rpm", DefinitionError, ("'-100 rpm' is outside its range",)),
    "faster than light": (PETALS, "operation.speed", 1e9, DefinitionError, ("operation.speed", "at most 1e+06")),
    "three cells": (PETALS, "model.cells_per_pitch", 3, DefinitionError, ("model.cells_per_pitch", "at least 4")),
    "too many cells": (PETALS, "model.axial_cells", 10**30, DefinitionError, ("model.axial_cells", "at most 512")),
    "a grid without a middle": (SPATIAL, "model.axial_cells", 7, DefinitionError, ("model.axial_cells", "even")),
    # choices
    "a 2dd model": (PETALS, "model.kind", "2dd", DefinitionError, ("model.kind", "'3d'", "mean '2d'?")),
    "a clamped mount": (PETALS, "petals.mount", "clampt", DefinitionError, ("petals.mount", "mean 'clamped'?")),
    "edges of another kind": (PETALS, "model.edges", 3, DefinitionError, ("model.edges", "'ambient' or 'continuous'")),
    "a clasic method": (PETALS, "model.method", "clasic", DefinitionError, ("model.method", "mean 'classic'?")),
    "a tilt in words": (PETALS, "petals.root_tilt", "cordal", DefinitionError, ("root_tilt", "'cordal'", "'chordal'")),
    "a flat model": (PETALS, "model.kind", "flat", DefinitionError, ("model.kind", "mean '2d'?")),
    "a spatial model": (PETALS, "model.kind", "Spatial", DefinitionError, ("model.kind", "mean '3d'?")),
    "3D": (PETALS, "model.kind", "3D", DefinitionError, ("model.kind", "mean '3d'?")),
    "a rigid mount": (PETALS, "petals.mount", "rigid", DefinitionError, ("petals.mount", "mean 'clamped'?")),
    "a pinned mount": (PETALS, "petals.mount", "pinned", DefinitionError, ("petals.mount", "mean 'hinged'?")),
    # keys
    "lenght": (PETALS, "bearing.lenght", 1, DefinitionError, ("bearing.lenght", "mean 'length'?", "journal_radius")),
    "youngs_module": (PETALS, "petals.youngs_module", 1, DefinitionError, ("mean 'youngs_modulus'?",)),
    "a key of another table": (
        PETALS,
        "gas.contact_film_thickness",
        1,
        DefinitionError,
        ("mean 'surface.contact_film_thickness'?",),
    ),
    "a key outside the tables": (PETALS, "speed", 1, DefinitionError, ("speed", "mean 'operation.speed'?")),
    "petal": (PETALS, "petal", {"count": 8}, DefinitionError, ("petal", "mean 'petals'?")),
    "the contact film thickness of before": (
        PETALS, "surface.film_floor", 1e-6, DefinitionError, ("surface.film_floor", "mean 'contact_film_thickness'?"),
    ),
    "E": (PETALS, "petals.E", 2e11, DefinitionError, ("petals.E", "mean 'youngs_modulus'?")),
    "rpm": (PETALS, "operation.rpm", 6e4, DefinitionError, ("operation.rpm", "mean 'speed'?")),
    "a viscosity of the surface": (PETALS, "surface.mu", 1, DefinitionError, ("surface.mu", "mean 'gas.viscosity'?")),
    "Bend Radius": (PETALS, "petals.Bend Radius", 0.04, DefinitionError, ("mean 'bend_radius'?",)),
    "roottilt": (PETALS, "petals.roottilt", 0, DefinitionError, ("mean 'root_tilt'?",)),
    "a diameter": (PETALS, "bearing.journal_diameter", 0.05, DefinitionError, ("give bearing.journal_radius and",)),
    "a clearance": (PETALS, "bearing.radial_clearance", 1e-3, DefinitionError, ("clearance follows: give bearing",)),
    "tilt": (PETALS, "operation.tilt", [0, 0], DefinitionError, ("operation.tilt: needs the length", 'kind = "3d"')),
    "misalignment": (PETALS, "misalignment", {}, DefinitionError, ("The journal's axis is held at operation.tilt",)),
    "heat": (PETALS, "heat", {}, DefinitionError, ("heat.pack_to_bushing: is missing", "[W/K]")),
    "conductivity": (PETALS, "petals.thermal_conductivity", 15, DefinitionError, ("Heat is a network of",)),
    "a wall's temperature": (PETALS, "gas.wall_temperature", 350, DefinitionError, ("Heat is a network of",)),
    "bump foils": (PETALS, "bumps", {"pitch": 1}, DefinitionError, ("Bump foils stand in the table [bump_foil]",)),
    "external feed": (PETALS, "gas.supply_pressure", 5e5, DefinitionError, ("External pressurisation is not",)),
    "turbulence": (PETALS, "model.turbulent", True, DefinitionError, ("Turbulence is not modelled: the film",)),
    "grooves": (PETALS, "surface.groove_depth", 1e-5, DefinitionError, ("Grooves and textures are not modelled",)),
    "a key that speaks to the terminal": (
        PETALS, "bearing.\x1b[31mred", 1, DefinitionError, (r"bearing.\x1b[31mred: is not a known key",),
    ),
    "a key without end": (PETALS, "bearing." + "k" * 9000, 1, DefinitionError, ("bearing." + "k" * 60 + "…: is not",)),
    "an unknown key like no other": (PETALS, "zzz", 1, DefinitionError, ("zzz: is not a known key", "bearing, shaft")),
    "no bearing": (PETALS, "bearing", DELETE, DefinitionError, ("bearing: is missing", "a table [bearing]")),
    "no length": (PETALS, "bearing.length", DELETE, DefinitionError, ("bearing.length: is missing", "[m]")),
    "no count": (PETALS, "petals.count", DELETE, DefinitionError, ("petals.count: is missing", "at least 2")),
    "no mount": (
        PETALS,
        "petals.mount",
        DELETE,
        DefinitionError,
        ("petals.mount: is missing", "'hinged' or 'clamped'"),
    ),
    "no speed": (PETALS, "operation.speed", DELETE, DefinitionError, ("operation.speed: is missing", "rad/s")),
    "no kind": (PETALS, "model.kind", DELETE, DefinitionError, ("model.kind: is missing", "'2d' or '3d'")),
    # gases (those of the examples are given by numbers)
    "no viscosity": (PETALS, "gas.viscosity", DELETE, DefinitionError, ("gas.viscosity: is missing", "gas.name")),
    "a name beside numbers": (PETALS, "gas.name", "air", DefinitionError, ("gas.viscosity: '18.5 uPa*s'", "not both")),
    "name and gas constant": (
        PETALS, "gas", {"name": "air", "ambient_pressure": BAR, "gas_constant": 287}, DefinitionError, ("not both",),
    ),
    "ari": (PETALS, "gas", {"name": "ari", "ambient_pressure": BAR}, DefinitionError, ("known: air, helium", "'air'?")),
    "name is 1": (PETALS, "gas", {"name": 1, "ambient_pressure": BAR}, DefinitionError, ("gas.name: 1", "a text")),
    "a gas without viscosity": (
        PETALS, "gas", {"name": "xenon", "ambient_pressure": BAR}, DefinitionError, ("gas.name", "gas.viscosity"),
    ),
    "a mixture": (PETALS, "gas", {"name": "N2&O2", "ambient_pressure": BAR}, DefinitionError, ("not a known gas",)),
    "a model before a name": (
        PETALS, "gas", {"name": "HEOS::N2", "ambient_pressure": BAR}, DefinitionError, ("not a known gas",),
    ),
    "air too hot": (
        PETALS, "gas", {"name": "air", "ambient_pressure": BAR, "temperature": 3000}, DefinitionError,
        ("gas.temperature: 3000 K", "59.75 K to 2000 K"),
    ),
    "cold steam": (
        PETALS, "gas", {"name": "steam", "ambient_pressure": BAR}, DefinitionError,
        ("gas.ambient_pressure", "condenses at 2.339 kPa", "more than 372.76 K"),
    ),
    "a gas that is not ideal": (
        PETALS, "gas", {"name": "R134a", "ambient_pressure": BAR}, DefinitionError,
        ("gas.ambient_pressure", "2.2 % off the ideal-gas law", "less than 92.8"),
    ),
    "slip by a word": (PETALS, "model.slip", "yes", DefinitionError, ("model.slip", "true or false")),
    # measured free shapes
    "two rows": (PETALS, "petals.free_shape", [[0, 0.0259], [2, 0.0259]], DefinitionError, ("has 2 rows", "3 to 10")),
    "rows of three": (PETALS, "petals.free_shape", [[0, 1, 2]] * 3, DefinitionError, ("free_shape", "[angle, radius]")),
    "rows in metres": (
        PETALS, "petals.free_shape", [[0, 1], ["1 m", 1], [2, 1]], UnitError, ("free_shape[1][0]", "an angle"),
    ),
    "rows back and forth": (
        PETALS, "petals.free_shape", [[0, 0.0259], [1, 0.024], [0.5, 0.0259]], DefinitionError, ("do not grow",),
    ),
    "rows from the middle": (
        PETALS, "petals.free_shape", [[0.5, 0.0259], [1, 0.024], [2, 0.0259]], DefinitionError, ("begins at 0.5 rad",),
    ),
    "rows that end early": (
        PETALS, "petals.free_shape", [[0, 0.0259], [0.7, 0.024], [1.4, 0.0259]], PackError, ("19.288459° short",),
    ),
    "a root outside the bore": (
        PETALS, "petals.free_shape", [[0, 0.027], [1, 0.024], [2, 0.0259]], PackError, ("the root", "25.912 mm"),
    ),
    # packs that cannot be
    "no overlap": (PETALS, "petals.arc_length", "20 mm", PackError, ("arc_length", "do not overlap", "short")),
    "round the whole bore": (PETALS, "petals.arc_length", "170 mm", PackError, ("petals.arc_length", "round")),
    "an arc too long": (PETALS, "petals.arc_length", "65 mm", PackError, ("petals.arc_length", "2.4 rad")),
    "too thick": (PETALS, "petals.thickness", "0.4 mm", PackError, ("3 layers of 400 µm", "301 µm too much")),
    "too much coating": (PETALS, "petals.coating", "0.3 mm", PackError, ("3 layers of 476 µm", "too much")),
    "displaced too far": (
        PETALS, "operation.eccentricity", [0, "-0.5 mm"], PackError, ("operation.eccentricity", "29 µm too much"),
    ),
    "a bend inside the bore": (PETALS, "petals.bend_radius", "20 mm", PackError, ("petals.bend_radius", "5.912 mm")),
    "thicker than the bushing": (PETALS, "petals.thickness", "30 mm", PackError, ("petals.thickness", "26 mm")),
    "a journal too large": (PETALS, "bearing.journal_radius", "27 mm", PackError, ("27 mm", "26 mm")),
    "a journal that fills the bushing": (PLAIN, "bearing.journal_radius", "25.025 mm", PackError, ("25.025 mm",)),
    "a plain journal that touches": (
        PLAIN, "operation.eccentricity", ["0 m", "-24.5 um"], PackError, ("operation.eccentricity", "500 nm"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MALFORMED)
def test_a_malformed_case_is_refused_in_words(name: str) -> None:
    example_name, path, value, error, parts = MALFORMED[name]
    with pytest.raises(DefinitionError) as caught:
        Case(**put(tables(example_name), path, value))
    assert type(caught.value) is error
    for part in parts:
        assert part in str(caught.value)
    assert "problems" not in str(caught.value)
    assert caught.value.key
    assert caught.value.key.split(".")[0] in (path.split(".")[0], "petals")


@pytest.mark.parametrize("name", [name for name, row in MALFORMED.items() if row[2] is not DELETE])
def test_the_same_words_from_a_file(name: str, tmp_path: Path) -> None:
    example_name, path, value, error, parts = MALFORMED[name]
    file = tmp_path / "case.toml"
    file.write_text(tomli_w.dumps(put(tables(example_name), path, value)), encoding="utf-8")
    with pytest.raises(error) as caught:
        Case.load(file)
    for part in (str(file), *parts):
        assert part in str(caught.value)


@pytest.mark.parametrize("table", ["shaft", "bushing"])
def test_numbers_that_would_follow_from_a_refused_metal_are_not_refused_too(table: str) -> None:
    with pytest.raises(DefinitionError, match=f"^{table}.material: 'unobtainium' is not in the table of metals"):
        Case.load(EXAMPLES / "plain_journal.toml").replace(**{table: {"material": "unobtainium"}})


def test_an_arc_that_turns_back() -> None:
    data = put(put(tables(PETALS), "petals.bend_radius", "8 mm"), "petals.root_tilt", "10 deg")
    with pytest.raises(PackError, match=r"petals\.root_tilt: an arc .* turns back at .* rad short"):
        Case(**data)


BROKEN_TEXTS = {
    "empty": ("", "bearing: is missing"),
    "comments only": ("# nothing\n\n", "bearing: is missing"),
    "no value": ("title = \n", "not valid TOML: .*line 1"),
    "unclosed text": ('a = 1\nb = 2\ntitle = "open\n', "line 3"),
    "unclosed table": ("title = 'x'\n[bearing\n", "line 2"),
    "twice the same key": ("a = 1\na = 2\n", "line 2"),
    "not TOML": ("{'json': true}", "line 1"),
    "bare quantity": ("[bearing]\nlength = 50 mm\n", "line 2"),
    "a control character": ("title = 'a\x01b'\n", "line 1"),
    "nested without end": ("a = " + "[" * 50_000, "nested too deeply"),
    "an endless number": ("a = " + "9" * 10_000, "not valid TOML"),
    "a hexadecimal giant": ("[bearing]\nlength = 0x" + "f" * 8000 + "\n", "bearing.length: .*too large"),
}


@pytest.mark.parametrize("name", BROKEN_TEXTS)
def test_broken_texts(name: str) -> None:
    text, message = BROKEN_TEXTS[name]
    with pytest.raises(DefinitionError, match=message):
        Case.from_toml(text)


def test_an_absent_file(tmp_path: Path) -> None:
    with pytest.raises(DefinitionError, match=r"nowhere\.toml: there is no such file"):
        Case.load(tmp_path / "nowhere.toml")


def test_a_directory(tmp_path: Path) -> None:
    with pytest.raises(DefinitionError, match="is a directory; expected a file"):
        Case.load(tmp_path)


def test_a_device_that_never_ends() -> None:
    with pytest.raises(DefinitionError, match=r"^/dev/zero: is a device, a pipe or a socket; expected a file$"):
        Case.load("/dev/zero")


def test_a_pipe_that_nobody_fills(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "case.toml")
    with pytest.raises(DefinitionError, match="is a device, a pipe or a socket"):
        Case.load(tmp_path / "case.toml")


def test_a_file_of_terabytes(tmp_path: Path) -> None:
    with (tmp_path / "case.toml").open("wb") as file:
        file.truncate(2**40)  # sparse: it takes no place
    with pytest.raises(DefinitionError, match="has more than 1 MiB; expected a text of some kilobytes"):
        Case.load(tmp_path / "case.toml")


def test_a_case_as_large_as_may_be_is_read(tmp_path: Path) -> None:
    text = (EXAMPLES / "paper_n8.toml").read_bytes()
    (tmp_path / "case.toml").write_bytes(text + b"#" * (MAX_BYTES - len(text)))
    assert Case.load(tmp_path / "case.toml") == Case.load(EXAMPLES / "paper_n8.toml")


def test_a_latin_1_file_is_told_how_to_be_saved(tmp_path: Path) -> None:
    text = "# bearing\ntitle = 'Größe'\n"
    (tmp_path / "case.toml").write_bytes(text.encode("latin-1"))
    with pytest.raises(DefinitionError, match=r"not a text in UTF-8 \(line 2, byte 0xf6\): save it as UTF-8 \(in an"):
        Case.load(tmp_path / "case.toml")


def test_a_file_name_that_speaks_to_the_terminal(tmp_path: Path) -> None:
    with pytest.raises(DefinitionError) as caught:
        Case.load(tmp_path / "a\x1b[31m\nb.toml")
    assert r"a\x1b[31m\nb.toml: there is no such file" in str(caught.value)


def test_a_file_that_cannot_be_opened(tmp_path: Path) -> None:
    loop = tmp_path / "loop.toml"
    loop.symlink_to(loop)  # unlike a missing permission, this stops the superuser too
    with pytest.raises(DefinitionError, match=r"loop\.toml: cannot be read: "):
        Case.load(loop)


def test_a_file_below_a_file(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text("", encoding="utf-8")
    with pytest.raises(DefinitionError, match="cannot be read"):
        Case.load(tmp_path / "case.toml" / "case.toml")


def test_a_path_that_is_none() -> None:
    with pytest.raises(DefinitionError, match="cannot be read"):
        Case.load("case\0.toml")


@pytest.mark.parametrize("content", [b"\x89HDF\r\n\x1a\n\xff\xfe", "title = 'µ'".encode("utf-16"), b"title = '\xb5'"])
def test_a_binary_file(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_bytes(content)
    with pytest.raises(DefinitionError, match="not a text in UTF-8"):
        Case.load(tmp_path / "case.toml")


def test_an_empty_file(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_bytes(b"")
    with pytest.raises(DefinitionError, match=r"(?s)problems.*bearing: is missing.*model: is missing"):
        Case.load(tmp_path / "case.toml")


# ---------------------------------------------------------------------------------------------- junk

SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=20),
    st.sampled_from(["air", "25 mm", "1 um", "-3 deg", "chordal", "clamped", "2d", "8000 rad/s", "1e400 m", "20 degC"]),
    st.dates(),
    st.binary(max_size=4),
)
JUNK = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
PATHS = st.sampled_from(
    [f"{section}.{key}" for section, table in tables(PETALS).items() if isinstance(table, dict) for key in table]
    + [
        "petals.free_shape",
        "operation.load",
        "gas.name",
        "model.slip",
        "model.symmetry",
        "model.cells_per_pitch",
        "model.axial_cells",
    ]
    + ["title", "bearing", "petals", "gas", "surface", "operation", "model", "petals.x", "x"]
)


def only_ours(make: Any) -> None:
    """Run `make`; a case that comes out must survive its own round trip, an error must have words."""
    made: Case | None = None
    words = ""
    try:
        made = make()
    except PetalfoilError as error:
        words = str(error)
    assert words or (made is not None and Case.from_toml(made.to_toml()) == made)


@pytest.mark.slow
@settings(max_examples=150)
@given(st.lists(st.tuples(PATHS, JUNK), min_size=1, max_size=3))
@example([("petals", None)])
@example([("title", "\ud800")])
@example([("title", "a\r\nb\t\x00")])
@example([("petals.free_shape", [[0.0, 0.02]] * 3)])
def test_junk_in_a_valid_case(changes: list[tuple[str, Any]]) -> None:
    data: Any = tables(PETALS)
    for path, value in changes:
        section, _, key = path.partition(".")
        if not key:
            data = {**data, section: value}
        elif isinstance(data.get(section), dict):
            data = {**data, section: {**data[section], key: value}}
    only_ours(lambda: Case(**data))


TOML_LIKE = st.lists(
    st.sampled_from(
        [
            "[bearing]",
            "[petals]",
            "[[gas]]",
            "length",
            "count",
            "=",
            "8",
            "'25 mm'",
            "[",
            "]",
            "{",
            "}",
            ",",
            "\n",
            '"""',
        ]
    ),
    max_size=25,
).map(" ".join)


@settings(max_examples=150)
@given(st.one_of(st.text(max_size=80), TOML_LIKE))
def test_junk_as_text(text: str) -> None:
    only_ours(lambda: Case.from_toml(text))


@settings(max_examples=80)
@given(st.integers(0, 2000), st.text(max_size=3))
def test_a_valid_text_with_a_slip(position: int, slip: str) -> None:
    text = (EXAMPLES / "paper_n8.toml").read_text(encoding="utf-8")
    position = min(position, len(text))
    only_ours(lambda: Case.from_toml(text[:position] + slip + text[position + 1 :]))


@settings(max_examples=40)
@given(st.binary(max_size=60))
def test_junk_as_a_file(content: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.toml"
        path.write_bytes(content)
        only_ours(lambda: Case.load(path))
