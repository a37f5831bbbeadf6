"""Natural modes over speed, and a rotor in two bearings against the equations of motion assembled from one bearing."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from petalfoil import Case, coefficients, orbit, stability
from petalfoil.analysis.campbell import BRANCHES, Branches
from petalfoil.cli.printed_tables import render
from petalfoil.errors import UsageError
from petalfoil.plot import campbell
from petalfoil.results.answer import Answer
from petalfoil.results.store import load as stored
from petalfoil.results.store import save
from tests.cases import FAULTS

RPM = math.pi / 30.0
PAIR = Case.load(FAULTS / "two_bearings_plain.toml")
SPEEDS = [speed * RPM for speed in (2000.0, 4000.0, 8000.0, 14000.0, 15000.0)]
MASS = 3.06


@cache
def over_speed():
    return stability(PAIR, mass=MASS, speeds=SPEEDS)


# ---------------------------------------------------------------------------------------------- Campbell diagram


@pytest.mark.slow
def test_a_point_has_the_modes_of_the_rotor_at_its_speed() -> None:
    there = over_speed().isel(point=1)
    alone = stability.record(PAIR, mass=MASS, speed=SPEEDS[1]).fields
    for name in ("natural_frequency", "mode_growth_rate", "damping_ratio", "mode_tilt"):
        modes = np.sort(there[name].values[np.isfinite(there["natural_frequency"].values)])
        assert_allclose(modes, np.sort(alone[name].astype(float)), rtol=1e-6, atol=1e-9)


@pytest.mark.slow
def test_a_branch_keeps_its_form_and_its_frequency() -> None:
    ds = over_speed()
    ratio = ds["natural_frequency"].values / ds["speed"].values[:, None]
    assert ds.sizes["mode"] == BRANCHES
    whirls = [branch for branch in range(BRANCHES) if 0.35 < ratio[0, branch] < 0.55]
    assert len(whirls) == 2
    assert {round(float(ds["mode_tilt"].values[0, branch])) for branch in whirls} == {0, 1}
    for branch in whirls:
        assert np.all((ratio[:, branch] > 0.3) & (ratio[:, branch] < 0.5))
        assert np.ptp(ds["mode_tilt"].values[:, branch]) < 1e-3
        assert np.all(np.diff(ds["damping_ratio"].values[:, branch]) < 0.0)


@pytest.mark.slow
def test_a_critical_speed_is_that_of_a_mode_there() -> None:
    ds = over_speed()
    crossed = ds["critical_speed"].values
    places = np.argwhere(np.isfinite(crossed))
    assert len(places)
    for point, branch in places:
        speed = float(crossed[point, branch])
        assert SPEEDS[point - 1] < speed < SPEEDS[point]
        modes = stability.record(PAIR, mass=MASS, speed=speed).fields["natural_frequency"].astype(float)
        assert_allclose(np.min(np.abs(modes / speed - 1.0)), 0.0, atol=2e-3)


@pytest.mark.slow
def test_a_diagram_that_was_stopped_goes_on(tmp_path: Path) -> None:
    save(over_speed(), tmp_path / "whole.nc")
    whole = stored(tmp_path / "whole.nc")
    first = stability(PAIR, mass=MASS, speeds=SPEEDS[:2])
    first.attrs["asked"] = whole.attrs["asked"]
    save(first, tmp_path / "part.nc")
    again = stability(PAIR, mass=MASS, speeds=SPEEDS, resume=tmp_path / "part.nc")
    for name in ("natural_frequency", "critical_speed"):
        assert_allclose(again[name], whole[name], rtol=1e-6)


def test_a_table_has_a_line_for_each_mode_and_json_its_lists() -> None:
    answer = Answer.stored(over_speed(), stability.layouts[2])
    said = render(answer)
    lines = [line for line in said.splitlines() if line.strip().startswith(("2000 ", "4000 "))]
    named = {tuple(line.split()[:3]) for line in lines}  # speed, verdict, mode: a wide table comes in parts with these
    assert len(named) == int(np.isfinite(over_speed()["natural_frequency"].values[:2]).sum())
    assert "critical" in said
    assert len(answer.layout.to_json(answer.records)["points"]) == len(SPEEDS)


@pytest.mark.slow
def test_the_figure_marks_crossings_and_growth() -> None:
    """The mode that has the frequency of the speed whirls backward, which unbalance does not drive."""
    ax = campbell(over_speed()).axes[0]
    marks = {line.get_gid() for line in ax.lines}
    assert {"backward crossing", "growing"} <= marks
    assert "critical" not in marks
    with pytest.raises(UsageError, match="several speeds and a mass"):
        campbell(stability(PAIR, mass=MASS, speed=SPEEDS[0]))


def test_a_mode_that_is_near_none_begins_a_branch() -> None:
    def modes(*frequencies: float) -> dict[str, np.ndarray]:
        return {"natural_frequency": np.array(frequencies), "mode_growth_rate": -0.01 * np.array(frequencies)}

    branches = Branches()
    first = branches.placed(modes(100.0, 1000.0), 200.0)
    second = branches.placed(modes(205.0, 400.0, 1010.0), 400.0)
    assert_allclose(first["natural_frequency"][:2], [100.0, 1000.0])
    assert_allclose(second["natural_frequency"][:3], [205.0, 1010.0, 400.0])
    third = branches.placed(modes(1020.0), 420.0)
    assert np.isnan(third["natural_frequency"][[0, 2]]).all()
    assert third["natural_frequency"][1] == 1020.0


# ---------------------------------------------------------------------------------------------- assembled system


def assembled(case: Case, speed: float, frequency: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Impedance, inertia and gyroscopic matrix of `(x, y, a_x, a_y)` of a rotor on two of the bearing [SI]."""
    alone = case.replace(rotor=None, **{"operation.load": (0.0, 0.5 * case.operation.load[1])})
    found = coefficients.record(alone, [frequency], speed=speed, tilt=True)
    half, rotor = 0.5 * case.rotor.span, case.rotor
    Z = {}
    for block in ("", "_force_tilt", "_moment_displacement", "_moment_tilt"):
        K, C = (found.fields[f"{name}{block}"][0].astype(float) for name in ("stiffness", "damping"))
        Z[block] = K + 1j * frequency * C
    top = np.hstack([2.0 * Z[""], 2.0 * Z["_force_tilt"]])
    bottom = np.hstack([2.0 * Z["_moment_displacement"], 2.0 * half**2 * Z[""] + 2.0 * Z["_moment_tilt"]])
    mass = np.diag([rotor.mass, rotor.mass, rotor.transverse_inertia, rotor.transverse_inertia])
    gyroscopic = np.zeros((4, 4))
    gyroscopic[2, 3], gyroscopic[3, 2] = rotor.polar_inertia, -rotor.polar_inertia
    return np.vstack([top, bottom]), mass, gyroscopic * speed


