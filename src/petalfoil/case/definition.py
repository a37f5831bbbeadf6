"""What every definition is: frozen, keyword-only, closed to unknown keys, and refused with our own errors."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, ValidationError, model_serializer
from pydantic_core import PydanticCustomError

from petalfoil.case.number_fields import VALUE_PROBLEM, Quantity, refuse
from petalfoil.case.problems import definition_error
from petalfoil.units.reading import shown


class Definition(BaseModel):
    """Base of `Case` and of its sections."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    section: ClassVar[str] = ""
    """Name of its table in a case; empty for the case itself."""

    def __init__(self, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise definition_error(error, type(self), self.section) from None

    # Pydantic otherwise validates nested definitions through their own `__init__`, and the first bad section would
    # hide the problems of all others. This mark, which pydantic puts on its own `__init__`, says that ours adds no
    # validation.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def entries(self) -> dict[str, object]:
        """Entries that make this definition again, by name."""
        return {name: getattr(self, name) for name in type(self).model_fields}


class LookedUp(Definition):
    """A definition that has some of its fields by a name, of a gas or a metal; these are written to no file."""

    def is_written(self, field: str) -> bool:
        """Whether a field is the user's own, and does not follow from the name."""
        raise NotImplementedError

    def entries(self) -> dict[str, object]:
        """Entries that make this definition again, by name, without those that were looked up."""
        return {name: value for name, value in super().entries().items() if self.is_written(name)}

    @classmethod
    def missing(cls, field: str, name: str, example: str) -> PydanticCustomError:
        """The refusal of a number that is not given, nor the name that it would follow from."""
        declared = next(part for part in cls.model_fields[field].metadata if isinstance(part, Quantity))
        allowed = f"{declared.allowed}, or {cls.section}.{name}, such as '{example}'"
        return refuse(VALUE_PROBLEM, f"is missing; expected {allowed}", allowed)

    @classmethod
    def given_twice(cls, given: object, name: str, value: object) -> PydanticCustomError:
        """The refusal of a number beside a name that it follows from."""
        text = f"{shown(given)} is given beside {cls.section}.{name} = {shown(value)}; allowed: one of them, not both"
        return refuse(VALUE_PROBLEM, text, f"a {name} or numbers")

    @model_serializer(mode="wrap")
    def _as_given(self, handler: SerializerFunctionWrapHandler) -> dict[str, object]:
        return {name: value for name, value in handler(self).items() if self.is_written(name)}
