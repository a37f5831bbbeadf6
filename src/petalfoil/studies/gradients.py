"""Exact derivatives for a search: the analysis `sensitivity`, asked at a design as any other question."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

from petalfoil.analysis.known_verbs import summaries
from petalfoil.case import Case, ContactDiscretization
from petalfoil.studies.plan import Point
from petalfoil.studies.question import CaseOutcome, Question
from petalfoil.studies.search import Gradients, Slopes
from petalfoil.studies.study_definition import Study

Ask: TypeAlias = Callable[[Sequence[Point], Question], list[CaseOutcome]]

VERB = "sensitivity"
DIFFERENTIABLE = ("solve", "balance", "liftoff", "capacity", "static", "stability")
"""Analyses whose results have exact derivatives."""
ALL = "all"
"""All results that have derivatives, in place of their names."""
RENAMED = {"loads": "load"}
"""Arguments that `sensitivity` knows by another name."""
SHARED = ("load", "eccentricity", "speed", "contact_fraction", "min_film_thickness", "max_stress", "direction", "mass")
"""Arguments that it shares with them; a question with others has no derivatives."""


def derivative_question(case: Case, question: Question, paths: Sequence[str], names: Sequence[str]) -> Question | None:
    """What to ask for the derivatives of results of a question by parameters; None where there are none.

    Contacts are where the case has them: at nodes derivatives are those of its own discrete equations.

    Parameters
    ----------
    case : Case
        The bearing of the study.
    question : Question
        The question.
    paths, names : sequence of str
        Parameters and results; ``"all"`` for all results.
    """
    if VERB not in summaries() or question.verb not in DIFFERENTIABLE:
        return None
    if not set(question.arguments) <= {*RENAMED, *SHARED}:
        return None
    arguments = {RENAMED.get(name, name): value for name, value in question.arguments.items()}
    load = arguments.get("load")
    if isinstance(load, list) and question.verb == "liftoff":  # one lift-off speed for each load
        if len(load) != 1:
            return None
        arguments["load"] = load[0]
    if case.model.contacts is ContactDiscretization.NODES:
        arguments["contacts"] = ContactDiscretization.NODES.value
    return Question(VERB, {**arguments, "ask": question.verb, "vary": list(paths), "of": list(names)})


def gradients_of(study: Study, ask: Ask) -> Gradients:
    """Derivatives of the results that a study is about, by what varies; None where the analysis has none."""
    names, paths = _names(study), list(study.vary)
    question = derivative_question(study.case, study.question, paths, names)
    if question is None:
        return lambda point: None

    def at(point: Point) -> Slopes | None:
        (outcome,) = ask([point], question)
        found = slopes_of(outcome)
        whole = all(math.isfinite(found.get(name, {}).get(path, math.nan)) for name in names for path in paths)
        return found if whole else None

    return at


def _names(study: Study) -> list[str]:
    from petalfoil.studies.goals import Goals

    return Goals.read(*(list(study.settings[name]) for name in ("maximize", "minimize", "subject"))).names


def slopes_of(outcome: CaseOutcome | None) -> Slopes:
    """Derivatives by result and path: the mean of both sides of a kink; empty where there is no answer."""
    found: Slopes = {}
    if outcome is None or not outcome.converged:
        return found
    for record in outcome.records:
        below, above = float(record["derivative_below"]), float(record["derivative_above"])
        found.setdefault(str(record["quantity"]), {})[str(record["parameter"])] = 0.5 * (below + above)
    return found
