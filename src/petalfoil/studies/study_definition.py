"""A study: what varies, what is asked, and how it is sampled; enough to begin it anew or to go on with it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from petalfoil import __version__
from petalfoil.case import Case, toml
from petalfoil.errors import DefinitionError, StoreError
from petalfoil.results.atomic import replacing
from petalfoil.studies.question import Question

FILE = "study.toml"


def no_study(folder: Path) -> str:
    """Why a folder holds no study."""
    return f"{folder} is no folder of a study: {f'it has no {FILE}' if folder.exists() else 'there is no such folder'}"


NEIGHBOURS = "neighbours"
"""Setting of a study whose cases begin at the solutions of similar ones."""


@dataclass(frozen=True, kw_only=True)
class Study:
    """Definition of a study.

    Attributes
    ----------
    kind : str
        `sweep`, `tolerance`, `sobol` or `optimize`.
    case : Case
        The base case.
    question : Question
        What is asked of every case.
    vary : dict
        Values of the parameters by path, as the user wrote them.
    settings : dict
        Whatever else makes the study what it is: the sample, its seed, limits, objectives.
    version : str
        Version of petalfoil that began it.
    """

    kind: str
    case: Case
    question: Question
    vary: Mapping[str, Any]
    settings: Mapping[str, Any] = field(default_factory=dict)
    version: str = __version__

    @property
    def from_neighbours(self) -> bool:
        """Whether cases begin at the nearest solution where that is quicker."""
        return bool(self.settings.get(NEIGHBOURS, False))

    def to_toml(self) -> str:
        """All of it, as the file in the folder of the study."""
        return toml.write(
            {
                "petalfoil_version": self.version,
                "kind": self.kind,
                "ask": self.question.verb,
                "arguments": json.dumps(self.question.arguments),
                "vary": dict(self.vary),
                "settings": dict(self.settings),
                "case": toml.parse(self.case.to_toml()),
            }
        )

    @classmethod
    def load(cls, folder: Path) -> Study:
        """Read the definition of the study in a folder.

        Raises
        ------
        StoreError
            The folder holds none, or a damaged one.
        """
        if not (folder / FILE).is_file():
            raise StoreError(no_study(folder))
        try:
            tables = toml.parse(toml.read_file(folder / FILE))
            return cls(
                kind=tables["kind"],
                case=Case(**tables["case"]),
                question=Question(tables["ask"], json.loads(tables["arguments"])),
                vary=tables["vary"],
                settings=tables["settings"],
                version=tables["petalfoil_version"],
            )
        except (DefinitionError, KeyError, TypeError, ValueError) as error:
            raise StoreError(f"{folder / FILE} is not as petalfoil wrote it: {error}") from error

    def save(self, folder: Path) -> None:
        """Write the definition into a folder."""
        with replacing(folder / FILE) as temporary:
            temporary.write_text(self.to_toml(), encoding="utf-8")

    def differences(self, other: Study) -> list[str]:
        """What is not the same in another study, in words."""
        pairs = {
            "the kind of study": (self.kind, other.kind),
            "the base case": (self.case.to_toml(), other.case.to_toml()),
            "what is asked": (self.question, other.question),
            "what varies": (dict(self.vary), dict(other.vary)),
            "sample, limits, budget or neighbours": (dict(self.settings), dict(other.settings)),
            "the version of petalfoil": (self.version, other.version),
        }
        return [words for words, (mine, its) in pairs.items() if mine != its]
