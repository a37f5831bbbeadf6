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
from petalfoil.results.dataset import curve_dataset, to_dataset
from petalfoil.results.grid import grid_dataset

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
        record(
            "liftoff",
            math.isnan(v),
            load_x=0.0,
            load_y=-size,
            contact_fraction_limit=0.01,
            liftoff_speed=v,
            touchdown_speed=0.9 * v,
        )
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
    return grid_dataset(
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
        ],
        "stability",
    )


def line(ax: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    (found,) = [item for item in ax.lines if item.get_label() == label]
    return np.asarray(found.get_xdata(), float), np.asarray(found.get_ydata(), float)


# ---------------------------------------------------------------------------------------------- run-up, lift-off


def test_a_run_up_is_drawn_in_rpm_on_both_legs(texts: Texts) -> None:
    fig = plot.summary(runup())
    assert "load 20 N" in texts(fig)
    torque, share, film, distance = fig.axes
    up, down = line(torque, "speed up"), line(torque, "speed down")
    assert_allclose(up[0], np.array([0.0, 100.0, 200.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(up[1], [400.0, 300.0, 200.0], rtol=1e-12, atol=0.0)
    assert_allclose(down[0], np.array([200.0, 100.0, 0.0]) * RPM, rtol=1e-12, atol=0.0)  # begins where the way up ends
    assert_allclose(line(share, "speed up")[1], [100.0, 50.0, 0.0], rtol=0.0, atol=1e-12)
    assert_allclose(line(film, "speed up")[1], 1.0, rtol=1e-12, atol=0.0)
    assert_allclose(line(distance, "speed up")[1], 50.0, rtol=1e-12, atol=0.0)


def test_a_point_of_a_run_up_that_failed_leaves_a_gap_and_a_cross() -> None:
    torque = plot.runup(runup(frozenset({1}))).axes[0]
    assert np.isnan(line(torque, "speed up")[1][1])
    assert_allclose(line(torque, "did not converge")[0], [100.0 * RPM], rtol=1e-12, atol=0.0)


def test_lift_off_is_over_the_load_in_its_order(texts: Texts) -> None:
    fig = plot.summary(liftoff(300.0, 100.0, 200.0))
    assert "below 1 %" in texts(fig)
    (ax,) = fig.axes
    assert_allclose(line(ax, "lift-off")[0], [10.0, 20.0, 30.0], rtol=1e-12, atol=0.0)
    assert_allclose(line(ax, "lift-off")[1], np.array([100.0, 200.0, 300.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(line(ax, "touchdown")[1], np.array([90.0, 180.0, 270.0]) * RPM, rtol=1e-12, atol=0.0)


def test_loads_without_lift_off_or_answer_are_marked() -> None:
    (ax,) = plot.liftoff(liftoff(math.inf, 100.0, math.nan)).axes
    assert_allclose(line(ax, "no lift-off")[0], [30.0], rtol=1e-12, atol=0.0)
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


def test_where_up_and_down_coincide_both_are_seen() -> None:
    coasting, landing = plot.runup(runup()).axes[0], plot.liftoff(liftoff(300.0, 100.0)).axes[0]
    for ax, labels in ((coasting, ("speed up", "speed down")), (landing, ("lift-off", "touchdown"))):
        below, above = (next(item for item in ax.lines if item.get_label() == label) for label in labels)
        assert below.get_zorder() < above.get_zorder()
        assert below.get_linewidth() > 2.0 * above.get_linewidth()
        assert below.get_markersize() > 2.0 * above.get_markersize()
        assert below.get_color() != above.get_color()


def test_speeds_of_lift_off_stay_inside_the_axes() -> None:
    (ax,) = plot.liftoff(liftoff(300.0, 100.0, 200.0)).axes
    assert ax.get_ylim()[1] > 1.1 * 300.0 * RPM


def test_lift_off_of_one_load_is_two_bars(texts: Texts) -> None:
    fig = plot.liftoff(liftoff(300.0))
    (ax,) = fig.axes
    assert_allclose([bar.get_width() for bar in ax.patches], np.array([300.0, 270.0]) * RPM, rtol=1e-12, atol=0.0)
    assert "load 30 N" in texts(fig)
    assert ax.get_xlim()[1] > 300.0 * RPM


def test_one_load_that_does_not_lift_off_says_so_on_axes_without_speeds(texts: Texts) -> None:
    never = liftoff(math.inf)
    never["status"] = never["status"].copy(data=["does not lift off below 9000 rpm"])
    fig = plot.liftoff(never)
    assert len([text for text in texts(fig).splitlines() if "none: does not lift off below 9000 rpm" in text]) == 2
    assert not len(fig.axes[0].get_xticks())


def test_loads_of_which_none_lifts_off_have_no_speeds_to_read() -> None:
    (ax,) = plot.liftoff(liftoff(math.inf, math.inf)).axes
    assert line(ax, "no lift-off")[0].tolist() == [30.0, 10.0]
    assert not len(ax.get_yticks())


# ---------------------------------------------------------------------------------------------- coefficients


def test_coefficients_at_one_speed_are_two_panels_over_the_frequency() -> None:
    stiffness, damping = plot.summary(coefficients([100.0], [50.0, 100.0, 200.0])).axes
    assert_allclose(
        line(stiffness, "K, C$_{yx}$")[0], np.array([50.0, 100.0, 200.0]) / (2.0 * math.pi), rtol=1e-12, atol=0.0
    )
    assert_allclose(line(stiffness, "K, C$_{yx}$")[1], 1e6 * np.array([152.0, 202.0, 302.0]), rtol=1e-12, atol=0.0)
    assert_allclose(line(damping, "K, C$_{xy}$")[1], [-151.0, -201.0, -301.0], rtol=1e-12, atol=0.0)
    assert_allclose(line(stiffness, "synchronous, Ω = ω")[0], 100.0 / (2.0 * math.pi), rtol=1e-12, atol=0.0)


@pytest.mark.slow
def test_coefficients_at_several_speeds_are_a_panel_for_each_entry(texts: Texts) -> None:
    fig = plot.coefficients(coefficients([300.0, 100.0, 200.0], [50.0, 100.0], frozenset({2})))
    assert len(fig.axes) == 8
    curves = [[item for item in ax.lines if "rpm" in str(item.get_label())] for ax in fig.axes]
    assert [len(found) for found in curves] == [2] * 8
    assert "955 rpm to 2" in texts(fig)


def test_coefficients_at_one_frequency_are_over_the_speed() -> None:
    stiffness, _ = plot.coefficients(coefficients([300.0, 100.0], [50.0])).axes
    assert_allclose(line(stiffness, "K, C$_{xx}$")[0], np.array([100.0, 300.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(line(stiffness, "K, C$_{xx}$")[1], [150e6, 350e6], rtol=1e-12, atol=0.0)


def test_coefficients_at_one_speed_and_frequency_are_bars_with_their_values(texts: Texts) -> None:
    fig = plot.coefficients(coefficients([100.0], [50.0]))
    stiffness, damping = fig.axes
    assert_allclose(
        [bar.get_width() for bar in stiffness.patches], 1e6 * (150.0 + np.arange(4.0)), rtol=1e-12, atol=0.0
    )
    assert_allclose([bar.get_width() for bar in damping.patches], -150.0 - np.arange(4.0), rtol=1e-12, atol=0.0)
    assert "1.53e+08" in texts(fig)
    assert "whirl frequency 7.958 Hz" in texts(fig)
    for ax in fig.axes:
        low, high = ax.get_xlim()
        fig.draw_without_rendering()
        assert all(low < bar.get_width() < high for bar in ax.patches)
        assert all(ax.bbox.x1 >= text.get_window_extent().x1 for text in ax.texts)


@pytest.mark.slow
def test_frequencies_are_in_hertz_and_speeds_in_rpm(texts: Texts) -> None:
    for speeds, frequencies in (([300.0], [50.0, 400.0]), ([300.0, 100.0], [50.0, 400.0]), ([300.0, 100.0], [50.0])):
        said = texts(plot.coefficients(coefficients(speeds, frequencies)))
        assert "rad/s" not in said
        assert "rpm" in said
        assert "Hz" in said


def test_the_synchronous_place_of_each_speed_is_marked() -> None:
    fig = plot.coefficients(coefficients([300.0, 100.0], [50.0, 200.0]))
    marks = [item for item in fig.axes[0].lines if item.get_gid() == "synchronous"]
    assert_allclose([item.get_xdata()[0] for item in marks], [100.0 / (2.0 * math.pi)], rtol=1e-12, atol=0.0)
    assert_allclose([item.get_ydata()[0] for item in marks], [200e6], rtol=1e-9, atol=0.0)


def test_a_coefficient_that_hardly_changes_looks_constant() -> None:
    ds = coefficients([300.0, 100.0], [50.0, 60.0])
    nearly = ds.assign(stiffness=1e6 + 1e-6 * ds["stiffness"])
    low, high = plot.coefficients(nearly).axes[0].get_ylim()
    assert high - low > 0.09e6


# ---------------------------------------------------------------------------------------------- stability


@pytest.mark.slow
def test_a_chart_has_a_line_for_each_load(texts: Texts) -> None:
    masses = {(5.0, 200.0): 0.01, (5.0, 100.0): 0.4, (20.0, 200.0): 1.0, (20.0, 100.0): math.inf}
    fig = plot.summary(chart(masses))
    above, below = fig.axes
    assert_allclose(line(above, "load 5 N")[0], np.array([100.0, 200.0]) * RPM, rtol=1e-12, atol=0.0)
    assert_allclose(line(above, "load 5 N")[1], [0.4, 0.01], rtol=1e-12, atol=0.0)
    assert np.isnan(line(above, "load 20 N")[1][0])
    assert "stable for any rotor mass" in texts(fig)
    (calm,) = [item for item in above.lines if item.get_gid() == "calm"]
    assert_allclose(calm.get_xdata(), [100.0 * RPM], rtol=1e-12, atol=0.0)
    assert (above.get_yscale(), len(below.lines)) == ("log", 2)


def test_a_single_point_shows_the_rotor_and_its_threshold(texts: Texts) -> None:
    own = {"critical_mass": 3.0, "whirl_ratio": 0.48, "rotor_mass": 2.0, "threshold_speed": 300.0 / RPM}
    place = {"speed": 100.0, "eccentricity_x": 0.0, "eccentricity_y": -1e-5}
    fig = plot.summary(to_dataset(record("stability", **own, **place)))
    said = texts(fig)
    assert "rotor, 2 kg" in said
    assert "threshold speed 300 rpm" in said
    assert "10 µm" in said


def test_whirl_ratios_stay_inside_the_axes() -> None:
    for ratio in (0.48, 2.87, -1.3):
        ds = chart({(5.0, 100.0): 0.4, (5.0, 200.0): 0.2})
        fig = plot.stability(ds.assign(whirl_ratio=(ds["whirl_ratio"].dims, np.array([[0.5, ratio]]))))
        low, high = fig.axes[1].get_ylim()
        assert low <= min(ratio, 0.0)
        assert max(ratio, 0.6) <= high
        for ax in fig.axes:
            assert ax.has_data()


def test_a_chart_that_is_stable_for_any_mass_is_a_map_without_empty_panels(texts: Texts) -> None:
    fig = plot.stability(chart({(size, speed): math.inf for size in (5.0, 20.0) for speed in (100.0, 200.0)}))
    (ax,) = fig.axes
    calm = line(ax, "stable for any rotor mass")
    assert sorted(zip(*calm, strict=True)) == [(s * RPM, n) for s in (100.0, 200.0) for n in (5.0, 20.0)]
    assert ax.get_ylim()[0] == 0.0


def test_states_whose_rotors_are_neutral_are_marked_apart(texts: Texts) -> None:
    ds = chart({(size, speed): math.inf for size in (5.0, 20.0) for speed in (100.0, 200.0)})
    words = np.array([["converged; no mass is critical, neutral", "converged"], ["converged", "converged"]])
    told = ds.assign(status=(ds["status"].dims, words))
    marks = {item.get_gid(): np.size(item.get_xdata()) for item in plot.stability(told).axes[0].lines}
    assert (marks["calm"], marks["neutral"]) == (3, 1)
    mixed = told.assign(critical_mass=(ds["critical_mass"].dims, np.array([[math.inf, 1.0], [math.inf, 2.0]])))
    said = texts(plot.stability(mixed))
    assert "stable for any rotor mass" in said
    assert "the rotor is neutral" in said


def point(**own: Scalar) -> xr.Dataset:
    place = {"speed": 100.0, "eccentricity_x": 0.0, "eccentricity_y": -1e-5}
    return to_dataset(record("stability", **(place | own)))


@pytest.mark.parametrize(
    ("mass", "rotor", "says"),
    [
        (3.0, 2.0, "stable below\n3 kg"),
        (3.0, 9.0, "whirls above 3 kg"),
        (math.inf, 2.0, "stable for any rotor mass"),
        (math.inf, math.nan, "stable for any rotor mass"),
        (0.0, math.nan, "whirls at any rotor mass"),
        (3.0, math.nan, "whirl ratio 2.87"),
    ],
)
def test_one_speed_has_no_empty_panel(mass: float, rotor: float, says: str, texts: Texts) -> None:
    ratio = 2.87 if math.isfinite(mass) else math.nan
    fig = plot.stability(point(critical_mass=mass, whirl_ratio=ratio, rotor_mass=rotor))
    (ax,) = fig.axes
    assert says in texts(fig)
    assert [item.get_gid() for item in ax.lines] == (["rotor"] if math.isfinite(rotor) else [])
    (right,) = [limit for limit in ax.get_xlim() if limit > 0.0]
    assert all(value < right for value in (mass, rotor) if math.isfinite(value))


def test_masses_and_frequencies_that_are_far_apart_are_all_seen() -> None:
    ds = point(critical_mass=40.0, whirl_ratio=0.48, rotor_mass=0.2, speed=8000.0).assign(
        natural_frequency=("mode", [220.0, 240.0]),
        mode_growth_rate=("mode", [-5.0, -12.0]),
        whirl_direction=("mode", [1.0, -1.0]),
    )
    masses, modes = plot.stability(ds).axes
    for ax, values in ((masses, (0.2, 40.0)), (modes, (220.0 / (2.0 * math.pi), 8000.0 / (2.0 * math.pi)))):
        drawn = ax.transAxes.inverted().transform(ax.transData.transform([(value, -1.0) for value in values]))[:, 0]
        assert 0.05 < drawn[0] < 0.4
        assert 0.6 < drawn[1] < 0.95
    low, high = modes.get_ylim()
    assert -low > 3.0 * high > 0.0  # modes that all decay leave the unstable half a strip


def crossing(direction: float, others: float = 1.0) -> xr.Dataset:
    """Two branches over two speeds [rad/s], both of which have the frequency of the speed at 150 rad/s."""
    place = {"eccentricity_x": 0.0, "eccentricity_y": -1e-5, "load_x": 0.0, "load_y": -5.0, "rotor_mass": 1.0}
    points = [record("stability", critical_mass=3.0, speed=speed, **place) for speed in (100.0, 200.0)]
    branches = ("point", "mode")
    return curve_dataset(points).assign(
        natural_frequency=(branches, [[150.0, 150.0], [150.0, 150.0]]),
        damping_ratio=(branches, [[0.1, 0.1], [0.1, 0.1]]),
        whirl_direction=(branches, [[direction, others]] * 2),
        critical_speed=(branches, [[math.nan, math.nan], [150.0, 150.0]]),
    )


def test_a_backward_mode_at_the_speed_is_no_critical_speed(texts: Texts) -> None:
    fig = plot.campbell(crossing(-1.0))
    marks = {item.get_gid(): np.size(item.get_xdata()) for item in fig.axes[0].lines if item.get_gid()}
    assert marks["critical"] == marks["backward crossing"] == 1
    assert texts(fig).count("1\u2009432 rpm") == 1  # marks at one place share their label
    forward, backward = (line for line in fig.axes[0].lines if line.get_label().startswith("cylindrical"))
    if forward.get_label().endswith("backward"):
        forward, backward = backward, forward
    assert forward.get_linewidth() > backward.get_linewidth()
    assert backward.get_zorder() > forward.get_zorder()


def test_modes_that_grow_are_ringed_and_those_that_are_neutral_otherwise(texts: Texts) -> None:
    ratios = [[-2e-4, 5e-5], [-5e-5, 0.1]]
    fig = plot.campbell(crossing(1.0).assign(damping_ratio=(("point", "mode"), ratios)))
    rings = [
        (item.get_gid(), np.size(item.get_xdata()))
        for item in fig.axes[0].lines
        if item.get_gid() in ("growing", "neutral")
    ]
    assert sorted(rings) == [("growing", 1), ("neutral", 1), ("neutral", 1)]
    assert "neither grows nor decays" in texts(fig)


def test_natural_modes_of_a_point_are_inside_their_axes(texts: Texts) -> None:
    ds = point(critical_mass=3.0, whirl_ratio=0.48, rotor_mass=2.0).assign(
        natural_frequency=("mode", [2000.0, 300.0]),
        mode_growth_rate=("mode", [-5.0, 12.0]),
        whirl_direction=("mode", [1.0, -1.0]),
    )
    fig = plot.stability(ds)
    modes = next(ax for ax in fig.axes if ax.get_ylabel() == "growth rate [1/s]")
    forward, backward = line(modes, "forward whirl"), line(modes, "backward whirl")
    assert_allclose([*forward[0], *backward[0]], np.array([2000.0, 300.0]) / (2.0 * math.pi), rtol=1e-12, atol=0.0)
    assert_allclose([*forward[1], *backward[1]], [-5.0, 12.0], rtol=1e-12, atol=0.0)
    assert modes.get_xlim()[1] > 2000.0 / (2.0 * math.pi)
    assert modes.get_ylim()[1] > 12.0
    assert "speed, 15.92 Hz" in texts(fig)
