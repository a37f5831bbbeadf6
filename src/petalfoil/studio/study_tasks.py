"""Studies that a worker runs for the page, one case after another: a map of designs, and the best design."""

from __future__ import annotations

import json
import math
import time

import numpy as np
import xarray as xr

from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress
from petalfoil.errors import UsageError
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, Role
from petalfoil.studies.optimize import BUDGET, optimize_study, variations_of
from petalfoil.studies.plan import names_of
from petalfoil.studies.question import Question
from petalfoil.studies.run import Execution, run
from petalfoil.studies.sweep import sweep
from petalfoil.studies.variation import read_levels
from petalfoil.studio.protocol import Arrays, Mapped, Searched, WorkerTask

MOST_CASES = 400
"""Largest map, and largest budget of a search: some minutes of 2-D cases."""


def mapped(task: WorkerTask, case: Case, progress: Progress) -> Mapped:
    """Run an analysis over one or two parameters, here and one case after another.

    Raises
    ------
    UsageError
        There are other than one or two parameters, or more than `MOST_CASES` cases.
    """
    start = time.perf_counter()
    levels = [read_levels(case, path, text) for path, text in task.vary.items()]
    cases = math.prod(len(one.values) for one in levels)
    if not 1 <= len(levels) <= 2 or cases > MOST_CASES:
        raise UsageError(f"a map has one or two parameters and up to {MOST_CASES} cases; these are {cases}")
    ds = sweep(case, task.vary, task.verb, execution=Execution(workers=0, progress=progress))
    shape = tuple(len(one.values) for one in levels)
    return Mapped(
        parameters={one.path: tuple(map(float, one.values)) for one in levels},
        units={one.path: one.parameter.unit for one in levels},
        results={
            str(name): array.values for name, array in ds.items() if is_answer(str(name)) and array.shape == shape
        },
        missing=int((~ds["converged"].values).sum()),
        seconds=time.perf_counter() - start,
    )


def searched(task: WorkerTask, case: Case, progress: Progress) -> Searched:
    """Look for the best design, beginning at the case.

    Raises
    ------
    UsageError
        Nothing is to be varied or wanted, a limit cannot be read, or the budget is beyond `MOST_CASES`.
    """
    start, goals = time.perf_counter(), {"method": "auto", "budget": BUDGET, **task.goals}
    if not task.vary:
        raise UsageError("nothing varies: choose a parameter and its range")
    if not 1 <= int(goals["budget"]) <= MOST_CASES:
        raise UsageError(f"a search on the page has a budget of 1 to {MOST_CASES} designs; this is {goals['budget']}")
    study = optimize_study(case, task.vary, Question.read(task.verb, {}), goals)
    ds = run(study, None, Execution(workers=0, progress=progress))
    told, variations = json.loads(ds.attrs["optimum"]), variations_of(study)
    return Searched(
        parameters={
            one.path: tuple(map(float, ds[name].values))
            for one, name in zip(variations, names_of(variations), strict=True)
        },
        units={one.path: one.parameter.unit for one in variations},
        results=_answers(ds, ("case",)),
        objectives=tuple(f"{direction} {name}" for name, direction in told["objectives"]),
        feasible=np.asarray(ds["feasible"].values, dtype=bool),
        on_front=np.asarray(ds["on_front"].values, dtype=bool),
        ended=told["ended"],
        seconds=time.perf_counter() - start,
    )


def _answers(ds: xr.Dataset, dims: tuple[str, ...]) -> Arrays:
    """Numbers that an analysis finds, along the cases of a study alone."""
    return {str(name): array.values for name, array in ds.items() if is_answer(str(name)) and array.dims == dims}


def is_answer(name: str) -> bool:
    """Whether a result is a number that an analysis finds."""
    variable = SCALARS.get(name)
    return variable is not None and variable.kind is DataType.FLOAT and variable.role is Role.ANSWER
