"""`optimize`: the design whose results are best within limits."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.studies.case_files import write_case
from petalfoil.studies.goals import Goals, front
from petalfoil.studies.gradients import gradients_of
from petalfoil.studies.limits import refuse_absent, value_of
from petalfoil.studies.plan import Plan, Point, names_of, refuse_repeated, refuse_too_many
from petalfoil.studies.question import CONVERGED, CaseOutcome, Question
from petalfoil.studies.run import Execution, Kind, Runner, run
from petalfoil.studies.sampling import by_sampling
from petalfoil.studies.search import AnswerPoints, DesignSearch, Gradients, interval_of
from petalfoil.studies.slsqp import along_gradients
from petalfoil.studies.study_dataset import dataset
from petalfoil.studies.study_definition import Study
from petalfoil.studies.study_store import Store
from petalfoil.studies.variation import Interval, Variation, read_range
from petalfoil.units.reading import shown

METHODS = ("auto", "slsqp", "tpe", "nsga2")
BUDGET = 200
DESIGNS = "designs"
JOURNAL = "optuna.log"


class Unanswered(Exception):
    """A search asks a design that the store does not hold."""


def optimize(  # noqa: PLR0913 - the options of the command
    case: Case,
    vary: Mapping[str, Any],
    ask: str = "solve",
    *,
    maximize: str | Sequence[str] = (),
    minimize: str | Sequence[str] = (),
    subject: Sequence[str] = (),
    budget: int = BUDGET,
    method: str = "auto",
    out: str | Path | None = None,
    execution: Execution | None = None,
    **arguments: Any,
) -> xr.Dataset:
    """Find the best design within limits, beginning at the case.

    ::

        vary = {"petals.thickness": "0.1 mm : 0.25 mm", "petals.arc_length": "38 mm : 50 mm"}
        petalfoil.optimize(case, vary, "balance", load=20, maximize="min_film_thickness",
                           subject=["max_bending_stress < 350 MPa"])

    Parameters
    ----------
    case : Case
        Where it begins.
    vary : mapping
        Intervals by path, such as ``"0.1 mm : 0.25 mm"``; of a count also a list.
    ask : str
        Name of the analysis.
    maximize, minimize : str or sequence of str
        Results that are to be large or small. Of several a front is found.
    subject : sequence of str
        Limits such as ``"min_film_thickness > 5 um"``.
    budget : int
        Designs that may be answered.
    method : str
        ``"slsqp"`` along gradients, ``"tpe"`` or ``"nsga2"`` by sampling; ``"auto"`` takes the first for one objective
        and continuous parameters, the second for counts and the third for several objectives.
    out : str or Path, optional
        Folder of the study.
    execution : Execution, optional
        Workers, fields, progress.
    **arguments
        Arguments of the analysis.

    Returns
    -------
    xarray.Dataset
        All designs over ``case`` in the order in which they were asked, with ``feasible`` and ``on_front``; the
        attribute ``optimum`` holds the best ones as JSON.

    Raises
    ------
    DefinitionError, UnitError
        There is no such parameter, or a value is outside its range.
    UsageError
        No objective is given, a result is unknown, or the method does not fit.
    ConvergenceError
        A search along gradients begins at a case without an answer.
    """
    wanted = [[names] if isinstance(names, str) else list(names) for names in (maximize, minimize)]
    settings = {"maximize": wanted[0], "minimize": wanted[1], "subject": list(subject)}
    study = optimize_study(case, vary, Question.read(ask, arguments), {**settings, "budget": budget, "method": method})
    return run(study, out, execution)


def optimize_study(case: Case, vary: Mapping[str, Any], question: Question, settings: Mapping[str, Any]) -> Study:
    """The definition of an optimisation, checked."""
    plain = {path: text if isinstance(text, str) else list(text) for path, text in vary.items()}
    study = Study(kind="optimize", case=case, question=question, vary=plain, settings={"seed": 0, **settings})
    if int(study.settings["budget"]) < 1:
        raise UsageError(f"a budget of {study.settings['budget']} designs is too small; allowed: 1 or more")
    refuse_too_many(int(study.settings["budget"]))
    question.refuse_overridden(list(vary))
    variations = variations_of(study)
    refuse_repeated(variations)
    if method_of(study) == "slsqp":
        for variation in variations:
            interval_of(variation)
    return study


def variations_of(study: Study) -> tuple[Variation, ...]:
    """What varies."""
    given = study.vary.items()
    found = [read_range(study.case, path, text if isinstance(text, str) else tuple(text)) for path, text in given]
    return tuple(found)


def goals_of(study: Study) -> Goals:
    """What is wanted."""
    return Goals.read(*(list(study.settings[name]) for name in ("maximize", "minimize", "subject")))


def method_of(study: Study) -> str:
    """The method that is used.

    Raises
    ------
    UsageError
        It is unknown, or made for another number of objectives.
    """
    asked, goals = str(study.settings["method"]), goals_of(study)
    if asked not in METHODS:
        raise UsageError(f"{shown(asked)} is no method; known: {', '.join(METHODS)}")
    if len(goals.objectives) > 1:
        if asked == "slsqp":
            raise UsageError("slsqp has one objective: use nsga2, or make limits of the others")
        return "nsga2" if asked == "auto" else asked
    smooth = all(isinstance(v, Interval) and not v.parameter.is_count for v in variations_of(study))
    return asked if asked != "auto" else "slsqp" if smooth else "tpe"


def searched(study: Study, answer: AnswerPoints, gradients: Gradients, journal: Path | None = None) -> DesignSearch:
    """The search as far as its questions are answered."""
    search = DesignSearch(variations_of(study), goals_of(study), answer, int(study.settings["budget"]), gradients)
    method = method_of(study)
    try:
        if method == "slsqp":
            along_gradients(search, int(study.settings["seed"]))
        else:
            by_sampling(search, method, journal, int(study.settings["seed"]))
    except Unanswered:
        search.ended = "not finished"
    return search


def conduct(study: Study, runner: Runner) -> None:
    """Search, asking what is not answered yet."""
    names, asked = goals_of(study).names, 0

    def answer(points: Sequence[Point]) -> list[CaseOutcome]:
        nonlocal asked
        outcomes = runner.outcomes(points)
        for outcome in outcomes:
            if outcome.status == CONVERGED:
                refuse_absent(names, outcome.records, study.question.verb)
        asked += len(points)
        if runner.execution.progress is not None:
            budget = int(study.settings["budget"])
            runner.execution.progress(min(asked / budget, 1.0), f"{asked} designs of at most {budget}")
        return outcomes

    searched(study, answer, gradients_of(study, runner.ask), runner.store.folder / JOURNAL)


def assemble(study: Study, store: Store) -> xr.Dataset:
    """Lay out the designs in the order in which the search asks them."""
    base = study.case.to_toml()

    def look_up(points: Sequence[Point], question: Question | None = None) -> list[CaseOutcome]:
        found = [store.get((question or study.question).key(base, point)) for point in points]
        if None in found:
            raise Unanswered
        return [outcome for outcome in found if outcome is not None]

    search = searched(study, look_up, gradients_of(study, look_up))
    goals, outcomes = search.goals, search.asked
    plan = Plan(search.variations, [dict(outcome.values) for outcome in outcomes])
    ds = dataset(study, plan, outcomes)
    feasible = np.array([goals.is_feasible(outcome) for outcome in outcomes], dtype=bool)
    costs = np.array([goals.costs(outcome) for outcome in outcomes]).reshape(len(outcomes), len(goals.objectives))
    best = front(costs, feasible)
    ds["feasible"] = ("case", feasible, {"long_name": "the design keeps every limit"})
    ds["on_front"] = ("case", best, {"long_name": "no other design is better in every objective"})
    return ds.assign_attrs(optimum=json.dumps(told(study, search, best)))


def told(study: Study, search: DesignSearch, best: Any) -> dict[str, Any]:
    """The best designs, and what they cost to find."""
    names = dict(zip([v.path for v in search.variations], names_of(search.variations), strict=True))
    return {
        "method": method_of(study),
        "ended": search.ended,
        "designs": len(search.asked),
        "with_derivatives": search.with_derivatives,
        "objectives": [[o.name, "maximize" if o.is_maximum else "minimize"] for o in search.goals.objectives],
        "limits": [{"limit": limit.text, "result": limit.name, "value": limit.value} for limit in search.goals.limits],
        "best": [
            {
                "case": int(number),
                "values": {names[path]: value for path, value in search.asked[number].values.items()},
                "results": {name: value_of(search.asked[number].records, name) for name in search.goals.names},
            }
            for number in np.flatnonzero(best)
        ],
    }


def write_designs(folder: Path, study: Study, ds: xr.Dataset) -> None:
    """Write the best designs as case files."""
    (folder / DESIGNS).mkdir(exist_ok=True)
    for old in (folder / DESIGNS).glob("case-*.toml"):
        old.unlink()
    for number in np.flatnonzero(ds["on_front"].values):
        write_case(study, ds, int(number), folder / DESIGNS / f"case-{number}.toml")


KIND = Kind(conduct, assemble, write_designs)
