import math

import numpy as np
import pytest

from petalfoil.results import Record
from petalfoil.results.record import warnings_of_all
from tests.unit.results import factory


def test_an_unknown_scalar_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(ValueError, match=r"no scalar 'bearing_forse'.*Did you mean 'bearing_force'"):
        Record(analysis="solve", scalars={"bearing_forse": 1.0})


def test_unknown_fields_and_coordinates_are_refused() -> None:
    with pytest.raises(ValueError, match="no field 'presure'"):
        Record(analysis="solve", scalars={}, fields={"presure": np.zeros(3)})
    with pytest.raises(ValueError, match="no coordinate 'theta'"):
        Record(analysis="solve", scalars={}, coords={"theta": np.zeros(3)})


def test_a_figure_is_given_once_or_over_time_but_not_both() -> None:
    over = {"coords": {"time": np.zeros(2)}, "fields": {"min_film_thickness": np.ones(2)}}
    assert Record(analysis="orbit", scalars={}, **over).fields["min_film_thickness"].shape == (2,)
    with pytest.raises(ValueError, match="'min_film_thickness' is given as a scalar and as a field"):
        Record(analysis="orbit", scalars={"min_film_thickness": 1e-6}, **over)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("speed", "fast"),
        ("speed", True),
        ("converged", 1),
        ("iterations", 2.0),
        ("iterations", True),
        ("status", 0),
        ("solution_path", None),
    ],
)
def test_a_value_of_another_type_is_refused(name: str, value: object) -> None:
    with pytest.raises(ValueError, match=f"scalar '{name}' must be"):
        Record(analysis="solve", scalars={name: value})


def test_numpy_scalars_come_back_as_plain_python() -> None:
    record = Record(
        analysis="solve",
        scalars={"speed": np.float64(2.0), "iterations": np.int64(3), "converged": np.True_, "force_x": 4},
    )
    reported = record.reported()
    assert [type(value) for value in reported.values()] == [float, int, bool, float]
    assert reported == {"speed": 2.0, "iterations": 3, "converged": True, "force_x": 4.0}


def test_a_field_of_another_shape_is_refused() -> None:
    good = factory.solved()
    turned = good.fields["pressure"].transpose(1, 0, 2)
    with pytest.raises(ValueError, match=r"'pressure' must have shape \(8, 33, 1\)"):
        Record(analysis="solve", scalars={}, fields={"pressure": turned}, coords=good.coords)
    with pytest.raises(ValueError, match="needs the coordinate 'petal'"):
        Record(analysis="solve", scalars={}, fields={"pressure": turned})


def test_figures_of_a_state_that_did_not_converge_are_withheld() -> None:
    reported = factory.failed().reported()
    assert math.isnan(reported["bearing_force"])
    assert math.isnan(reported["force_y"])
    assert reported["stable"] is False
    assert reported["eccentricity_y"] == -300e-6
    assert reported["status"] == "the step length fell below its limit"
    assert reported["iterations"] == 18
    assert reported["journal_radius"] == 25e-3


def test_two_doubts_of_one_key_are_both_told() -> None:
    """At 570 000 rpm the Mach number of the surface and the Reynolds number of the film are both too high."""
    fast = ("operation.speed: Mach 4.4", "operation.speed: Reynolds number 2000")
    faster = ("operation.speed: Mach 5", "operation.speed: Reynolds number 3000")
    records = [Record(analysis="solve", scalars={}, warnings=warnings) for warnings in (fast, faster)]
    assert warnings_of_all(records[:1]) == fast
    assert warnings_of_all(records) == tuple(f"{text} (1 more point alike)" for text in fast)