def determinant(case: Case, speed: float, frequency: float) -> complex:
    """Of the assembled equations of motion at a whirl frequency, over that of the inertias."""
    Z, mass, gyroscopic = assembled(case, speed, frequency)
    D = Z - frequency**2 * mass + 1j * frequency * gyroscopic
    return complex(np.linalg.det(D) / np.linalg.det(frequency**2 * mass))


def neutral(case: Case, near: tuple[float, float]) -> np.ndarray:
    """Speed and whirl frequency at which the assembled rotor whirls with constant amplitude, by Newton's method."""
    at = np.array(near)
    for _ in range(8):
        f = determinant(case, *at)
        columns = []
        for k in range(2):
            ahead, behind = at.copy(), at.copy()
            ahead[k] *= 1.0 + 1e-5
            behind[k] *= 1.0 - 1e-5
            columns.append((determinant(case, *ahead) - determinant(case, *behind)) / (2e-5 * at[k]))
        jacobian = np.array([[c.real for c in columns], [c.imag for c in columns]])
        step = np.linalg.solve(jacobian, -np.array([f.real, f.imag]))
        at = at + step
        if np.all(np.abs(step) < 1e-9 * at):
            return at
    raise AssertionError("Newton's method did not converge")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inertias", "tilts"),
    [({}, True), ({"rotor.transverse_inertia": 2e-3, "rotor.polar_inertia": 1e-4}, False)],
    ids=["conical", "cylindrical"],
)
def test_the_threshold_is_that_of_the_assembled_equations_of_motion(inertias: dict[str, float], tilts: bool) -> None:
    """To 1e-6, for the rotor whose conical mode is the first to grow and for one whose cylindrical mode is."""
    case = PAIR.replace(**inertias)
    found = stability.record(case, speed=3000.0 * RPM)
    threshold = float(found.scalars["threshold_speed"])
    modes = stability.record(case, speed=threshold).fields
    least = int(np.argmin(np.abs(modes["damping_ratio"].astype(float))))
    assert (float(modes["mode_tilt"][least]) > 0.5) is tilts
    assert abs(float(modes["damping_ratio"][least])) < 1e-5
    speed, frequency = neutral(case, (threshold, float(modes["natural_frequency"][least])))
    assert_allclose(threshold, speed, rtol=1e-6)
    assert_allclose(float(modes["natural_frequency"][least]), frequency, rtol=1e-5)


