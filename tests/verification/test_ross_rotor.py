"""The example of a flexible rotor of ROSS: modes, loads, a rigid one as `orbit` moves it; the whole where ROSS is."""

from __future__ import annotations

import importlib.util
import sys
from types import ModuleType

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicHermiteSpline

import petalfoil
from tests.cases import EXAMPLES, case


@pytest.fixture(scope="module")
def example() -> ModuleType:
    """The script."""
    spec = importlib.util.spec_from_file_location("ross_rotor", EXAMPLES / "ross_rotor.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclass looks its own module up
    spec.loader.exec_module(module)
    return module


def two_masses(example: ModuleType, stiffness: float = 1e8) -> object:
    """A disk of 2 kg between two journals of 0.5 kg on springs, degrees of freedom x, y of each."""
    spring = stiffness * np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    K, M = np.kron(spring, np.eye(2)), np.kron(np.diag([0.5, 2.0, 0.5]), np.eye(2))
    upward = np.tile([0.0, 1.0], 3)
    return example.FreeRotor(M, K, np.zeros_like(M), [(0, 1), (4, 5)], (2, 3), 2.0 * 1e-6, upward)


def test_modes_and_loads_are_those_of_the_masses(example: ModuleType) -> None:
    modes = example.Modes(two_masses(example), 1e5)
    # rigid: three masses on two springs have two elastic frequencies each way; no tilt resists
    assert_allclose(np.sort(modes.stiffness), [0, 0, 2e8, 2e8, 3e8, 3e8], rtol=1e-10, atol=1e-4)
    assert_allclose(modes.loads(), 1.5 * 9.80665, rtol=1e-10)
    state = modes.begun([np.array([1e-6, -2e-6]), np.array([1e-6, -2e-6])], 1000.0)
    assert_allclose(modes.places[:4] @ state[: len(modes.stiffness)], [1e-6, -2e-6, 1e-6, -2e-6], rtol=1e-9)
    sag = (modes.places[5] - modes.places[1]) @ state[: len(modes.stiffness)]
    assert sag == pytest.approx(-2.0 * 9.80665 / 2e8, rel=1e-9)  # half the disk on each spring


@pytest.mark.slow
def test_a_stiff_rotor_moves_as_orbit_does(example: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two bearings share 3 kg: each journal moves as a rotor of 1.5 kg on one bearing. `orbit` begins at rest."""
    begun = example.Modes.begun
    at_rest = np.repeat([1.0, 0.0], 2)
    monkeypatch.setattr(example.Modes, "begun", lambda *given: at_rest * begun(*given))
    bearing = case("paper_n8", **{"model.cells_per_pitch": 12, "model.contacts": "nodes"})  # as `Film` has them
    times, path = example.run(two_masses(example, 1e13), bearing, turns=0.25)
    assert_allclose(path[:, 0], path[:, 1], rtol=0.0, atol=1e-12)
    start = {"operation.eccentricity": tuple(float(value) for value in path[0, 0])}
    motion = petalfoil.orbit(
        bearing.replace(rotor={"mass": 1.5, "unbalance": 2e-6 / 3.0}, **start), revolutions=0.25, tolerance=1e-5
    )
    for axis, column in (("x", 0), ("y", 1)):
        known = CubicHermiteSpline(*(motion[name].to_numpy() for name in ("time", axis, f"velocity_{axis}")))(times)
        assert np.abs(path[:, 0, column] - known).max() < 3e-3 * np.ptp(motion["y"].to_numpy())


@pytest.mark.slow
def test_the_rotor_of_ross_has_the_recorded_modes_and_loads(example: ModuleType) -> None:
    pytest.importorskip("ross", reason="needs ross-rotordynamics 3 and Python 3.12")
    modes = example.Modes(example.from_ross(), 40000.0)
    assert_allclose(np.sqrt(np.unique(np.round(modes.stiffness[~modes.rigid]))), [9059.0, 21740.0, 37491.0], rtol=1e-3)
    assert_allclose(modes.loads(), [12.82, 16.75], atol=0.01)
