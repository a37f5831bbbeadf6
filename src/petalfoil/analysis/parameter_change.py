"""The changes of parameters whose effects `sensitivity` tells: fractions, quantities, or each parameter its own.

As texts, entries with commas between them; one without a path is for all parameters that it fits::

    2 %                                a fraction of each parameter
    5 um                               a quantity for all parameters of its unit, here the lengths
    petals.thickness = 5 um, 2 %       one for a parameter, another for the rest
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from petalfoil.analysis.arguments import Argument
from petalfoil.case import Case
from petalfoil.case.hints import nearest
from petalfoil.case.parameters import Parameter
from petalfoil.errors import UnitError, UsageError
from petalfoil.units import format_quantity, parse_quantity
from petalfoil.units.reading import shown

FRACTION = 0.01
"""Relative change of a parameter by default."""

OF_CLEARANCE = ("bearing.journal_radius", "bearing.bushing_radius")
"""Radii whose difference is the clearance: by default they change by `FRACTION` of it, for a hundredth of a radius is
most of a clearance."""

FOR_ALL = ""
"""Path of the entry that is for all parameters."""


@dataclass(frozen=True, kw_only=True)
class ParameterChanges(Argument):
    """Fractions or quantities by the path of a parameter; as a text, or in Python a number or a mapping too."""

    def read(self, given: Any) -> dict[str, float | str]:
        """Fractions as numbers, quantities as texts, by path."""
        if isinstance(given, Mapping):
            pairs = [(str(path), value) for path, value in given.items()]
        elif isinstance(given, str):
            entries = (entry.rpartition("=") for entry in given.split(","))
            pairs = [(path.strip(), value.strip()) for path, _, value in entries]
        else:
            pairs = [(FOR_ALL, given)]
        if len(dict(pairs)) < len(pairs):
            raise UsageError(
                f"{shown(given)} has two changes for one parameter; allowed: one for each, one for the rest"
            )
        return {path: _entry(value) for path, value in pairs}


def _entry(given: Any) -> float | str:
    """A fraction, or the text of a quantity.

    Raises
    ------
    UsageError
        A fraction is outside its range.
    """
    try:
        fraction = parse_quantity(given, "1")
    except UnitError:
        return str(given)
    if not 0.0 < fraction <= 1.0:
        raise UsageError(
            f"{shown(given)} is outside its range; allowed: above 0 up to 1 (100 %), or a quantity as '5 um'"
        )
    return fraction


@dataclass(frozen=True)
class Changes:
    """The change of each parameter.

    Attributes
    ----------
    given : dict
        Fractions, or texts of quantities, by path; what has none changes by its default.
    """

    given: Mapping[str, float | str]

    def check(self, parameters: list[Parameter]) -> None:
        """Refuse changes of parameters that do not vary, and quantities that fit none.

        Raises
        ------
        UnitError
            A quantity measures something else than its parameter, or than any of them.
        UsageError
            A change is for none of the parameters, or is not above zero.
        """
        by_path = {parameter.path: parameter for parameter in parameters}
        for path, entry in self.given.items():
            if path != FOR_ALL and path not in by_path:
                hint = nearest(path, list(by_path))
                raise UsageError(f"step: {shown(path)} does not vary here; varied: {', '.join(by_path)}.{hint}")
            if isinstance(entry, str):
                self._check_quantity(path, entry, [by_path[path]] if path else parameters)

    @staticmethod
    def _check_quantity(path: str, entry: str, parameters: list[Parameter]) -> None:
        sizes, refused = [], None
        for parameter in parameters:
            try:
                sizes.append(parse_quantity(entry, parameter.unit))
            except UnitError as failure:
                refused = failure
        if not sizes and refused is not None:
            named = f"step: {path}: " if path else "step: "
            raise UnitError(f"{named}{refused}", given=refused.given, allowed=refused.allowed)
        if min(sizes, default=1.0) <= 0.0:
            raise UsageError(f"step: {shown(entry)} is outside its range; allowed: above zero")

    def of(self, case: Case, parameter: Parameter, size: float) -> tuple[float, str]:
        """The change of a parameter, in its SI unit, and in words; `size` is what zero is compared with."""
        entry = self.given.get(parameter.path, self.given.get(FOR_ALL))
        if isinstance(entry, str):
            try:
                change = parse_quantity(entry, parameter.unit)
                return change, f"+{format_quantity(change, parameter.unit)}"
            except UnitError:  # a quantity for all parameters of another unit
                entry = None
        if entry is None and parameter.path in OF_CLEARANCE:
            change = FRACTION * case.bearing.clearance
            return change, f"+{format_quantity(change, parameter.unit)} ({100.0 * FRACTION:g} % of the clearance)"
        fraction = FRACTION if entry is None else entry
        change = fraction * (float(parameter.value or 0.0) or size)
        return change, f"{100.0 * fraction:g} %" if parameter.value else f"+{format_quantity(change, parameter.unit)}"
