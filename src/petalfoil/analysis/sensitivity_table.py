"""The table of `sensitivity`: one row for each parameter and result, by the size of the effect."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from petalfoil.analysis.derivatives import Derivative, Results
from petalfoil.analysis.parameter_change import Changes
from petalfoil.analysis.varied_case import VariedCase
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError, DefinitionError, PetalfoilError
from petalfoil.results.layout import Series
from petalfoil.results.parts import RunOutcome
from petalfoil.results.record import Record
from petalfoil.results.rounding import ROUNDING
from petalfoil.results.schema import SCALARS
from petalfoil.results.summary import cell
from petalfoil.results.variable import DataType, Role, TableLabel, Variable
from petalfoil.units import format_quantity

FELT = 1e-7
"""Part of a result below which its change by a parameter, over the relative change of that, is rounding."""


def _text(long_name: str, symbol: str, shown: str = "", role: Role = Role.GIVEN) -> Variable:
    return Variable((), "", long_name, symbol, DataType.STR, role, TableLabel(shown or long_name))


def _number(long_name: str, symbol: str, role: Role = Role.ANSWER, units: str = "") -> Variable:
    shown = TableLabel(long_name, "%", 100.0) if units == "1" else TableLabel(long_name)
    return Variable((), units, long_name, symbol, role=role, shown=shown)


STIFFNESS = ("stiffness_xx", "stiffness_xy", "stiffness_yx", "stiffness_yy")
DAMPING = ("damping_xx", "damping_xy", "damping_yx", "damping_yy")
MATRICES = {
    name: _number(f"entry {name[-2:]} of the {name[:-3]} of the bearing", f"{letter}_{name[-2:]}", units=units)
    for names, letter, units in ((STIFFNESS, "K", "N m-1"), (DAMPING, "C", "N s m-1"))
    for name in names
}
"""Entries of stiffness and damping, as results that have derivatives."""

MODES = tuple(
    (f"natural_frequency_{number}", f"mode_growth_rate_{number}", f"damping_ratio_{number}") for number in range(1, 7)
)
"""Results of the first natural modes: frequency, growth rate and damping ratio by number."""
_OF_MODES = {
    name: _number(f"{words} of natural mode {name[-1]}", f"{symbol}_{name[-1]}", units=units)
    for mode in MODES
    for name, (words, symbol, units) in zip(
        mode,
        (("frequency", "omega", "rad s-1"), ("growth rate", "sigma", "s-1"), ("damping ratio", "zeta", "1")),
        strict=True,
    )
}

RESULTS = {
    **MATRICES,
    **_OF_MODES,
    "place": _text("where the equilibrium of a series is", "-", "at"),
    "parameter": _text("dotted path of a parameter of the case", "p", "parameter"),
    "parameter_text": _text("value of the parameter with its unit", "p", "value"),
    "parameter_value": _number("value of the parameter, in its SI unit", "p", Role.GIVEN),
    "parameter_unit": _text("SI unit of the parameter", "[p]"),
    "parameter_change": _number("change of the parameter, in its SI unit", "delta p", Role.GIVEN),
    "change_text": _text("change of the parameter in words", "delta p", "change"),
    "quantity": _text("name of a result", "q", "result"),
    "quantity_value": _number("value of the result, in its SI unit", "q"),
    "quantity_unit": _text("SI unit of the result", "[q]"),
    "derivative": _number("derivative of the result by the parameter, on the side of its change", "dq/dp"),
    "derivative_below": _number("derivative toward smaller values of the parameter", "dq/dp-"),
    "derivative_above": _number("derivative toward larger values of the parameter", "dq/dp+"),
    "effect": _number("change of the result by the change of the parameter, in its SI unit", "delta q"),
    "effect_text": _text("change of the result with its unit", "delta q", "effect", Role.ANSWER),
    "relative_effect": _number("change of the result over its value", "delta q/q", units="1"),
    "derivative_solves": Variable(
        (),
        "1",
        "triangular solves for all derivatives, with the factors that they share",
        "n_s",
        DataType.INT,
        Role.BOOKKEEPING,
    ),
    "contacts_hold": _number(
        "relative change of the parameter up to which no contact begins or ends", "delta p_c", units="1"
    ),
}


def of_parameter(record: Record) -> str:
    """The parameter in words."""
    return f"by {record.scalars['parameter']}"


LAYOUT = Series(
    columns={
        "place": "at",
        "parameter": "parameter",
        "parameter_text": "value",
        "change_text": "change",
        "quantity": "result",
        "relative_effect": "effect",
        "effect_text": "effect",
        "contacts_hold": "contacts\nhold ±",
    },
    at=of_parameter,
)


class Source(Protocol):
    """Results with derivatives."""

    @property
    def values(self) -> Results:
        """The results by name."""

    @property
    def residual(self) -> float:
        """Residual of the equilibrium."""

    def variation(self, path: str) -> VariedCase:
        """The case at values of a parameter."""

    def along(self, variation: VariedCase) -> Derivative:
        """Derivatives along it."""


@dataclass(frozen=True, kw_only=True)
class SensitivityRow:
    """The effect of one parameter on one result; `nan` where there is no derivative."""

    parameter: str
    parameter_text: str
    parameter_value: float
    parameter_unit: str
    parameter_change: float
    change_text: str
    quantity: str
    quantity_value: float
    quantity_unit: str
    derivative: float = math.nan
    derivative_below: float = math.nan
    derivative_above: float = math.nan
    effect: float = math.nan
    effect_text: str = ""
    relative_effect: float = math.nan
    contacts_hold: float = math.nan

    @property
    def size(self) -> float:
        """What rows are ordered by: the relative effect, or the effect on a result that is zero."""
        size = abs(self.effect if math.isnan(self.relative_effect) else self.relative_effect)
        return -1.0 if math.isnan(size) else size

    def is_felt(self, rounding: float) -> bool:
        """Whether the parameter has an effect beyond rounding, or none is known.

        `rounding` is what is nothing but rounding of the result, in its unit.
        """
        if math.isnan(self.effect):
            return True
        least = FELT * abs(self.parameter_change / self.parameter_size * self.quantity_value)
        return abs(self.effect) > max(least, rounding)

    @property
    def doubts(self) -> list[str]:
        """What is to be said of an effect that is no estimate of what the change does; nothing of a small one."""
        doubts = []
        if abs(self.relative_effect) > 1.0:
            doubts.append("over 100 %: no estimate of so large a change")
        held = self.contacts_hold * abs(self.parameter_value)
        if held > 0.0 and abs(self.parameter_change) > FAR * held:
            doubts.append(f"change {abs(self.parameter_change) / held:.2g} times that for which contacts hold")
        return doubts

    @property
    def parameter_size(self) -> float:
        """Magnitude of the parameter; its change where it is zero."""
        return abs(self.parameter_value) or abs(self.parameter_change)


FAR = 10.0
"""Change over that up to which contacts hold, past which an effect is said to be doubtful."""

LOST = 100.0
"""Digits that a difference quotient loses of a result that is zero, as a factor."""

POINTS_LOST = 2e5
"""The same of a force with contact points: places of contacts are known to 1e-8 of the residuals only, and
derivatives of forces that cancel all around the journal keep 1e-7 of ambient pressure on it (2e-5 N of 125 N)."""

TENFOLD = 10.0
"""Relative change of a parameter past which no derivative tells when a contact begins or ends."""


def rounding_of(case: Case, quantity: str) -> float:
    """Forces and displacements below this are rounding: that of ambient pressure on the bearing, and of its radius."""
    bearing = case.bearing
    pressed = case.gas.ambient_pressure * bearing.journal_radius * bearing.length
    return {"N": pressed, "m": bearing.journal_radius}.get(SCALARS[quantity].units, 0.0) * LOST * ROUNDING


def noise_of(case: Case, quantity: str) -> float:
    """Effects on a result that is zero below this are rounding."""
    points = case.has_contact_points and SCALARS[quantity].units == "N"
    return rounding_of(case, quantity) * (POINTS_LOST / LOST if points else 1.0)


ALL = "all"
"""All results of the question, in place of their names."""


@dataclass(frozen=True)
class SensitivityLine:
    """A row and how it came about."""

    row: SensitivityRow
    outcome: RunOutcome


def lines_of(path: str, sources: Mapping[str, Source], changes: Changes) -> list[SensitivityLine]:
    """The rows of one parameter for each result; where a result has no derivative, its row says why."""
    lines: list[SensitivityLine] = []
    done: dict[int, tuple[VariedCase, Derivative | PetalfoilError]] = {}
    for quantity, source in sources.items():
        if id(source) not in done:
            done[id(source)] = along(source, source.variation(path))
        variation, found = done[id(source)]
        row = asked_row(variation, (quantity, source.values[quantity]), changes)
        if isinstance(found, PetalfoilError):
            lines.append(SensitivityLine(row, RunOutcome(converged=False, status=f"not converged: {found}")))
        else:
            row = with_effect(row, found, variation)
            status = "; ".join([in_words(found), *row.doubts])
            lines.append(SensitivityLine(row, RunOutcome(status=status, residual=source.residual)))
    return lines


def along(source: Source, variation: VariedCase) -> tuple[VariedCase, Derivative | PetalfoilError]:
    """Derivatives along a variation, or why there are none: the case may not allow the change alone."""
    try:
        return variation, source.along(variation)
    except (ConvergenceError, DefinitionError) as failure:
        return variation, failure


def asked_row(variation: VariedCase, result: tuple[str, float], changes: Changes) -> SensitivityRow:
    """What a row tells of its parameter and its result."""
    parameter, (quantity, value) = variation.parameter, result
    value = value if abs(value) > rounding_of(variation.case, quantity) else 0.0
    change, in_words_of_change = changes.of(variation.case, parameter, variation.size)
    return SensitivityRow(
        parameter=parameter.path,
        parameter_text=format_quantity(variation.value, parameter.unit),
        parameter_value=variation.value,
        parameter_unit=parameter.unit,
        parameter_change=change,
        change_text=in_words_of_change,
        quantity=quantity,
        quantity_value=value,
        quantity_unit=SCALARS[quantity].units,
    )


def with_effect(row: SensitivityRow, found: Derivative, variation: VariedCase) -> SensitivityRow:
    """The row with the derivatives of its result, and what they make of the change."""
    quantity, value, change = row.quantity, row.quantity_value, row.parameter_change
    side = found.above if change > 0.0 else found.below
    effect = side[quantity] * change
    if value == 0.0 and abs(effect) <= noise_of(variation.case, quantity):  # zero by symmetry, whatever the parameter
        effect = 0.0
    shown = cell(quantity, effect)
    return replace(
        row,
        derivative=side[quantity] if effect else 0.0,
        derivative_below=found.below[quantity],
        derivative_above=found.above[quantity],
        effect=effect,
        effect_text=f"{'+' if effect > 0.0 else ''}{shown.value} {shown.unit}".rstrip(),
        relative_effect=effect / abs(value) if value else math.nan,
        contacts_hold=reach if (reach := min(found.reach) / variation.size) <= TENFOLD else math.inf,
    )


def in_words(found: Derivative) -> str:
    """Whether the derivative has two sides, and what it is not exact by."""
    sides = "a contact opens or closes here: the sides differ" if found.at_kink else ""
    return "; ".join(filter(None, ["converged", found.remark, sides]))


def ordered(lines: Sequence[SensitivityLine], quantities: Sequence[str]) -> list[SensitivityLine]:
    """Lines by result, then by the size of the effect."""
    return sorted(lines, key=lambda line: (quantities.index(line.row.quantity), -line.row.size))
