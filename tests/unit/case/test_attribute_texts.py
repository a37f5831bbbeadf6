"""Texts below the attributes of definitions: those that pydantic would read."""

from __future__ import annotations

from pydantic import ConfigDict

from petalfoil.case.attribute_texts import attribute_texts
from petalfoil.case.definition import Definition


class Base(Definition):
    model_config = ConfigDict(use_attribute_docstrings=True)

    first: float = 0.0
    """Over
    two lines."""
    second: float = 0.0
    third: str = ""
    """Of the base."""


class Derived(Base):
    second: float = 1.0
    """Of its own."""


def test_texts_are_those_that_pydantic_reads() -> None:
    for definition in (Base, Derived):
        texts, fields = attribute_texts(definition), definition.model_fields
        assert {name: texts.get(name) for name in fields} == {name: field.description for name, field in fields.items()}
    assert attribute_texts(Derived)["first"] == "Over\ntwo lines."
    assert attribute_texts(Derived)["second"] == "Of its own."


def test_a_class_without_source_has_only_those_of_its_bases() -> None:
    made = type("Made", (Definition,), {"__module__": "typed"})
    assert attribute_texts(made) == attribute_texts(Definition)