@pytest.mark.slow
def test_the_critical_mass_makes_the_assembled_system_neutral() -> None:
    """At one speed: the determinant of the assembled equations vanishes at the critical mass and the whirl ratio."""
    speed = 4000.0 * RPM
    found = stability.record(PAIR, speed=speed, mass=MASS).scalars
    heavier = float(found["critical_mass"]) / MASS
    scaled = {f"rotor.{name}": heavier * getattr(PAIR.rotor, name) for name in ("transverse_inertia", "polar_inertia")}
    neutral_rotor = PAIR.replace(**{"rotor.mass": heavier * MASS, **scaled})
    frequency = float(found["whirl_ratio"]) * speed
    here = abs(determinant(neutral_rotor, speed, frequency))
    away = abs(determinant(neutral_rotor, speed, 1.01 * frequency))
    assert here < 1e-5 * away


# ---------------------------------------------------------------------------------------------- motion


def exponents(z: np.ndarray, step: float) -> np.ndarray:
    """Exponents of a sum of exponentials at equal steps, by the matrix pencil."""
    width = len(z) // 3
    rows = np.array([z[k : k + width + 1] for k in range(len(z) - width)])
    U, s, V = np.linalg.svd(rows[:, :-1], full_matrices=False)
    U, s, V = U[:, :6], s[:6], V[:6]
    return np.log(np.linalg.eigvals((U.conj().T @ rows[:, 1:] @ V.conj().T) / s[:, None])) / step


@pytest.mark.slow
def test_a_motion_grows_as_the_modes_say() -> None:
    """Conical and cylindrical whirl from a disturbance of a nanometre: rates of growth to 1 %, frequencies to 0.1 %."""
    quiet = PAIR.replace(**{"rotor.unbalance": 1e-10, "rotor.skew": 1e-9})
    modes = stability.record(quiet, speed=7500.0 * RPM).fields
    expected = {}
    for form in (0, 1):
        chosen = np.round(modes["mode_tilt"].astype(float)) == form
        fastest = int(np.argmax(np.where(chosen, modes["mode_growth_rate"].astype(float), -np.inf)))
        expected[form] = complex(modes["mode_growth_rate"][fastest], modes["natural_frequency"][fastest])
    ds = orbit(quiet, revolutions=16.0, initial="balance", tolerance=1e-7)
    time = ds["time"].values
    instants = np.linspace(0.5 * time[-1], time[-1], 150)
    for form, (x, y) in enumerate((("x", "y"), ("slope_x", "slope_y"))):
        path = CubicSpline(time, ds[x].values + 1j * ds[y].values)(instants)
        found = exponents(path - path.mean(), instants[1] - instants[0])
        nearest = found[np.argmin(np.abs(found - expected[form]))]
        assert_allclose(nearest.real, expected[form].real, rtol=1e-2)
        assert_allclose(nearest.imag, expected[form].imag, rtol=1e-3)
