"""A command line whose analyses are played by the test."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from petalfoil.analysis.known_verbs import find
from petalfoil.analysis.runs import Points
from petalfoil.cli.app import app
from petalfoil.results import Record, Scalar

CASE = """
title = "Plain [b]bearing[/b]"

[bearing]
journal_radius = "25 mm"
bushing_radius = "25.05 mm"
length = "50 mm"

[gas]
viscosity = "18.5 uPa*s"
ambient_pressure = "1 bar"

[operation]
speed = "8000 rad/s"

[model]
kind = "2d"
"""


def point(x: float, y: float, *, converged: bool = True, analysis: str = "solve", **more: Scalar) -> Record:
    """Give a record whose figures follow from the position."""
    scalars: dict[str, Scalar] = {
        "speed": 8000.0,
        "eccentricity_x": x,
        "eccentricity_y": y,
        "bearing_force": 1e6 * math.hypot(x, y),
        "min_film_thickness": 5e-6,
        "contact_normal_force": 12.5,
        "iterations": 7,
        "converged": converged,
        "status": "converged" if converged else "the film collapsed",
    }
    return Record(analysis=analysis, scalars=scalars | more, title="Plain [b]bearing[/b]", case_toml=CASE)


Answering = Callable[..., Record | Points]


class Played:
    """The analyses as the test plays them; keeps what they were called with."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = []
        self.failing: set[int] = set()
        self.after: dict[int, Callable[[], None]] = {}
        self.dressed: Callable[[Record], Record] = lambda record: record
        self.single: Callable[[], Record] = lambda: point(0.0, -1e-4)

    def one(self, name: str) -> Answering:
        def play(case: Any, **kwargs: Any) -> Record:
            self.calls.append((name, (case,), kwargs))
            return self.single()

        return play

    def several(self, name: str) -> Answering:
        def play(case: Any, eccentricities: Any, **kwargs: Any) -> Points:
            self.calls.append((name, (case, eccentricities), kwargs))
            return Points(self._points(name, eccentricities, kwargs["direction"]), len(eccentricities))

        return play

    def _points(self, name: str, distances: Any, angle: float) -> Iterator[Record]:
        for index, distance in enumerate(distances):
            self.after.get(index, lambda: None)()
            x, y = distance * math.cos(angle), distance * math.sin(angle)
            more = {"starting_torque": 0.25} if name == "static" else {}
            yield self.dressed(point(x, y, converged=index not in self.failing, analysis=name, **more))


def play(verb: str, played: Answering, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let an analysis be answered by the test; its declaration stays. Defaults are filled in."""
    analysis = find(verb)
    assert analysis is not None
    signature = inspect.signature(analysis.question)

    @functools.wraps(analysis.question)
    def question(*args: Any, **kwargs: Any) -> Record | Points:
        bound = signature.bind(*args, **kwargs)
        bound.apply_defaults()
        return played(**bound.arguments)

    monkeypatch.setattr(analysis, "question", question)


def install(plays: Played, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the player answer."""
    for verb in ("solve", "check"):
        play(verb, plays.one(verb), monkeypatch)
    for verb in ("curve", "static"):
        play(verb, plays.several(verb), monkeypatch)


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Played:
    """Replace the analyses, and keep the logs of faults out of the machine's temporary folder."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path_factory.mktemp("logs")))
    plays = Played()
    install(plays, monkeypatch)
    return plays


@pytest.fixture
def case(tmp_path: Path) -> str:
    """Give the name of a good case file."""
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return str(path)


@pytest.fixture
def cli() -> Callable[..., Result]:
    """Run the command line in this process."""
    runner = CliRunner()

    def run(*arguments: str) -> Result:
        return runner.invoke(app, list(arguments), prog_name="petalfoil")

    return run
