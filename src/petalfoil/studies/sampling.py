"""A search by sampling: Optuna's TPE for one objective, its NSGA-II for several."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from petalfoil.errors import UsageError
from petalfoil.studies.goals import Goals
from petalfoil.studies.question import CaseOutcome
from petalfoil.studies.search import DesignSearch, interval_of
from petalfoil.studies.variation import Interval, Levels, Number, Variation

BATCH = 4
"""Trials that are asked at once by TPE: all workers of a small machine are busy, and few trials know too little."""
POPULATION = 20
"""Designs of a generation of NSGA-II."""


def by_sampling(search: DesignSearch, method: str, journal: Path | None, seed: int) -> None:
    """Optuna's TPE for one objective, NSGA-II for several; limits are constraints of both, the case is the first trial.

    Parameters
    ----------
    search : DesignSearch
        The search.
    method : str
        ``"tpe"`` or ``"nsga2"``.
    journal : Path or None
        File of Optuna's journal, written anew.
    seed : int
        Of the sampler.
    """
    optuna = _optuna()
    trials = optuna.create_study(
        study_name="petalfoil",
        directions=["minimize"] * len(search.goals.objectives),
        sampler=_sampler(optuna, method, seed),
        storage=_storage(optuna, journal),
    )
    first = {v.path: v.parameter.value for v in search.variations if v.parameter.value is not None}
    if all(_holds(v, first.get(v.path)) for v in search.variations):
        trials.enqueue_trial(first)
    size = POPULATION if method == "nsga2" else BATCH
    while (left := search.budget - len(search.asked)) > 0:
        before = len(search.asked)
        batch = [trials.ask() for _ in range(min(size, left))]
        points = [{v.path: _suggested(trial, v) for v in search.variations} for trial in batch]
        for trial, outcome in zip(batch, search.outcomes(points), strict=True):
            _tell(trials, trial, search.goals, outcome)
        if len(search.asked) == before and _is_finite(search.variations):
            search.ended = f"{method}: it repeats designs that are answered"
            return
    search.ended = f"{method}: the budget is spent"


def _optuna() -> Any:
    try:
        import optuna
    except ImportError:
        raise UsageError("counts and several objectives need optuna: pip install 'petalfoil[studies]'") from None
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return optuna


def _sampler(optuna: Any, method: str, seed: int) -> Any:
    if method == "nsga2":
        return optuna.samplers.NSGAIISampler(population_size=POPULATION, seed=seed)
    with warnings.catch_warnings():  # joint sampling of the parameters may still change: it is named as experimental
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        return optuna.samplers.TPESampler(seed=seed, multivariate=True)


def _storage(optuna: Any, journal: Path | None) -> Any:
    if journal is None:
        return None
    journal.unlink(missing_ok=True)
    backend = optuna.storages.journal.JournalFileBackend(str(journal))
    return optuna.storages.JournalStorage(backend)


def _suggested(trial: Any, variation: Variation) -> Number:
    """The value that the sampler proposes."""
    path = variation.path
    if isinstance(variation, Levels):
        value: Number = trial.suggest_categorical(path, list(variation.values))
    elif isinstance(variation, Interval) and variation.parameter.is_count:
        value = trial.suggest_int(path, int(variation.low), int(variation.high))
    else:
        interval = interval_of(variation)
        value = trial.suggest_float(path, float(interval.low), float(interval.high))
    return value


def _holds(variation: Variation, value: Number | None) -> bool:
    if isinstance(variation, Levels):
        return value in variation.values
    return value is not None and isinstance(variation, Interval) and variation.low <= value <= variation.high


def _is_finite(variations: Sequence[Variation]) -> bool:
    """Whether there are only so many designs."""
    return all(isinstance(v, Levels) or v.parameter.is_count for v in variations)


def _tell(trials: Any, trial: Any, goals: Goals, outcome: CaseOutcome) -> None:
    """Tell the sampler what came of a trial; one without an answer has failed."""
    from optuna.trial import TrialState

    costs = goals.costs(outcome)
    if not np.isfinite(costs).all():
        trials.tell(trial, state=TrialState.FAIL)
        return
    for limit, margin in zip(goals.limits, goals.margins(outcome), strict=True):
        trial.set_constraint(limit.text, float(-margin))
    trials.tell(trial, [float(cost) for cost in costs])
