import json

import numpy as np
import pytest

from petalfoil.results import Record
from petalfoil.results.dataset import curve_dataset, to_dataset
from petalfoil.results.layout import scalars_of_point
from petalfoil.results.schema import VARIABLES
from tests.unit.results import factory


@pytest.mark.parametrize(
    "record", [factory.solved(), factory.solved(nz=5), factory.plain(), factory.at_rest(), factory.checked()]
)
def test_a_point_carries_its_numbers_with_units_names_and_symbols(record: Record) -> None:
    ds = to_dataset(record)
    assert set(ds.variables) == {*record.scalars, *record.fields, *record.coords}
    for name, variable in ds.variables.items():
        declared = VARIABLES[str(name)]
        assert variable.dims == declared.dims
        assert variable.attrs.get("units", "") == declared.units
        assert variable.attrs["long_name"] == declared.long_name
        assert variable.attrs["symbol"] == declared.symbol
    for name, values in {**record.fields, **record.coords}.items():
        np.testing.assert_array_equal(ds[name].values, values)
    assert {name: ds[name].item() for name in record.scalars} == record.scalars


def test_the_case_and_the_history_travel_as_attributes() -> None:
    attrs = to_dataset(factory.solved()).attrs
    assert attrs["case"] == factory.CASE
    assert attrs["title"] == "Paper, flat study, 8 petals"
    assert attrs["analysis"] == "solve"
    assert attrs["petalfoil_version"]
    assert json.loads(attrs["history"])[1] == {"phase": "film", "iteration": 2, "residual": None}  # NaN is not JSON


def test_flags_are_described_in_the_cf_way() -> None:
    converged = to_dataset(factory.solved())["converged"]
    assert converged.dtype == bool
    assert converged.attrs["flag_meanings"] == "false true"


def test_a_point_that_did_not_converge_keeps_no_field_and_no_figure() -> None:
    good = factory.solved()
    bad = Record(**{**vars(good), "scalars": {**good.scalars, "converged": False}})
    ds = to_dataset(bad)
    assert [name for name in bad.fields if name in ds] == ["free_radius"]
    assert np.isnan(ds["bearing_force"])
    assert ds["speed"] == 8000.0


def test_a_curve_has_the_points_in_front_and_the_geometry_once() -> None:
    records = factory.curve()
    ds = curve_dataset(records)
    assert ds.attrs["analysis"] == "curve"
    assert ds["pressure"].dims == ("point", "petal", "phi_exposed", "z")
    assert ds["bearing_force"].dims == ("point",)
    assert ds["journal_radius"].dims == ()
    assert ds["free_radius"].dims == ("phi",)
    assert ds["status"].dims == ("point",)
    assert len(json.loads(ds.attrs["history"])) == len(records)
    for number in (0, 7):
        np.testing.assert_array_equal(ds["radius"][number].values, records[number].fields["radius"])
        assert ds["bearing_force"][number] == records[number].scalars["bearing_force"]


def test_a_failed_point_of_a_curve_is_nan_and_says_why() -> None:
    ds = curve_dataset(factory.curve())
    assert ds["converged"].values.tolist() == [True] * 4 + [False] + [True] * 3
    assert np.isnan(ds["pressure"][4]).all()
    assert np.isnan(ds["bearing_force"][4])
    assert ds["eccentricity_y"][4] == pytest.approx(-160e-6, rel=1e-12)
    assert ds["status"][4] == "the step length fell below its limit"
    assert not np.isnan(ds["pressure"].isel(point=[0, 1, 2, 3, 5, 6, 7])).any()


def test_a_curve_whose_points_all_failed_still_tells_where_they_are() -> None:
    ds = curve_dataset([factory.failed(1e-4), factory.failed(2e-4)])
    assert not ds["converged"].any()
    assert ds["eccentricity_y"].values.tolist() == [-1e-4, -2e-4]
    assert "pressure" not in ds


def test_points_of_different_grids_or_geometries_do_not_line_up() -> None:
    with pytest.raises(ValueError, match="share the coordinate"):
        curve_dataset([factory.solved(petals=8), factory.solved(petals=6)])
    good = factory.solved()
    wider = Record(**{**vars(good), "scalars": {**good.scalars, "bushing_radius": 27e-3}})
    with pytest.raises(ValueError, match="share 'bushing_radius'"):
        curve_dataset([good, wider])
    with pytest.raises(ValueError, match="at least one record"):
        curve_dataset([])


def test_a_flag_is_never_made_up_for_a_converged_point() -> None:
    good = factory.solved()
    flagged = Record(**{**vars(good), "scalars": {**good.scalars, "stable": True}})
    with pytest.raises(ValueError, match="lacks 'stable'"):
        curve_dataset([flagged, good])


def test_a_count_missing_from_a_failed_point_is_marked() -> None:
    scalars = {"converged": False, "speed": 8000.0}
    ds = curve_dataset([factory.solved(), Record(analysis="solve", scalars=scalars)])
    assert ds["iterations"].values.tolist() == [18, -1]
    assert "-1" in ds["iterations"].attrs["comment"]


def test_a_count_of_some_points_only_is_left_out_of_the_others() -> None:
    """Equilibria are counted where others were looked for, or met in a jump."""
    first = factory.solved()
    followed = Record(**{**vars(first), "scalars": {k: v for k, v in first.scalars.items() if k != "known_equilibria"}})
    ds = curve_dataset([first, followed])
    assert ds["known_equilibria"].values.tolist() == [1, -1]
    assert ["known_equilibria" in scalars_of_point(ds.isel(point=k)) for k in range(2)] == [True, False]
