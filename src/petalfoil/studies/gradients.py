"""Exact derivatives for a search: the analysis `sensitivity`, asked at a design as any other question."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

from petalfoil.analysis.known_verbs import summaries
from petalfoil.studies.definition import Study
from petalfoil.studies.plan import Point
from petalfoil.studies.question import Outcome, Question
from petalfoil.studies.search import Gradients, Slopes

Ask: TypeAlias = Callable[[Sequence[Point], Question], list[Outcome]]

VERB = "sensitivity"
DIFFERENTIABLE = ("solve", "balance", "liftoff")
"""Analyses whose results have exact derivatives."""
RENAMED = {"loads": "load"}
"""Arguments that `sensitivity` knows by another name."""


def gradients_of(study: Study, ask: Ask) -> Gradients:
    """Derivatives of the results that a study is about, by what varies; None where the analysis has none."""
    names = _names(study)
    if VERB not in summaries() or study.question.verb not in DIFFERENTIABLE:
        return lambda point: None
    arguments = {RENAMED.get(name, name): value for name, value in study.question.arguments.items()}
    question = Question(VERB, {**arguments, "ask": study.question.verb, "vary": list(study.vary), "of": names})

    def at(point: Point) -> Slopes | None:
        (outcome,) = ask([point], question)
        return _slopes(outcome, names, list(study.vary)) if outcome.converged else None

    return at


def _names(study: Study) -> list[str]:
    from petalfoil.studies.goals import Goals

    return Goals.read(*(list(study.settings[name]) for name in ("maximize", "minimize", "subject"))).names


def _slopes(outcome: Outcome, names: list[str], paths: list[str]) -> Slopes | None:
    """Derivatives by result and path; None where one is missing or has two sides that differ."""
    found: Slopes = {name: {} for name in names}
    for record in outcome.records:
        found[str(record["quantity"])][str(record["parameter"])] = float(record["derivative"])
    whole = all(path in found[name] and math.isfinite(found[name][path]) for name in names for path in paths)
    return found if whole else None
