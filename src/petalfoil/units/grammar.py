"""The text of a unit, read by a grammar of its own; pint only looks up names and factors.

::

    unit   = factor { ( "*" | "·" | "/" | blank ) factor }
    factor = ( name | "1" | "(" unit ")" ) [ ( "^" | "**" ) integer | superscript ]

So no text is ever evaluated, and what can be written is what is drawn above. Arithmetic is done in fractions and
rounded once: 25 µm is exactly the float 2.5e-05.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from petalfoil.units.mistyped import meant, nearest
from petalfoil.units.usual import converted

if TYPE_CHECKING:
    import pint

MAX_POWER = 9  # a larger one is a slip, and would make numbers of any length

_TOKEN = re.compile(
    r"""\s*(?: (?P<name>  °[CF]? | % | [^\W\d_][^\W\d]* )
             | (?P<power> \*\* | \^ )
             | (?P<mark>  [*·/()] )
             | (?P<int>   [+-]?[0-9]+ ) )""",
    re.VERBOSE,
)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")
_SUPERSCRIPT_RUN = re.compile(r"[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")
_ANGLES = {"radian", "degree", "turn", "revolutions_per_minute", "revolutions_per_second"}

_ALSO_WRITTEN = {
    "GPA": "GPa",
    "KRPM": "krpm",
    "Msi": "Mpsi",
    "RPM": "rpm",
    "lbm": "lb",
    "mil": "thou",  # to pint an angle, the 6400th part of a turn
    "mils": "thou",
    "psia": "psi",
}
"""Units as engineers write them, and the names under which pint knows them."""

_DIFFERENCES = {"degree_Celsius": "delta_degree_Celsius", "degree_Fahrenheit": "delta_degree_Fahrenheit"}

_GAUGE = {"barg", "psig"}
"""Pressures above the ambient one: another zero, which no factor converts."""

_ABSOLUTE = {"abs", "absolute"}
"""Words behind a pressure that say what it is anyway."""


class UnitTextError(ValueError):
    """A unit that cannot be read or converted; the message completes "… <value> …"."""


class _UnknownUnitError(UnitTextError):
    """A name that is no unit."""

    def __init__(self, name: str) -> None:
        super().__init__(f"has the unknown unit {name!r}")
        self.name = name


@lru_cache(maxsize=4096)
def convert(number: Fraction, text: str, unit: str, *, whirl: bool = False) -> float:
    """Convert `number` times the unit written in `text` to the SI unit `unit` (``"1"`` for a plain number).

    Of a `whirl` frequency [rad/s] a hertz is one whirl orbit a second, 2 pi rad/s; for a speed it is refused.
    """
    try:
        usual = converted(number, text, unit)
    except OverflowError:
        raise UnitTextError("cannot be converted") from None
    return convert_any(number, text, unit, whirl) if usual is None else usual


def convert_any(number: Fraction, text: str, unit: str, whirl: bool = False) -> float:
    """Convert as `convert` does, by pint."""
    import pint

    given = _read(text, unit)
    if whirl and "hertz" in _base_names(given):
        given = given * _registry().Unit("turn")
    _refuse_lookalikes(number, given, unit)
    try:
        return float(_registry().Quantity(number, given).to("" if unit == "1" else unit).magnitude)
    except pint.DimensionalityError:
        raise UnitTextError(f"measures something else ({_dimension(given)}){_meant(given, text, unit)}") from None
    except (pint.PintError, ArithmeticError, ValueError):
        raise UnitTextError("cannot be converted") from None


def _read(text: str, unit: str) -> Any:
    """The unit written in `text`; where it is none, what may be meant."""
    try:
        given = _Reader(text).read()
    except _UnknownUnitError as error:
        asked = unit if error.name == text.strip() else ""
        name = meant(text, unit) or nearest(error.name, asked)
        raise UnitTextError(f"{error} (did you mean {name!r}?)" if name else str(error)) from None
    except UnitTextError as error:
        name = meant(text, unit)
        raise UnitTextError(f"{error} (did you mean {name!r}?)" if name else str(error)) from None
    return _differences(given)


def _differences(given: Any) -> Any:
    """Degrees of a scale within a larger unit are differences: 1/degC is 1/K."""
    items = list(_registry().Quantity(1, given).unit_items())
    if len(items) == 1 and items[0][1] == 1:
        return given
    out = _registry().Unit("")
    for name, power in items:
        out = out * _registry().Unit(_DIFFERENCES.get(name, name)) ** power
    return out


def _refuse_lookalikes(number: Fraction, given: Any, unit: str) -> None:
    """Refuse units that pint takes for the wanted one although a reader may mean another.

    To pint ``"1000 Hz"`` is 1000 rad/s, where most people mean a thousand turns a second, and ``"30 deg"`` is a plain
    number.
    """
    names = _base_names(given)
    if unit == "rad/s" and given.dimensionality == {"[time]": -1} and names != {"second"} and not names & _ANGLES:
        cycles = float(_registry().Quantity(number, given).to("1/s").magnitude)
        turns, radians = f"{60.0 * cycles:.6g} rpm", f"{cycles:.6g} rad/s"
        raise UnitTextError(f"is ambiguous: for turns write '{turns}', for radians '{radians}'")
    if unit == "1" and names & _ANGLES:
        raise UnitTextError("is an angle")


def _meant(given: Any, text: str, unit: str) -> str:
    """What may be meant by a unit that measures something else: balancing machines tell mass times length."""
    if unit == "m" and given.dimensionality == {"[mass]": 1, "[length]": 1}:
        return "; an unbalance is divided by the mass of the rotor, such as 5 g mm / 2 kg = 2.5 um"
    name = meant(text, unit)
    return f"; did you mean {name!r}?" if name else ""


def _base_names(given: Any) -> set[str]:
    """Names of the units in `given` without their prefixes: ``{"hertz"}`` of kHz."""
    names = (name for name, _ in _registry().Quantity(1, given).unit_items())
    return {_registry().parse_unit_name(name)[0][1] for name in names}


def _dimension(given: Any) -> str:
    """Write the dimension as ``mass length^2 time^-2``; pint's own writing stumbles over fractions."""
    powers = {name.strip("[]"): float(power) for name, power in given.dimensionality.items()}
    return " ".join(name if power == 1 else f"{name}^{power:g}" for name, power in powers.items()) or "a plain number"


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[Fraction]:
    import pint  # a second: only those who write unusual units pay for it

    registry: pint.UnitRegistry[Fraction] = pint.UnitRegistry(non_int_type=Fraction)
    registry.define("@alias turn = rev")
    return registry


