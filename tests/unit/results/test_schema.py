import subprocess
import sys

from petalfoil.analysis import sensitivity, sensitivity_table  # noqa: F401 - the analysis declares the table
from petalfoil.results.schema import COORDINATES, FIELDS, HISTORIES, SCALARS, VARIABLES
from petalfoil.results.variable import DataType, Role

UNITS_THAT_VARY = {
    name
    for name, variable in sensitivity_table.RESULTS.items()
    if variable.kind is DataType.FLOAT and not variable.units
}
"""Results of a table over many quantities: `parameter_unit` and `quantity_unit` say their units."""

SOLVE_KEYS = """
    speed eccentricity_x eccentricity_y force_x force_y bearing_force attitude_angle film_force_x film_force_y
    contact_force_x contact_force_y contact_normal_force contact_fraction min_film_thickness peak_pressure
    friction_torque power_loss side_leakage max_bending_stress residual iterations
    factorizations wall_time converged status""".split()


def test_every_variable_has_a_long_name_a_symbol_and_known_dimensions() -> None:
    assert [name for name, variable in VARIABLES.items() if not (variable.long_name and variable.symbol)] == []
    assert [name for name, variable in VARIABLES.items() if not set(variable.dims) <= set(COORDINATES)] == []


def test_numbers_have_a_unit_and_text_and_flags_have_none() -> None:
    numbers = {name for name, variable in VARIABLES.items() if variable.kind in (DataType.FLOAT, DataType.INT)}
    with_unit = {name for name, variable in VARIABLES.items() if variable.units}
    assert with_unit | UNITS_THAT_VARY == numbers
    assert not with_unit & UNITS_THAT_VARY


def test_a_name_means_one_thing() -> None:
    """A figure and its history over time may share a name; then they are the same quantity."""
    shared = FIELDS.keys() & SCALARS.keys()
    assert shared <= HISTORIES.keys()
    assert not COORDINATES.keys() & (FIELDS.keys() | SCALARS.keys())
    for name in shared:
        assert FIELDS[name].dims == ("time",)
        assert (FIELDS[name].units, FIELDS[name].symbol) == (SCALARS[name].units, SCALARS[name].symbol)
        assert FIELDS[name].long_name == SCALARS[name].long_name
    assert len(VARIABLES) == len(COORDINATES) + len(FIELDS) + len(SCALARS) - len(shared)


def test_the_keys_of_solve_are_declared_as_scalars() -> None:
    assert set(SOLVE_KEYS) <= set(SCALARS)
    assert all(SCALARS[name].dims == () for name in SCALARS)


def test_no_answer_is_a_whole_number() -> None:
    """An answer that is not there must be able to say so, and a whole number has no NaN."""
    assert [
        name for name, variable in VARIABLES.items() if variable.role is Role.ANSWER and variable.kind is DataType.INT
    ] == []


def test_results_does_not_load_xarray_until_asked() -> None:
    code = "import sys, petalfoil.results, petalfoil.results.summary, petalfoil.results.atomic; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert {"xarray", "netCDF4", "pandas", "matplotlib"} & set(run.stdout.split()) == set()
