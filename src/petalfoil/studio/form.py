"""The fields of a case as a form, read from its definitions: a new key appears on the page by itself."""

from __future__ import annotations

import math
import re
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from petalfoil.case import Case
from petalfoil.case.definition import Definition
from petalfoil.case.number_fields import Count, PerPetal, PerPetalOrWord, Quantity, QuantityOrWord, Range
from petalfoil.errors import UnitError
from petalfoil.units import format_quantity, parse_quantity

if TYPE_CHECKING:
    from petalfoil.analysis.arguments import Argument

STEPS = 200
"""Steps of a slider: about one for two of its pixels."""
LOW, HIGH = 0.25, 2.0
"""Ends of a slider over the value that it is made for."""


ANYTHING = Range()
"""The range of what has no bounds."""


class Control(Enum):
    """How a key is edited."""

    QUANTITY, COUNT, PAIR, CHOICE, FLAG, TEXT, ROWS = "quantity", "count", "pair", "choice", "flag", "text", "rows"


@dataclass(frozen=True, kw_only=True)
class FormEntry:
    """A key of a case and how it is edited.

    Attributes
    ----------
    path : str
        Dotted path.
    control : Control
        How it is edited.
    meaning : str
        What it is.
    unit : str
        SI unit; empty where it has none.
    bounds : Range
        Range of the number [unit].
    choices : tuple of str
        Words that are allowed.
    default : object
        What is taken where nothing is given; None where it must be given, or follows from others.
    is_required : bool
        Whether it must be given.
    allowed : str
        What may be written.
    """

    path: str
    control: Control
    meaning: str
    unit: str = ""
    bounds: Range = ANYTHING
    choices: tuple[str, ...] = ()
    default: Any = None
    is_required: bool = False
    allowed: str = ""

    @property
    def label(self) -> str:
        """Short text beside the control."""
        short = self.meaning or self.path.rpartition(".")[2].replace("_", " ")
        return short.partition(",")[0]

    @property
    def takes_several(self) -> bool:
        """Whether several values may be given, with commas between them: a pair, or one for each petal."""
        return self.control is Control.PAIR or isinstance(self.bounds, PerPetal | PerPetalOrWord)

    def text(self, value: Any) -> str:
        """A value as text, in a unit that a reader likes; empty for None."""
        if value is None:
            return ""
        if self.takes_several and isinstance(value, list | tuple):
            return ", ".join(self.text_of_one(one) for one in value)
        return self.text_of_one(value)

    def text_of_one(self, value: Any) -> str:
        """One value as text."""
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, float | int) and self.unit:
            return format_quantity(value, self.unit, digits=12)
        return str(value)

    def given(self, text: str) -> Any:
        """What a text in the control stands for in a case; None for an empty one.

        Numbers without a unit stay numbers, so that a count is one; whatever cannot be read is left to the case, which
        says what is wrong.
        """
        plain = text.strip()
        if not plain:
            return None
        if self.takes_several and "," in plain:
            return [_number_or_text(part) for part in plain.split(",")]
        return _number_or_text(plain) if self.control is not Control.TEXT else plain


@dataclass(frozen=True)
class FormSection:
    """A table of a case.

    Attributes
    ----------
    name : str
        Name of the table; empty for keys of the case itself.
    title : str
        What it describes.
    is_optional : bool
        Whether a case may be without it.
    entries : tuple of FormEntry
        Its keys.
    """

    name: str
    title: str
    is_optional: bool
    entries: tuple[FormEntry, ...]


def sections(model: type[BaseModel] = Case) -> list[FormSection]:
    """The tables of a case in order, keys of the case itself in front."""
    own: list[FormEntry] = []
    tables: list[FormSection] = []
    for name, field in model.model_fields.items():
        table = _table_of(field)
        if table is None:
            own.append(_entry(name, field))
            continue
        entries = tuple(_entry(f"{name}.{key}", inner) for key, inner in table.model_fields.items())
        title = (table.__doc__ or name).strip().partition("\n")[0].rstrip(".")
        tables.append(FormSection(name, title, not field.is_required() and field.default is None, entries))
    return [FormSection("", "Case", False, tuple(own)), *tables]


def _table_of(field: FieldInfo) -> type[Definition] | None:
    for kind in (field.annotation, *typing.get_args(field.annotation)):
        if isinstance(kind, type) and issubclass(kind, Definition):
            return kind
    return None


def _entry(path: str, field: FieldInfo) -> FormEntry:
    """The entry of a key, by what its definition declares."""
    declared = list(_declared(field))
    number = next((one for one in declared if isinstance(one, Quantity | Count)), None)
    kinds = [kind for kind in _kinds(field.annotation) if isinstance(kind, type)]
    default = None if field.is_required() or field.default_factory is not None else field.default
    default = getattr(default, "value", default)
    shared: dict[str, Any] = {"path": path, "default": default, "is_required": field.is_required()}
    words = next((kind for kind in kinds if issubclass(kind, StrEnum)), None)
    if words is not None:
        return FormEntry(**shared, control=Control.CHOICE, meaning="", choices=tuple(word.value for word in words))
    if number is None:
        control = Control.FLAG if bool in kinds else Control.TEXT
        return FormEntry(**shared, control=control, meaning="")
    unit = number.unit if isinstance(number, Quantity) else ""
    control = Control.COUNT if isinstance(number, Count) else _control_of_quantity(field)
    if isinstance(number, PerPetal | PerPetalOrWord):
        control = Control.QUANTITY
    choices = (number.word,) if isinstance(number, QuantityOrWord) else ()
    return FormEntry(
        **shared,
        control=control,
        meaning=number.meaning,
        unit=unit,
        bounds=number,
        choices=choices,
        allowed=number.allowed,
    )


