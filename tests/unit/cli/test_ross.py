"""Coefficients as bearing elements of ROSS, from a run and from a stored result."""

from __future__ import annotations

import json
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from petalfoil.results.ross import CURVED, _warn_if_curved

from . import test_loads

loads = test_loads.loads
AXES, SPEEDS = test_loads.AXES, test_loads.AXES[:2]


def element_of(path: Path) -> tuple[str, dict[str, Any]]:
    """Section and content of the only element of a file."""
    text = path.read_text(encoding="utf-8")
    data = tomllib.loads(text) if path.suffix == ".toml" else json.loads(text)
    ((section, element),) = data.items()
    return section, element


@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_ross_gets_a_bearing_element_over_speed_and_frequency(cli, loads, case, tmp_path: Path, suffix: str) -> None:
    """As `BearingElement.load` of ROSS 3 reads it: increasing axes, tables (speed, frequency)."""
    path = tmp_path / f"bearing{suffix}"
    assert cli("coefficients", case, *AXES, "--ross", str(path)).exit_code == 0
    section, element = element_of(path)
    assert section.split("_")[0] == "BearingElement"
    assert element["speed"] == [100.0, 200.0, 300.0, 400.0, 500.0]
    assert element["frequency"] == [10.0, 20.0, 30.0, 40.0, 50.0]
    assert np.array(element["kxy"])[1, 3] == 1e6 * (200.0 + 40.0 + 1.0)
    assert np.array(element["cyx"])[4, 0] == 500.0 + 10.0 + 2.0
    assert {"n", "tag", "kxx", "kyx", "kyy", "cxx", "cxy", "cyy"} <= set(element)


def test_ross_gets_no_table_with_holes(cli, loads, case, tmp_path: Path) -> None:
    loads.failing = {2}
    path = tmp_path / "bearing.toml"
    result = cli("coefficients", case, *AXES, "--ross", str(path), "--json")
    assert result.exit_code == 2
    assert "some have none" in result.stderr
    assert json.loads(result.stdout)["points"][2]["converged"] is False  # the answer is shown all the same
    assert not path.exists()


@pytest.mark.slow
def test_the_default_frequencies_are_dense_around_half_of_every_speed(cli, loads, case, tmp_path: Path) -> None:
    path = tmp_path / "bearing.toml"
    result = cli("coefficients", case, *SPEEDS, "--ross", str(path))
    assert (result.exit_code, result.stderr) == (0, "")
    _, element = element_of(path)
    axis = np.array(element["frequency"])
    for speed in element["speed"]:
        near = axis[(axis > 0.35 * speed) & (axis < 0.65 * speed)]
        assert len(near) > 20
        assert np.max(np.diff(near) / near[:-1]) < 0.05
        assert speed in axis
    assert axis[-1] >= 2.0 * 500.0 * (1.0 - 1e-12)


def test_a_run_without_a_table_keeps_its_frequencies(cli, loads, case) -> None:
    cli("coefficients", case, *SPEEDS)
    assert loads.calls[0][1]["frequencies"] is None


@pytest.mark.parametrize("axis", ["10 : 1000 : 12", "600, 700, 800, 900, 1000"])
def test_a_table_that_is_coarse_near_half_speed_is_warned_of(cli, loads, case, tmp_path: Path, axis: str) -> None:
    result = cli("coefficients", case, *SPEEDS, "--frequency", axis, "--ross", str(tmp_path / "b.toml"))
    assert result.exit_code == 0
    assert result.stderr.count("Warning: --ross: the table for ROSS has") >= 3
    assert "near half of 100 rad/s" in result.stderr


