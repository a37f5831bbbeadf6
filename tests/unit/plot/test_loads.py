"""Figures over speed, load and whirl frequency."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results import Record, Scalar
from petalfoil.results.chart import chart_dataset
from petalfoil.results.dataset import curve_dataset, to_dataset

RPM = 30.0 / math.pi
Texts = Callable[[Figure], str]


def record(analysis: str, failed: bool = False, **own: Scalar) -> Record:
    ended: dict[str, Scalar] = {
        "converged": not failed,
        "status": "lost" if failed else "converged",
        "contact_film_thickness": 1e-6,
    }
    return Record(analysis=analysis, scalars=ended | own, title="Eight petals")


def runup(failing: frozenset[int] = frozenset()) -> xr.Dataset:
    way = [("up", v) for v in (0.0, 100.0, 200.0)] + [("down", v) for v in (100.0, 0.0)]
    records = []
    for number, (leg, speed) in enumerate(way):
        own = {
            "friction_torque": 0.4 - 1e-3 * speed,
            "contact_fraction": 1.0 - speed / 200.0,
            "min_film_thickness": 1e-6,
        }
        place = {"eccentricity_x": 3e-5, "eccentricity_y": -4e-5, "load_x": 0.0, "load_y": -20.0}
        records.append(record("runup", number in failing, speed=speed, leg=leg, **own, **place))
    return curve_dataset(records, "runup")


def liftoff(*up: float) -> xr.Dataset:
    sizes = [30.0, 10.0, 20.0][: len(up)]
    records = [
        record("liftoff", math.isnan(v), load_x=0.0, load_y=-size, share=0.01, liftoff_speed=v, touchdown_speed=0.9 * v)
        for size, v in zip(sizes, up, strict=True)
    ]
    return curve_dataset(records, "liftoff")


def coefficients(speeds: list[float], frequencies: list[float], failing: frozenset[int] = frozenset()) -> xr.Dataset:
    records = []
    for number, speed in enumerate(speeds):
        table = speed + np.array(frequencies)[:, None, None] + np.arange(4.0).reshape(1, 2, 2)
        fields = {"stiffness": 1e6 * table, "damping": -table}
        coords = {"whirl_frequency": np.array(frequencies), "row": np.arange(2), "column": np.arange(2)}
        given = record("coefficients", number in failing, speed=speed, eccentricity_x=0.0, eccentricity_y=-1e-5)
        kept = {} if number in failing else {"fields": fields, "coords": coords}
        records.append(Record(analysis="coefficients", scalars=given.scalars, title=given.title, **kept))
    return to_dataset(records[0]) if len(records) == 1 else curve_dataset(records, "coefficients")


def chart(masses: dict[tuple[float, float], float]) -> xr.Dataset:
    return chart_dataset(
        [
            record(
                "stability",
                math.isnan(mass),
                load_x=0.0,
                load_y=-size,
                speed=speed,
                critical_mass=mass,
                whirl_ratio=0.5 if math.isfinite(mass) else math.nan,
            )
            for (size, speed), mass in masses.items()
        ]
    )


def line(ax: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    (found,) = [item for item in ax.lines if item.get_label() == label]
    return np.asarray(found.get_xdata(), float), np.asarray(found.get_ydata(), float)


# ---------------------------------------------------------------------------------------------- run-up, lift-off


def test_a_run_up_is_drawn_in_rpm_on_both_legs(texts: Texts) -> None:
    fig = plot.summary(runup())
    assert "load 20 N" in texts(fig)
    torque, share, film, distance = fig.axes
    up, down = line(torque, "up"), line(torque, "down")
    assert_allclose(up[0], np.array([0.0, 100.0, 200.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(up[1], [400.0, 300.0, 200.0], rtol=1e-12, atol=0.0)
    assert_allclose(down[0], np.array([200.0, 100.0, 0.0]) * RPM, rtol=1e-12, atol=0.0)  # begins where the way up ends
    assert_allclose(line(share, "up")[1], [100.0, 50.0, 0.0], rtol=0.0, atol=1e-12)
    assert_allclose(line(film, "up")[1], 1.0, rtol=1e-12, atol=0.0)
    assert_allclose(line(distance, "up")[1], 50.0, rtol=1e-12, atol=0.0)


def test_a_point_of_a_run_up_that_failed_leaves_a_gap_and_a_cross() -> None:
    torque = plot.runup(runup(frozenset({1}))).axes[0]
    assert np.isnan(line(torque, "up")[1][1])
    assert_allclose(line(torque, "did not converge")[0], [100.0 * RPM], rtol=1e-12, atol=0.0)


def test_lift_off_is_over_the_load_in_its_order(texts: Texts) -> None:
    fig = plot.summary(liftoff(300.0, 100.0, 200.0))
    assert "less than 1 %" in texts(fig)
    (ax,) = fig.axes
    assert_allclose(line(ax, "lift-off")[0], [10.0, 20.0, 30.0], rtol=1e-12, atol=0.0)
    assert_allclose(line(ax, "lift-off")[1], np.array([100.0, 200.0, 300.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(line(ax, "touch-down")[1], np.array([90.0, 180.0, 270.0]) * RPM, rtol=1e-12, atol=0.0)


def test_loads_without_lift_off_or_answer_are_marked() -> None:
    (ax,) = plot.liftoff(liftoff(math.inf, 100.0, math.nan)).axes
    assert_allclose(line(ax, "does not lift off")[0], [30.0], rtol=1e-12, atol=0.0)
    assert_allclose(line(ax, "did not converge")[0], [20.0], rtol=1e-12, atol=0.0)


def test_nothing_is_drawn_from_nothing() -> None:
    for refused in (
        lambda: plot.runup(runup(frozenset(range(5)))),
        lambda: plot.liftoff(liftoff(math.nan)),
        lambda: plot.coefficients(coefficients([1.0, 2.0], [1.0], frozenset({0})).isel(point=[0])),
        lambda: plot.stability(chart({(5.0, 1.0): math.nan})),
    ):
        with pytest.raises(ConvergenceError):
            refused()
    for drawn in (plot.coefficients, plot.stability):
        with pytest.raises(UsageError):
            drawn(runup())


# ---------------------------------------------------------------------------------------------- coefficients


def test_coefficients_at_one_speed_are_two_panels_over_the_frequency() -> None:
    stiffness, damping = plot.summary(coefficients([100.0], [50.0, 100.0, 200.0])).axes
    assert_allclose(line(stiffness, "K$_{yx}$")[0], [50.0, 100.0, 200.0], rtol=1e-12, atol=0.0)
    assert_allclose(line(stiffness, "K$_{yx}$")[1], 1e6 * np.array([152.0, 202.0, 302.0]), rtol=1e-12, atol=0.0)
    assert_allclose(line(damping, "C$_{xy}$")[1], [-151.0, -201.0, -301.0], rtol=1e-12, atol=0.0)
    assert_allclose(line(stiffness, "Ω = ω")[0], 100.0, rtol=1e-12, atol=0.0)


def test_coefficients_at_several_speeds_are_a_panel_for_each_entry(texts: Texts) -> None:
    fig = plot.coefficients(coefficients([300.0, 100.0, 200.0], [50.0, 100.0], frozenset({2})))
    assert len(fig.axes) == 8
    assert [len(ax.lines) for ax in fig.axes] == [3] * 8  # two speeds and the zero
    assert "955 rpm to 2" in texts(fig)


def test_coefficients_at_one_frequency_are_over_the_speed() -> None:
    stiffness, _ = plot.coefficients(coefficients([300.0, 100.0], [50.0])).axes
    assert_allclose(line(stiffness, "K$_{xx}$")[0], np.array([100.0, 300.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(line(stiffness, "K$_{xx}$")[1], [150e6, 350e6], rtol=1e-12, atol=0.0)


# ---------------------------------------------------------------------------------------------- stability


def test_a_chart_has_a_line_for_each_load(texts: Texts) -> None:
    masses = {(5.0, 200.0): 0.01, (5.0, 100.0): 0.4, (20.0, 200.0): 1.0, (20.0, 100.0): math.inf}
    fig = plot.summary(chart(masses))
    above, below = fig.axes
    assert_allclose(line(above, "load 5 N")[0], np.array([100.0, 200.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(line(above, "load 5 N")[1], [0.4, 0.01], rtol=1e-12, atol=0.0)
    assert np.isnan(line(above, "load 20 N")[1][0])
    assert "no mass whirls" in texts(fig)
    (calm,) = [item for item in above.lines if item.get_gid() == "calm"]
    assert_allclose(calm.get_xdata(), [100.0 * RPM], rtol=1e-12, atol=0.0)
    assert (above.get_yscale(), len(below.lines)) == ("log", 2)


def test_a_single_point_shows_the_rotor_and_its_threshold(texts: Texts) -> None:
    own = {"critical_mass": 3.0, "whirl_ratio": 0.48, "rotor_mass": 2.0, "threshold_speed": 300.0 / RPM}
    place = {"speed": 100.0, "eccentricity_x": 0.0, "eccentricity_y": -1e-5}
    fig = plot.summary(to_dataset(record("stability", **own, **place)))
    said = texts(fig)
    assert "rotor, 2 kg" in said
    assert "begins to whirl at 300 rpm" in said
    assert "10 µm" in said