def _control_of_quantity(field: FieldInfo) -> Control:
    """Whether a quantity stands alone, in a pair, or in rows of pairs."""
    depth = str(field.annotation).count("tuple[")
    return (Control.QUANTITY, Control.PAIR, Control.ROWS)[min(depth, 2)]


def _declared(field: FieldInfo) -> Iterator[Any]:
    """Declarations of numbers in the annotation of a field, however deep."""
    yield from field.metadata
    yield from _metadata(field.annotation)


def _metadata(annotation: Any) -> Iterator[Any]:
    yield from getattr(annotation, "__metadata__", ())
    for inner in typing.get_args(annotation):
        if not isinstance(inner, Quantity | Count):
            yield from _metadata(inner)


def _kinds(annotation: Any) -> Iterator[Any]:
    yield annotation
    for inner in typing.get_args(annotation):
        yield from _kinds(inner)


# ---------------------------------------------------------------------------------------------- arguments


def label_of_argument(name: str) -> str:
    """Label of the field of an argument of an analysis."""
    return name.replace("_", " ")


def with_labels(text: str, arguments: Mapping[str, Argument]) -> str:
    """A text of the program, such as a refusal, in which arguments are called as their fields are.

    Parameters
    ----------
    text : str
        Text that names options of the command line, ``--min-film``, or arguments of Python, ``min_film_thickness``.
    arguments : mapping
        Arguments of the analysis by name.
    """
    labels = {name: label_of_argument(name) for name in arguments if "_" in name}
    labels |= {one.option_name(name): f"'{label_of_argument(name)}'" for name, one in arguments.items()}
    known = "|".join(sorted(map(re.escape, labels), key=len, reverse=True))
    return re.sub(rf"(?<![\w-])({known})(?![\w-])", lambda found: labels[found[1]], text) if known else text


# ---------------------------------------------------------------------------------------------- sliders

_TEXT_OF_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")


def _number_or_text(text: str) -> int | float | str:
    """A text of a number alone as that number."""
    plain = text.strip()
    for kind in (int, float):
        try:
            number = kind(plain)
        except ValueError:
            continue
        return number if math.isfinite(number) and "_" not in plain else plain
    return plain


@dataclass(frozen=True)
class Slider:
    """A slider of a quantity, in the unit in which it is written.

    Attributes
    ----------
    low, high, step, value : float
        Ends, step and value [`unit`].
    unit : str
        The unit as it is written.
    """

    low: float
    high: float
    step: float
    value: float
    unit: str

    def text(self, value: float) -> str:
        """The text of a value of the slider."""
        digits = max(0, -math.floor(math.log10(self.step) + 1e-9))
        return f"{value:.{digits}f} {self.unit}".rstrip()


def sliders_of(entry: FormEntry, text: str) -> list[Slider]:
    """The sliders for a text: one of a number, two of a pair, none where nothing can be slid.

    The ends are a quarter and twice the value, inside the range of the key; of a pair twice the larger component to
    both sides.
    """
    if entry.control is Control.PAIR:
        read = [_TEXT_OF_QUANTITY.fullmatch(part) for part in text.split(",")]
        parts = [(float(match[1]), match[2]) for match in read if match is not None]
        reach = HIGH * max((abs(value) for value, _ in parts), default=0.0)
        found = [_slider(entry, value, unit, (-reach, reach)) for value, unit in parts]
        return [slider for slider in found if slider is not None] if len(parts) == len(read) == 2 else []
    match = _TEXT_OF_QUANTITY.fullmatch(text)
    if match is None or entry.control not in (Control.QUANTITY, Control.COUNT):
        return []
    value = float(match[1])
    start, stop = sorted((LOW * value, HIGH * value))
    slider = _slider(entry, value, match[2], (start, stop))
    return [] if slider is None else [slider]


def _slider(entry: FormEntry, value: float, unit: str, ends: tuple[float, float]) -> Slider | None:
    """A slider between two ends, inside the range of the key."""
    low, high = _limits(entry, unit)
    start, stop = max(ends[0], low), min(ends[1], high)
    if not start <= value <= stop or start == stop:
        return None
    step = 1.0 if entry.control is Control.COUNT else _round_step((stop - start) / STEPS)
    first, last = step * math.ceil(start / step - 1e-9), step * math.floor(stop / step + 1e-9)
    if entry.control is not Control.COUNT:
        first += step if entry.bounds.above is not None and first <= low else 0.0
        last -= step if entry.bounds.below is not None and last >= high else 0.0
    return Slider(first, last, step, value, unit) if first < last else None


def _limits(entry: FormEntry, unit: str) -> tuple[float, float]:
    """Range of a key in a unit that is written."""
    bounds = entry.bounds
    low = bounds.at_least if bounds.above is None else bounds.above
    high = bounds.at_most if bounds.below is None else bounds.below
    try:
        one = parse_quantity(f"1 {unit}", entry.unit) if entry.unit and unit else 1.0
        zero = parse_quantity(f"0 {unit}", entry.unit) if entry.unit and unit else 0.0
    except UnitError:
        return math.inf, -math.inf
    factor = one - zero
    return (-math.inf if low is None else (low - zero) / factor), (math.inf if high is None else (high - zero) / factor)


def _round_step(step: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is no larger."""
    decade = 10.0 ** math.floor(math.log10(step))
    return max(part * decade for part in (1.0, 2.0, 5.0) if part * decade <= step * (1.0 + 1e-9))