@pytest.mark.parametrize(("fastest", "warned"), [(500.0, False), (1500.0, True)])
def test_speeds_between_which_coefficients_change_unevenly_are_warned_of(fastest: float, warned: bool) -> None:
    """Stiffness in proportion to the square of the speed: a line over `h` misses it by `h^2 / 4` in the middle."""
    speeds = np.linspace(300.0, fastest, 5)
    impedances = np.ones((1, 9, 2, 2)) * (speeds**2)[:, None, None, None] + 0j
    middle = (0.5 * (speeds[1] - speeds[0])) ** 2 / speeds[1] ** 2
    assert bool(middle > CURVED) is warned
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        _warn_if_curved(speeds, np.linspace(30.0, 900.0, 9), impedances)
    assert len(told) == int(warned)
    if warned:
        assert f"some {100.0 * middle:.0f} % off between 300 and 900 rad/s" in str(told[0].message)


@pytest.mark.slow
def test_two_bearings_of_a_rotor_have_their_nodes_and_names(cli, loads, case, tmp_path: Path) -> None:
    one, two = tmp_path / "drive end.toml", tmp_path / "b.json"
    cli("coefficients", case, *SPEEDS, "--ross", str(one))
    cli("coefficients", case, *SPEEDS, "--ross", str(two), "--node", "4", "--tag", "free end")
    assert element_of(one)[0] == "BearingElement_drive end"
    assert [(element_of(p)[1]["n"], element_of(p)[1]["tag"]) for p in (one, two)] == [(0, "drive end"), (4, "free end")]


def test_ross_2_gets_one_value_a_speed(cli, loads, case, tmp_path: Path) -> None:
    path = tmp_path / "bearing.toml"
    assert cli("coefficients", case, *SPEEDS, "--ross2", str(path)).exit_code == 0
    _, element = element_of(path)
    assert element["frequency"] == [100.0, 200.0, 300.0, 400.0, 500.0]
    assert element["kxy"] == [1e6 * (2.0 * speed + 1.0) for speed in element["frequency"]]
    assert "speed" not in element


@pytest.mark.slow
def test_a_stored_result_is_exported_too(cli, loads, case, tmp_path: Path) -> None:
    out, first, again = (tmp_path / name for name in ("k.nc", "k.toml", "again.toml"))
    cli("coefficients", case, *SPEEDS, "--ross", str(first), "--out", str(out), "--node", "3", "--tag", "a")
    shown = cli("show", str(out), "--ross", str(again), "--node", "3", "--tag", "a", "--csv", str(tmp_path / "k.csv"))
    assert shown.exit_code == 0
    assert again.read_text(encoding="utf-8") == first.read_text(encoding="utf-8")
    assert (tmp_path / "k.csv").exists()


def test_a_stored_result_of_another_kind_has_no_table(cli, loads, case, tmp_path: Path) -> None:
    out = tmp_path / "balance.nc"
    cli("balance", case, "--load", "5 N", "--out", str(out))
    shown = cli("show", str(out), "--ross", str(tmp_path / "k.toml"))
    assert (shown.exit_code, shown.stdout) == (2, "")
    assert "--ross: a result of balance has nothing for such a file" in shown.stderr


def test_xltrc_gets_synchronous_coefficients_over_speed(cli, loads, case, tmp_path: Path) -> None:
    path = tmp_path / "bearing.txt"
    assert cli("coefficients", case, *SPEEDS, "--xltrc", str(path)).exit_code == 0
    head, *lines = [line.split("\t") for line in path.read_text(encoding="utf-8").splitlines()]
    assert head[:3] == ["Speed (rpm)", "Kxx (N/m)", "Kxy (N/m)"]
    assert len(lines) == 5
    assert float(lines[0][0]) == pytest.approx(100.0 * 30.0 / np.pi)
    assert float(lines[1][2]) == 1e6 * (200.0 + 200.0 + 1.0)


def test_xltrc_gets_no_other_whirl(cli, loads, case, tmp_path: Path) -> None:
    result = cli("coefficients", case, *AXES, "--xltrc", str(tmp_path / "bearing.txt"))
    assert result.exit_code == 2
    assert "not among the whirl frequencies" in result.stderr
