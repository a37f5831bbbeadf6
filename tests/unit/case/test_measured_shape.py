"""Measured free shapes: the curve through the rows, its bend radius, what scatters, and where it ends."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.case import Case, PackGeometry
from petalfoil.case.measured_shape import EDGE_TOLERANCE, Table, fitted_bend_radius, measured_radius, row_errors
from petalfoil.errors import DefinitionError, PackError
from tests.cases import EXAMPLES, case, put, tables

MICRON = 1e-6


def arc() -> PackGeometry:
    pack = case("paper_n8").pack
    assert pack is not None
    return pack


def rows_of(count: int, scatter: float = 0.0, seed: int = 1) -> Table:
    """Rows of the paper's petal, evenly spaced, their radii scattered [m]."""
    angles = np.linspace(0.0, arc().petal_angle, count)
    radii = arc().free_radius(angles) + scatter * np.random.default_rng(seed).standard_normal(count)
    return tuple(zip(angles.tolist(), radii.tolist(), strict=True))


def error(table: Table, tolerance: float = 0.0) -> NDArray[np.float64]:
    """Radius of the measured shape less that of the arc it was taken from [m]."""
    angles = np.linspace(0.0, arc().petal_angle, 701)
    return measured_radius(angles, table, tolerance) - arc().free_radius(angles)


def measured(table: Any, **changes: object) -> Case:
    """The paper's bearing, its petals measured."""
    data = put(tables("paper_n8"), "petals.free_shape", table)
    del data["petals"]["bend_radius"]
    return Case(**data).replace(**changes)


# ---------------------------------------------------------------------------------------------- between the rows


def test_rows_are_met_and_the_end_radius_is_held() -> None:
    table = rows_of(9)
    angles, radii = np.array(table).T
    assert_allclose(measured_radius(angles, table), radii, rtol=1e-14)
    edge = float(measured_radius(angles[-1] + EDGE_TOLERANCE, table))
    assert float(measured_radius(angles[-1] + 0.1, table)) == edge


@pytest.mark.parametrize(("count", "allowed"), [(8, 0.3 * MICRON), (12, 0.05 * MICRON), (24, 0.01 * MICRON)])
def test_few_rows_give_the_shape(count: int, allowed: float) -> None:
    """A monotone interpolant is level at the lowest row and missed by 24 um with 12 rows."""
    assert np.max(np.abs(error(rows_of(count)))) < allowed


def test_halved_spacing_is_sixteen_times_as_accurate() -> None:
    coarse, fine = (np.max(np.abs(error(rows_of(count))[100:-100])) for count in (17, 33))
    assert math.log2(coarse / fine) > 3.9


def test_a_stated_tolerance_smooths_scatter() -> None:
    scattered = [rows_of(200, 5.0 * MICRON, seed) for seed in range(5)]
    through = [np.sqrt(np.mean(error(table) ** 2)) for table in scattered]
    smooth = [np.sqrt(np.mean(error(table, 5.0 * MICRON) ** 2)) for table in scattered]
    assert all(after < 0.5 * before for after, before in zip(smooth, through, strict=True))
    assert max(smooth) < 2.5 * MICRON


def test_the_rows_lie_within_the_tolerance_on_average() -> None:
    table = rows_of(200, 5.0 * MICRON)
    angles, radii = np.array(table).T
    deviation = np.sqrt(np.mean((measured_radius(angles, table, 5.0 * MICRON) - radii) ** 2))
    assert deviation == pytest.approx(5.0 * MICRON, rel=0.01)


# ---------------------------------------------------------------------------------------------- curvature


@pytest.mark.parametrize("bend_radius", [27e-3, 40e-3, 5.0])
def test_the_bend_radius_of_an_arc_is_found(bend_radius: float) -> None:
    pack = case("paper_n8", **{"petals.bend_radius": bend_radius}).pack
    assert pack is not None
    angles = np.linspace(0.0, pack.petal_angle, 24)
    table = tuple(zip(angles.tolist(), pack.free_radius(angles).tolist(), strict=True))
    assert fitted_bend_radius(table) == pytest.approx(bend_radius, rel=1e-9)


def test_scatter_hardly_moves_the_bend_radius() -> None:
    assert fitted_bend_radius(rows_of(48, 5.0 * MICRON)) == pytest.approx(40e-3, rel=2e-3)


def test_a_straight_petal_has_no_curvature() -> None:
    angles = np.linspace(0.0, 1.0, 9)
    straight = tuple((float(angle), 20e-3 / math.cos(angle - 0.5)) for angle in angles)
    assert fitted_bend_radius(straight) > 1e9


def test_the_measured_shape_needs_no_bend_radius() -> None:
    """Where it is given it must agree, and moves nothing."""
    alone = measured(rows_of(24))
    assert alone.petals is not None
    assert alone.petals.bend_radius is None
    assert alone.pack is not None
    assert alone.pack.bend_radius == pytest.approx(40e-3, rel=1e-9)
    beside = alone.replace(**{"petals.bend_radius": "41 mm"})
    assert beside.pack is not None
    assert beside.pack.bend_radius == alone.pack.bend_radius
    with pytest.raises(PackError, match=r"petals\.bend_radius: 43 mm contradicts the measured .* the radius 40 mm"):
        alone.replace(**{"petals.bend_radius": "43 mm"})
    assert Case.from_toml(alone.to_toml()) == alone


def test_a_root_tilt_beside_a_measured_shape_is_refused() -> None:
    with pytest.raises(PackError, match=r"petals\.root_tilt: is given beside a measured"):
        measured(rows_of(24), **{"petals.root_tilt": "10 deg"})


