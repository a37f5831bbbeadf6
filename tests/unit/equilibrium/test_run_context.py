"""A run counts what is done in it, tells its caller, and does not leak into other runs."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Thread

import numpy as np
import pytest

from petalfoil.analysis.curve import curve
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.run_context import RunContext, current_run, new_run, running
from petalfoil.system.build import build_problem
from tests.cases import case

FLAT = case("paper_n8", **{"model.cells_per_pitch": 16})


def test_a_nested_run_has_its_own_counts_and_shares_elimination_orders() -> None:
    with running() as outer:
        outer.film.factorizations = 3
        with running() as inner:
            assert current_run() is inner
            assert inner.film.factorizations == 0
            assert inner.elimination_orders is outer.elimination_orders
        assert current_run() is outer


def test_a_failed_run_is_closed(run: RunContext) -> None:
    with pytest.raises(ZeroDivisionError), running():
        1 / 0  # noqa: B018
    assert current_run() is run


def test_the_same_problem_solved_in_two_runs_gives_the_same_bits() -> None:
    problem = build_problem(FLAT)
    answers, counts = [], []
    for _ in range(2):
        with RunContext().active() as run:
            answers.append(solve_cold(problem))
            counts.append((run.film.factorizations, run.pack.factorizations))
    assert np.array_equal(answers[0].x, answers[1].x)
    assert np.array_equal(answers[0].lam, answers[1].lam)
    assert counts[0] == counts[1]


@pytest.mark.slow
def test_the_same_curve_twice_gives_the_same_bits() -> None:
    first, second = ([r.scalars["force_y"] for r in curve.records(FLAT, [0.0, 5e-5, 1e-4])] for _ in range(2))
    assert first == second


def test_generators_taken_in_turns_keep_their_runs(run: RunContext) -> None:
    def noting(name: str) -> Iterator[RunContext]:
        for _ in range(3):
            current_run().note(name)
            yield current_run()

    runs = new_run(), new_run()
    for first, second in zip(runs[0].during(noting("a")), runs[1].during(noting("b")), strict=True):
        assert (first, second) == runs
        assert current_run() is run
    assert [[row["phase"] for row in one.history] for one in runs] == [["a"] * 3, ["b"] * 3]
    assert run.history == []


def test_a_thread_starts_without_a_run(run: RunContext) -> None:
    found: list[RunContext] = []
    thread = Thread(target=lambda: found.extend([current_run(), current_run()]))
    thread.start()
    thread.join()
    assert found[0] is found[1]
    assert found[0] is not run


def test_progress_is_told_at_every_step_and_stays_below_one() -> None:
    told: list[tuple[float, str]] = []
    with running(lambda fraction, text: told.append((fraction, text)), "solve", 2.0) as run:
        for _ in range(5):
            run.note("film")
    fractions = [fraction for fraction, _ in told]
    assert len(told) == 5
    assert fractions == sorted(fractions)
    assert 0.0 < fractions[0] < fractions[-1] < 1.0
    assert {text for _, text in told} == {"solve: film"}