class _Reader:
    """Recursive descent over the grammar drawn at the top of the file."""

    def __init__(self, text: str) -> None:
        self.tokens = list(_tokens(text))
        self.at = 0

    def read(self) -> Any:
        """Return the pint unit of the whole text."""
        unit = self._product()
        kind, token = self._peek()
        if kind != "end":
            power = f"; a power is written '^{token}'" if kind == "int" else ""
            raise UnitTextError(f"has {token!r} where its unit should end{power}")
        return unit

    def _peek(self) -> tuple[str, str]:
        return self.tokens[self.at] if self.at < len(self.tokens) else ("end", "")

    def _take(self) -> tuple[str, str]:
        token = self._peek()
        self.at += 1
        return token

    def _product(self) -> Any:
        unit = self._factor()
        while True:
            kind, token = self._peek()
            if token in ("*", "·", "/"):
                self.at += 1
                factor = self._factor()
                unit = unit / factor if token == "/" else unit * factor
            elif kind == "name" or token == "(":
                unit = unit * self._factor()
            else:
                return unit

    def _factor(self) -> Any:
        base = self._base()
        if self._peek()[0] != "power":
            return base
        self.at += 1
        kind, token = self._take()
        if kind != "int" or abs(int(token)) > MAX_POWER:
            raise UnitTextError(
                f"has the power {token!r}, which is not a whole number from {-MAX_POWER} to {MAX_POWER}"
            )
        return base ** int(token)

    def _base(self) -> Any:
        kind, token = self._take()
        if kind == "name":
            return _named(token)
        if token == "1":
            return _registry().Unit("")
        if token != "(":
            raise UnitTextError(f"has {token!r} where a unit was expected" if token else "lacks a unit at its end")
        inner = self._product()
        if self._take()[1] != ")":
            raise UnitTextError("has a bracket that is not closed")
        return inner


def _tokens(text: str) -> list[tuple[str, str]]:
    plain = _SUPERSCRIPT_RUN.sub(lambda run: "^" + run.group().translate(_SUPERSCRIPTS), text).rstrip()
    tokens: list[tuple[str, str]] = []
    position = 0
    while position < len(plain):
        match = _TOKEN.match(plain, position)
        if match is None:
            raise UnitTextError(f"has {plain[position:].strip()[:1]!r} where a unit was expected")
        kind = str(match.lastgroup)
        tokens.append((kind, match.group(kind)))
        position = match.end()
    return tokens


def _named(name: str) -> Any:
    import pint

    if name in _GAUGE:
        raise UnitTextError(f"is a gauge pressure ({name}): write the absolute one")
    if name in _ABSOLUTE:
        raise UnitTextError(f"says {name!r}: pressures are absolute, leave the word out")
    try:
        return _registry().Unit(_ALSO_WRITTEN.get(name, name))
    except (pint.PintError, ValueError):
        raise _UnknownUnitError(name) from None