def test_a_petal_without_any_free_shape_is_refused() -> None:
    data = tables("paper_n8")
    del data["petals"]["bend_radius"]
    with pytest.raises(DefinitionError, match=r"petals\.bend_radius: is missing; expected .*petals\.free_shape"):
        Case(**data)


# ---------------------------------------------------------------------------------------------- how good it is


def test_row_errors_see_scatter_and_coarse_rows() -> None:
    assert np.sqrt(np.mean(row_errors(rows_of(200, 5.0 * MICRON)) ** 2)) == pytest.approx(7e-6, rel=0.15)
    for count in (6, 8, 12, 24):
        table = rows_of(count)
        assert 5.0 < np.max(np.abs(row_errors(table))) / np.max(np.abs(error(table))) < 50.0


# ---------------------------------------------------------------------------------------------- where it ends


def test_a_last_row_rounded_below_the_edge_is_accepted() -> None:
    *inner, (angle, radius) = rows_of(24)
    for short in (1.7e-9, 0.99 * EDGE_TOLERANCE):
        pack = measured([*inner, (angle - short, radius)]).pack
        assert pack is not None
        assert_allclose(pack.free_radius(angle), radius, atol=0.2 * MICRON)


def test_a_table_that_ends_before_the_edge_tells_by_how_much() -> None:
    *inner, (angle, radius) = rows_of(24)
    with pytest.raises(PackError, match=r"the table ends at 99\.5010\d+°, 0\.0015\d*° short of .* at 99\.5025\d+°"):
        measured([*inner, (angle - math.radians(1.5e-3), radius)])


def test_a_scattered_root_may_lie_outside_the_bore() -> None:
    (_, radius), *others = rows_of(24)
    outside = [(0.0, radius + 12.0 * MICRON), *others]
    with pytest.raises(PackError, match="the root, which cannot move"):
        measured(outside)
    data = put(tables("paper_n8"), "petals.free_shape", outside)
    assert Case(**put(data, "petals.free_shape_tolerance", "5 um")).petals is not None


def test_a_measured_shape_may_span_more_than_an_arc() -> None:
    long = {"petals.arc_length": "75 mm", "petals.thickness": "0.1 mm"}
    with pytest.raises(PackError, match=r"2\.4 rad"):
        case("paper_n8", **long)
    data = put(tables("paper_n8"), "petals.free_shape", [(angle, 25.9e-3) for angle in np.linspace(0.0, 3.0, 7)])
    del data["petals"]["bend_radius"]
    data["petals"] |= {"arc_length": "75 mm", "thickness": "0.1 mm"}
    pack = Case(**data).pack
    assert pack is not None
    assert pack.petal_angle > 2.4
    assert math.isnan(pack.root_tilt)
    assert pack.bend_radius == pytest.approx(25.9e-3, rel=1e-12)


# ---------------------------------------------------------------------------------------------- from a file

HEADED = "# probe 3, 2024-05-01\nangle [deg], radius [mm]\n"


def degrees(count: int) -> list[tuple[str, str]]:
    return [(f"{math.degrees(angle):.6f}", f"{1e3 * radius:.6f}") for angle, radius in rows_of(count)]


@pytest.mark.parametrize(
    "text",
    [
        HEADED + "\n".join(f"{angle}, {radius}" for angle, radius in degrees(24)),
        "angle (deg);radius (mm)\r\n" + "\r\n".join(f"{angle};{radius}" for angle, radius in degrees(24)),
        "\ufeff" + "\n".join(f"{angle} deg\t{radius} mm" for angle, radius in degrees(24)) + "\n\n",
        "phi,r\n" + "\n".join(f"{angle!r},{radius!r}" for angle, radius in rows_of(24)),
        "\n".join(f"{angle!r},{radius!r}" for angle, radius in rows_of(24)),
    ],
    ids=["header", "semicolons", "tabs", "no units", "no header"],
)
def test_a_shape_is_read_from_a_csv_file_beside_the_case(text: str, tmp_path: Path) -> None:
    (tmp_path / "shape.csv").write_bytes(text.encode("utf-8"))
    toml = (EXAMPLES / "paper_n8.toml").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(toml.replace('bend_radius = "40 mm"', 'free_shape = "shape.csv"'), "utf-8")
    loaded = Case.load(tmp_path / "case.toml")
    assert loaded.petals is not None
    assert_allclose(loaded.petals.free_shape, rows_of(24), rtol=1e-7, atol=1e-8)
    assert measured(str(tmp_path / "shape.csv")) == loaded.replace(title=measured(rows_of(24)).title)
    assert "shape.csv" not in loaded.to_toml()
    assert Case.from_toml(loaded.to_toml()) == loaded


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (None, r"shape\.csv: there is no such file"),
        (b"", "has 0 rows"),
        (b"angle, radius\n", "has 0 rows"),
        (b"0, 1, 2\n" * 5, r"the row '0,1,2' has 3 columns"),
        (b"angle [deg]; radius [mm]\n0; 25,9\n1; 25,8\n2; 25,7\n", r"\[0\]\[1\]: .* decimal point, '25\.9 mm'"),
        (b"0, 25 mm\n1, 25 mm\n0.5, 25 mm\n", "do not grow"),
        (b"angle [kg], radius\n0, 1\n1, 1\n2, 1\n", r"free_shape\[0\]\[0\]: '0 kg' measures something else"),
        (b"\x89PNG\r\n\xff", "not a text in UTF-8"),
        (b"0," + b"9" * 2**20, "has more than 1 MiB"),
    ],
)  # fmt: skip
def test_a_file_that_holds_no_shape_is_refused(content: bytes | None, reason: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "shape.csv").write_bytes(content)
    with pytest.raises(DefinitionError, match=reason) as caught:
        measured(str(tmp_path / "shape.csv"))
    assert caught.value.key.startswith("petals.free_shape")
