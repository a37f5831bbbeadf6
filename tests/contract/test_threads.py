"""One BLAS thread inside a solve."""

from __future__ import annotations

from typing import Any

import pytest
from threadpoolctl import threadpool_info

from petalfoil.analysis.solve import solve
from petalfoil.analysis.static import static
from petalfoil.solvers.sparse_lu import Factor, LinearSolver
from tests.cases import case


def test_a_solve_runs_on_one_blas_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    factor = LinearSolver.factor

    def watching(self: LinearSolver, *args: Any) -> Factor:
        seen.extend(pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas")
        return factor(self, *args)

    monkeypatch.setattr(LinearSolver, "factor", watching)
    coarse = case("paper_n8", **{"model.cells_per_pitch": 16})
    solve.record(coarse)
    next(static.records(coarse))
    assert seen
    assert set(seen) == {1}
