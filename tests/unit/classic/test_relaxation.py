"""Film and pack in turn: limits, starts, relaxation, history."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.classic import ClassicOptions, ClassicRun, numpy_kernels, relax
from petalfoil.classic import kernels as inner
from petalfoil.classic.relaxation import Relaxation
from petalfoil.errors import ConvergenceError
from tests.unit.classic.bearings import bearing, pack


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("limits", "what"),
    [({"max_film_steps": 20_000}, "film"), ({"max_pack_steps": 20_000}, "pack"), ({"max_outer": 4}, "outer")],
)
def test_a_run_that_uses_up_its_steps_says_which_and_how_it_went(limits: dict[str, int], what: str) -> None:
    with pytest.raises(ConvergenceError, match=f"used up its {what} steps") as caught:
        relax(ClassicRun(pack(10), ClassicOptions(**limits)))
    rows = caught.value.history
    assert len(rows) > 1
    assert [row["outer"] for row in rows] == list(range(1, len(rows) + 1))
    assert {"film_steps", "pack_steps", "pressure_change", "film_change"} <= set(rows[0])
    assert rows[-1]["film_steps"] <= limits.get("max_film_steps", np.inf) + 32
    assert "coarser grid" in caught.value.advice


def test_a_diverged_film_has_its_own_message() -> None:
    problem = pack(8)
    closed = np.ones(problem.layout.balance.mesh.shape)
    closed[0, 3] = 0.0
    with (
        pytest.raises(ConvergenceError, match="film pressures of the classic method diverged"),
        np.errstate(all="ignore"),
    ):
        ClassicRun(problem).march_film(np.ones(closed.shape), closed, 1e-6)


@pytest.mark.compiled
def test_rows_are_told_as_they_come_and_the_run_can_be_watched() -> None:
    told, pulses = [], []
    run = ClassicRun(pack(8), ClassicOptions(), tell=told.append, pulse=lambda: pulses.append(1))
    state = relax(run)
    assert told == run.rows
    assert len(told) == state.outer
    assert len(pulses) > 2 * state.outer
    assert (told[-1]["film_steps"], told[-1]["pack_steps"]) == (state.film_steps, state.pack_steps)
    assert max(told[-1]["pressure_change"], told[-1]["film_change"]) <= 1e-5


@pytest.mark.compiled
def test_an_answer_as_a_start_is_not_taken_for_a_better_one() -> None:
    problem = pack(8, 100e-6)
    rough = relax(ClassicRun(problem, ClassicOptions(epsilon=1e-3)))
    fine = relax(ClassicRun(problem, ClassicOptions(epsilon=1e-6)))
    again = relax(ClassicRun(problem, ClassicOptions(epsilon=1e-6)), rough)
    assert np.max(np.abs(rough.P - fine.P)) > 1e-5
    assert_allclose(again.P, fine.P, rtol=1e-5)
    assert 2 < again.outer < fine.outer


@pytest.mark.compiled
def test_a_start_from_another_position_is_moved_out_of_the_journal() -> None:
    beside = relax(ClassicRun(pack(8)))
    problem = pack(8, 150e-6)
    assert np.min(problem.film(np.concatenate([beside.w, beside.P]))) < 0.0
    assert_allclose(relax(ClassicRun(problem), beside).P, relax(ClassicRun(problem)).P, rtol=1e-4)


def test_a_plain_bearing_has_only_a_film() -> None:
    state = relax(ClassicRun(bearing("plain")))
    assert state.pack_steps == 0
    assert len(state.w) == 0
    assert state.outer <= 6


def test_the_relaxation_factor_is_halved_when_the_change_stops_to_fall() -> None:
    relaxation = Relaxation(0.5, 10.0)
    for change in (1.0, 0.5, *([0.6] * 19)):
        relaxation.update(change)
    assert relaxation.factor == 0.5
    relaxation.update(0.7)
    assert relaxation.factor == 0.25
    relaxation.update(0.9)
    assert (relaxation.smallest, relaxation.waited) == (0.9, 0)


@pytest.mark.slow
@pytest.mark.compiled
def test_without_relaxation_the_run_finds_a_smaller_factor() -> None:
    run = ClassicRun(pack(10), ClassicOptions(deflection_relaxation=1.0))
    relax(run)
    assert run.rows[-1]["deflection_relaxation"] < 1.0


@pytest.fixture
def no_numba(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An environment without the extra."""
    with monkeypatch.context() as patch:
        patch.setattr(inner, "numba_is_installed", lambda: False)
        inner.kernels.cache_clear()
        yield
    inner.kernels.cache_clear()


@pytest.mark.slow
@pytest.mark.usefixtures("no_numba")
def test_without_numba_the_numpy_loops_run() -> None:
    assert inner.kernels() == (numpy_kernels.march, numpy_kernels.descend)
    state = relax(ClassicRun(pack(4), ClassicOptions(epsilon=1.0)))
    twin = relax(ClassicRun(pack(4), ClassicOptions(epsilon=1.0), inner.KernelBackend.NUMPY))
    assert state.film_steps > 0
    assert state.pack_steps > 0
    assert (state.film_steps, state.pack_steps) == (twin.film_steps, twin.pack_steps)
