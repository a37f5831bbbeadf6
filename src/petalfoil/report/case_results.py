"""What the report of a case computes: one analysis for each part, with its result or the reason why there is none."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import xarray as xr

from petalfoil.analysis import known_verbs
from petalfoil.analysis.declaration import ERROR, Analysis
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError, PetalfoilError
from petalfoil.results.answer import Answer
from petalfoil.units.writing import format_quantity

Progress: TypeAlias = Callable[[float, str], None]
Vector: TypeAlias = tuple[float, float]

LOAD_FACTORS = (0.5, 1.5, 2.0)
"""Loads over the asked one at which the operating point is computed too: how far the bearing is from its limit."""

WHIRL_RATIOS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0)
"""Whirl frequencies over the speed: half of it, where gas films become unstable, the speed itself, and around them."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is asked.

    Attributes
    ----------
    case : Case
        The bearing.
    load : tuple of float or None
        Load (x, y) [N]; the case's, or None: the position of the case then.
    mass : float or None
        Mass of the rotor [kg], as `stability` takes it.
    error : bool
        Whether results have error bars from a grid study.
    """

    case: Case
    load: Vector | None = None
    mass: float | None = None
    error: bool = True


@dataclass(frozen=True, kw_only=True)
class Part:
    """One analysis of the report.

    Attributes
    ----------
    name : str
        Name of its file.
    title : str
        Its heading.
    verb : str
        The analysis.
    arguments : mapping
        Its arguments, SI.
    dataset : xarray.Dataset or None
        Its result.
    answer : Answer or None
        The same as records, for tables.
    remarks : tuple of str
        Warnings of the run.
    refusal : PetalfoilError or None
        Why it has none.
    """

    name: str
    title: str
    verb: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    dataset: xr.Dataset | None = None
    answer: Answer | None = None
    remarks: tuple[str, ...] = ()
    refusal: PetalfoilError | None = None

    @property
    def is_failed(self) -> bool:
        """Whether a solution was sought and not found."""
        return isinstance(self.refusal, ConvergenceError) or bool(self.answer and self.answer.failures())

    @property
    def command(self) -> str:
        """The command that computes it again."""
        words = [f"petalfoil {self.verb} case.toml"]
        analysis = _analysis(self.verb)
        words += [_option(analysis, name, value) for name, value in self.arguments.items()]
        return " ".join([*words, f"--out {self.name}.nc"])


def compute(request: Request, progress: Progress) -> tuple[Part, ...]:
    """All parts, one after the other; what one refuses does not stop the others."""
    asked = tuple(_asked(request))
    done = []
    for place, part in enumerate(asked):
        done.append(_computed(request.case, part, _within(progress, place, len(asked))))
    return tuple(done)


def load_of(request: Request) -> Vector | None:
    """The load of the report [N]."""
    return request.load if request.load is not None else request.case.operation.load


def _asked(request: Request) -> Iterator[Part]:
    """The parts before they are computed."""
    case, bars = request.case, {ERROR: True} if request.error else {}
    load = load_of(request)
    loaded: dict[str, Any] = {} if load is None else {"load": load}
    yield Part(name="pack", title="Bearing", verb="check")
    point = "solve" if load is None else "balance"
    yield Part(name="operating_point", title="Operating point", verb=point, arguments={**loaded, **bars})
    if load is not None and any(load):
        for factor in LOAD_FACTORS:
            other = (factor * load[0], factor * load[1])
            title = f"{factor:g} times the load"
            yield Part(
                name=f"load_{factor:g}".replace(".", "_"), title=title, verb="balance", arguments={"load": other}
            )
    if load is not None and load[0] == 0.0 and load[1] < 0.0:
        yield Part(name="liftoff", title="Lift-off", verb="liftoff", arguments={"loads": [-load[1]], **bars})
    speed = case.operation.speed
    frequencies = [ratio * speed for ratio in WHIRL_RATIOS]
    asked = {"frequencies": frequencies, **loaded, **bars}
    yield Part(name="coefficients", title="Stiffness and damping", verb="coefficients", arguments=asked)
    rotor = {} if request.mass is None else {"mass": request.mass}
    yield Part(name="stability", title="Stability", verb="stability", arguments={**loaded, **rotor, **bars})


def _computed(case: Case, part: Part, progress: Progress) -> Part:
    analysis = _analysis(part.verb)
    given = {"progress": progress} if "progress" in analysis.signature.parameters else {}
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UserWarning)
        try:
            dataset = analysis(case, **part.arguments, **given)
        except PetalfoilError as refusal:
            return _with(part, refusal=refusal)
    answer = Answer.stored(dataset, analysis.layout_of(dataset))
    return _with(part, dataset=dataset, answer=answer, remarks=tuple(str(one.message) for one in told))


def _with(part: Part, **more: Any) -> Part:
    return Part(name=part.name, title=part.title, verb=part.verb, arguments=part.arguments, **more)


def _analysis(verb: str) -> Analysis:
    found = known_verbs.find(verb)
    if found is None:
        raise ValueError(f"no analysis is called {verb!r}")
    return found


def _option(analysis: Analysis, name: str, value: Any) -> str:
    """An argument as an option of the command line."""
    argument = analysis.arguments[name]
    option = argument.option_name(name)
    if isinstance(value, bool):
        return option
    unit = getattr(argument, "unit", "")
    values = value if isinstance(value, list | tuple) else (value,)
    return f'{option} "{", ".join(f"{number:.10g} {unit}".rstrip() for number in values)}"'


def _within(progress: Progress, place: int, count: int) -> Progress:
    def tell(part: float, text: str) -> None:
        progress((place + part) / count, text)

    return tell


def load_text(load: Vector) -> str:
    """A load in words."""
    size, angle = math.hypot(*load), math.degrees(math.atan2(load[1], load[0]))
    return f"{format_quantity(size, 'N')} at {angle:.0f}°"
