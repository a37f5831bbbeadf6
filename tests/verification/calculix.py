"""Decks for CalculiX (`ccx`): strips of solid elements, contact between them, and what its answers print."""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

CCX = shutil.which("ccx")
NEEDED = "CalculiX (ccx) is not installed"

CORNERS = [(a, b, c) for c in (0, 2) for a, b in ((0, 0), (2, 0), (2, 2), (0, 2))]
MIDS = [(a, b, c) for c in (0, 2) for a, b in ((1, 0), (2, 1), (1, 2), (0, 1))]
UPRIGHT = [(a, b, 1) for a, b in ((0, 0), (2, 0), (2, 2), (0, 2))]
"""Nodes of a 20-node brick: across the thickness, along the strip, across the plane."""

Place = tuple[int, int, int]


@dataclass
class Deck:
    """Nodes and elements of a model that grows part by part."""

    width: float
    nodes: list[str] = field(default_factory=list)
    elements: list[str] = field(default_factory=list)
    count: int = 0

    def node(self, x: float, y: float, z: float) -> int:
        """Number of a new node."""
        self.nodes.append(f"{len(self.nodes) + 1}, {x:.12e}, {y:.12e}, {z:.12e}")
        return len(self.nodes)

    def strip(self, name: str, middle: Sequence[tuple[float, float, float]], thickness: float) -> dict[Place, int]:
        """A strip of 20-node bricks along places and outward angles of its mid-surface, two for each element."""
        number: dict[Place, int] = {}
        for i, (x, y, angle) in enumerate(middle):
            for j in range(3):
                for k in range(3):
                    if i % 2 + j % 2 + k % 2 < 2:
                        out = 0.5 * (j - 1) * thickness
                        at = x + out * math.cos(angle), y + out * math.sin(angle)
                        number[j, i, k] = self.node(*at, 0.5 * k * self.width)
        self.elements.append(f"*ELEMENT, TYPE=C3D20R, ELSET={name}")
        for i in range(0, len(middle) - 1, 2):
            self.count += 1
            its = [str(number[j, i + along, k]) for j, along, k in CORNERS + MIDS + UPRIGHT]
            self.elements += [f"{self.count}, " + ", ".join(its[:12]) + ",", ", ".join(its[12:])]
        return number

    def ring(self, name: str, radius: float, angles: Sequence[float], depth: float) -> dict[Place, int]:
        """A ring of 8-node bricks inside a radius."""
        number = {
            (j, i, k): self.node(
                *((radius - (1 - j) * depth) * part for part in (math.cos(a), math.sin(a))), k * self.width
            )
            for i, a in enumerate(angles)
            for j in range(2)
            for k in range(2)
        }
        self.elements.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        for i in range(len(angles) - 1):
            self.count += 1
            its = [str(number[j // 2, i + along // 2, k // 2]) for j, along, k in CORNERS]
            self.elements.append(f"{self.count}, " + ", ".join(its))
        return number

    @property
    def lines(self) -> list[str]:
        """Nodes and elements."""
        return ["*NODE, NSET=ALL", *self.nodes, *self.elements]


OUTER_FACE, INNER_FACE = "S4", "S6"
"""Faces of a brick of `Deck.strip` and `Deck.ring`: away from the axis, toward it."""


def node_set(name: str, numbers: Iterable[int]) -> list[str]:
    """A set of nodes."""
    return [f"*NSET, NSET={name}", *(f"{number}," for number in numbers)]


def surface(name: str, elements: Iterable[int], face: str) -> list[str]:
    """A face of some elements."""
    return [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{element}, {face}" for element in elements)]


def steel(names: Sequence[str], youngs_modulus: float, poisson_ratio: float) -> list[str]:
    """The same elastic solid for some sets of elements."""
    sections = [f"*SOLID SECTION, ELSET={name}, MATERIAL=STEEL" for name in names]
    return ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{youngs_modulus}, {poisson_ratio}", *sections]


def touching(one: str, other: str, stiffness: float) -> list[str]:
    """Contact without friction between two surfaces, of a stiffness of pressure over penetration."""
    return [
        *("*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness:g}, 1."),
        *("*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE", f"{one}, {other}"),
    ]


def run(folder: Path, lines: Sequence[str]) -> str:
    """What CalculiX prints of a deck at its last instant."""
    (folder / "petal.inp").write_text("\n".join(lines) + "\n", encoding="utf-8")
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    subprocess.run([str(CCX), "-i", "petal"], cwd=folder, env=environment, check=True, capture_output=True, timeout=300)
    return (folder / "petal.dat").read_text(encoding="utf-8").split("displacements")[-1]


def vectors(printed: str) -> dict[int, tuple[float, float, float]]:
    """Printed vectors by node."""
    found = {}
    for line in printed.splitlines():
        if re.match(r"\s+\d+\s+-?\d\.\d+E", line):
            key, *parts = line.split()
            x, y, z = (float(part) for part in parts)
            found[int(key)] = x, y, z
    return found


def totals(printed: str) -> list[tuple[float, float, float]]:
    """Printed totals of forces, in order."""
    found = []
    for line in printed.splitlines():
        if re.fullmatch(r"(\s+-?\d\.\d+E[+-]\d+){3}\s*", line):
            x, y, z = (float(part) for part in line.split())
            found.append((x, y, z))
    return found
