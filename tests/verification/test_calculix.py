"""Petals against CalculiX (`ccx`), where it is installed: shell elements, solids in contact, large rotations.

One petal is a cylindrical panel that coincides with its bore (`R_p = r_m`), 45 x 50 mm on a radius of 26 mm, 0.176 mm
of steel, under a uniform pressure so small that the answer is linear; S8R elements with membrane and shear, closer
together toward the root, where a clamped petal's sides bow within 2 mm.

The pressure of a shell element acts on its inner face, whose area is smaller than the mid-surface's by `t / 2R`,
0.34 %: the comparison takes that out.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose

from petalfoil.mesh.axial import axis_2d, axis_3d
from petalfoil.physics.petal_membrane import StretchingPetal
from petalfoil.physics.shell import PetalShell
from petalfoil.solvers.lcp import solve_lcp
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.walls.sliding import stretching
from tests.cases import case
from tests.verification import calculix as ccx
from tests.verification.elastica import PressedPetal, elastica_force, pressed_radius
from tests.verification.shell_helpers import Array, uniform_load

pytestmark = [pytest.mark.skipif(ccx.CCX is None, reason=ccx.NEEDED), pytest.mark.slow]

RADIUS, ARC, LENGTH, THICKNESS = 26e-3, 45e-3, 50e-3, 0.176e-3
ANGLE = ARC / RADIUS
YOUNG = 200e9
PRESSURE = 1.0  # Pa
ALONG, ACROSS = 32, 12  # elements


def toward_root(part: float) -> float:
    """Angle of a part of the elements from the root, which are shorter there."""
    return ANGLE * part * (0.15 + 0.85 * part)


@dataclass(frozen=True)
class Panel:
    """Nodes of a panel of eight-node elements, root at `-ANGLE`, free edge at angle 0, where outward is x."""

    number: dict[tuple[int, int], int]
    angle: dict[int, float]
    lines: list[str]


def panel() -> Panel:
    number: dict[tuple[int, int], int] = {}
    angle, lines = {}, ["*NODE, NSET=ALL"]
    for i in range(2 * ALONG + 1):
        middle = 0.5 * (toward_root((i - 1) / (2 * ALONG)) + toward_root((i + 1) / (2 * ALONG)))
        at = middle if i % 2 else toward_root(i / (2 * ALONG))
        for j in range(2 * ACROSS + 1):
            if i % 2 and j % 2:
                continue
            key = len(number) + 1
            number[i, j], angle[key] = key, at - ANGLE
            x, y = RADIUS * math.cos(angle[key]), RADIUS * math.sin(angle[key])
            lines.append(f"{key}, {x:.12e}, {y:.12e}, {LENGTH * j / (2 * ACROSS):.12e}")
    lines.append("*ELEMENT, TYPE=S8R, ELSET=PETAL")
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    corners = [(i, j) for i in range(0, 2 * ALONG, 2) for j in range(0, 2 * ACROSS, 2)]
    for count, (i, j) in enumerate(corners, start=1):
        lines.append(", ".join(str(n) for n in [count, *(number[i + a, j + b] for a, b in around)]))
    for name, row in (("ROOT", 0), ("TIP", 2 * ALONG)):
        lines += ccx.node_set(name, (number[row, j] for j in range(2 * ACROSS + 1)))
    return Panel(number, angle, lines)


def outward(moved: tuple[float, float, float], angle: float) -> float:
    """Radial part of a displacement."""
    return moved[0] * math.cos(angle) + moved[1] * math.sin(angle)


def half_way(mesh: Panel, moved: dict[int, tuple[float, float, float]], across: int) -> float:
    """Outward deflection half way up the petal, by the parabola of the element that has the place."""
    row = next(i for i in range(0, 2 * ALONG, 2) if mesh.angle[mesh.number[i + 2, 0]] > -0.5 * ANGLE)
    keys = [mesh.number[i, across] for i in (row, row + 1, row + 2)]
    angles = [mesh.angle[key] for key in keys]
    W = [outward(moved[key], mesh.angle[key]) for key in keys]
    return float(np.polyval(np.polyfit(angles, W, 2), -0.5 * ANGLE))


def by_calculix(folder: Path, nu: float, *, clamped: bool) -> dict[str, float]:
    """Outward deflections at the free edge and half way, in the middle and on the side."""
    mesh = panel()
    held = ["ROOT, 1, 6"] if clamped else ["ROOT, 1, 3", "TIP, 1, 1"]
    deck = [
        *mesh.lines,
        *("*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, {nu}"),
        *("*SHELL SECTION, ELSET=PETAL, MATERIAL=STEEL", f"{THICKNESS}"),
        *("*BOUNDARY", *held),
        *("*STEP", "*STATIC", "*DLOAD", f"PETAL, P, {PRESSURE}"),
        *("*NODE PRINT, NSET=ALL", "U", "*END STEP"),
    ]
    moved, inner_face = ccx.vectors(ccx.run(folder, deck)), 1.0 - 0.5 * THICKNESS / RADIUS
    found = {
        "tip middle": moved[mesh.number[2 * ALONG, ACROSS]][0],
        "tip side": moved[mesh.number[2 * ALONG, 0]][0],
        "half middle": half_way(mesh, moved, ACROSS),
        "half side": half_way(mesh, moved, 0),
    }
    return {name: value / inner_face for name, value in found.items()}


def by_petalfoil(nu: float, *, clamped: bool, is_2d: bool, stretches: bool = False) -> dict[str, float]:
    cells = 96
    axial = axis_2d(LENGTH) if is_2d else axis_3d(LENGTH, 48, half=True)
    D = YOUNG * THICKNESS**3 / 12.0 / (1.0 - nu**2)
    shell = PetalShell(np.linspace(0.0, ANGLE, cells + 1), axial, RADIUS, RADIUS, D, nu, clamped)
    n_z, force = len(axial.z), PRESSURE * uniform_load(shell).ravel()
    if stretches:
        petal = StretchingPetal(shell, 12.0 * D / THICKNESS**2)
        S = petal.strain @ petal.difference
        K, free = sp.csr_array(S.T @ petal.rigidity_matrix @ S), petal.free
        force = np.append(force, np.zeros(len(free) - len(force)))
    else:
        K, free = shell.stiffness, np.arange(len(force)) >= n_z
    if not clamped:
        free[shell.stiffness.shape[0] - n_z : shell.stiffness.shape[0]] = False
    x: Array = np.zeros(len(force))
    x[free] = LinearSolver().factor(sp.csc_array(K[free][:, free])).solve(force[free])
    W = x[: shell.stiffness.shape[0]].reshape(-1, n_z)
    return {
        "tip middle": W[-1, -1],
        "tip side": W[-1, 0],
        "half middle": W[cells // 2, -1],
        "half side": W[cells // 2, 0],
    }


@pytest.mark.parametrize("clamped", [True, False], ids=["clamped", "hinged and propped"])
@pytest.mark.parametrize("is_2d", [True, False], ids=["2d", "3d"])
def test_without_lateral_contraction(tmp_path: Path, is_2d: bool, clamped: bool) -> None:
    """Both bend alike all along the shaft. What remains are the grids of both (2e-4 each) and `(t / R)^2`."""
    theirs, ours = by_calculix(tmp_path, 0.0, clamped=clamped), by_petalfoil(0.0, clamped=clamped, is_2d=is_2d)
    for place, value in ours.items():
        if clamped or place.startswith("half"):
            assert_allclose(value, theirs[place], rtol=1e-3, err_msg=place)


@pytest.mark.parametrize("clamped", [True, False], ids=["clamped", "hinged and propped"])
def test_2d_model_of_steel(tmp_path: Path, clamped: bool) -> None:
    """A curved petal cannot bow across (its mid-surface would stretch), which is what the 2-D model says of it.

    1 %: edges do bow, over a width like `sqrt(R t)` = 2 mm of 50.
    """
    theirs, ours = by_calculix(tmp_path, 0.3, clamped=clamped), by_petalfoil(0.3, clamped=clamped, is_2d=True)
    for place, value in ours.items():
        if clamped or place.startswith("half"):
            assert_allclose(value, theirs[place], rtol=1e-2, err_msg=place)


def test_3d_model_of_steel_bows_more_than_a_shell(tmp_path: Path) -> None:
    """The limit of (33)-(39): without energy for stretching along the shaft, the petal bows across as a plate does.

    Clamped: 4 % at the middle of the free edge, against none between middle and side of the shell.
    """
    theirs, ours = by_calculix(tmp_path, 0.3, clamped=True), by_petalfoil(0.3, clamped=True, is_2d=False)
    assert_allclose(theirs["tip middle"], theirs["tip side"], rtol=1e-3)
    for place, value in ours.items():
        assert_allclose(value, theirs[place], rtol=5e-2, err_msg=place)
    assert ours["tip middle"] / theirs["tip middle"] > 1.03


@pytest.mark.parametrize("clamped", [True, False], ids=["clamped", "hinged and propped"])
def test_a_petal_that_stretches_is_a_shell(tmp_path: Path, clamped: bool) -> None:
    """Deflections with `petals.theory = "shell"` within 0.5 %, in the middle and on the sides, where they bow."""
    theirs, ours = (
        by_calculix(tmp_path, 0.3, clamped=clamped),
        by_petalfoil(0.3, clamped=clamped, is_2d=False, stretches=True),
    )
    for place, value in ours.items():
        if clamped or place.startswith("half"):
            assert_allclose(value, theirs[place], rtol=5e-3, err_msg=place)


# ------------------------------------------------------------------------------------------ two petals in contact

HALF = 24
"""Elements of half a petal."""


def two_by_calculix(folder: Path) -> dict[str, float]:
    """Two clamped petals in plane strain; the inner one, under pressure, lies on the outer one half a petal further."""
    deck = ccx.Deck(1e-3)

    def arc(radius: float, root: float) -> list[tuple[float, float, float]]:
        ends = [root + toward_root(i / (2 * HALF)) for i in range(2 * HALF + 1)]
        angles = [*(angle for a, b in pairwise(ends) for angle in (a, 0.5 * (a + b))), ends[-1]]
        return [(radius * math.cos(a), radius * math.sin(a), a) for a in angles]

    inner = deck.strip("INNER", arc(RADIUS, -ANGLE), THICKNESS)
    outer = deck.strip("OUTER", arc(RADIUS + THICKNESS, -0.5 * ANGLE), THICKNESS)
    last = {name: 4 * HALF for name in ("INNER", "OUTER")}
    printed = ccx.run(
        folder,
        [
            *deck.lines,
            *ccx.node_set("ROOTS", (number for part in (inner, outer) for (_, i, _), number in part.items() if i == 0)),
            *ccx.surface("ABOVE", range(1, 2 * HALF + 1), ccx.OUTER_FACE),
            *ccx.surface("BELOW", range(2 * HALF + 1, 4 * HALF + 1), ccx.INNER_FACE),
            *ccx.steel(("INNER", "OUTER"), YOUNG, 0.3),
            *ccx.touching("ABOVE", "BELOW", 1e14),
            *("*BOUNDARY", "ROOTS, 1, 2", "ALL, 3, 3", "*STEP, INC=200", "*STATIC", "0.5, 1., 1e-5, 0.5"),
            *("*DLOAD", "INNER, P6, 2000.", "*NODE PRINT, NSET=ALL", "U", "*END STEP"),
        ],
    )
    moved = ccx.vectors(printed)
    return {
        "inner tip": outward(moved[inner[1, last["INNER"], 0]], 0.0),
        "outer tip": outward(moved[outer[1, last["OUTER"], 0]], 0.5 * ANGLE),
    }


def two_by_petalfoil(cells: int) -> dict[str, float]:
    """The same petals with `cells` each, in contact at nodes."""
    D, n = YOUNG * THICKNESS**3 / 12.0 / (1.0 - 0.3**2), cells
    phi = np.linspace(0.0, ANGLE, cells + 1)
    shells = [PetalShell(phi, axis_2d(1.0), r, r, D, 0.3, clamped=True) for r in (RADIUS, RADIUS + THICKNESS)]
    K = stretching([StretchingPetal(shell, 12.0 * D / THICKNESS**2) for shell in shells]).stiffness.toarray()
    force = np.zeros(4 * n)
    force[:n] = 2e3 * (1.0 - 0.5 * THICKNESS / RADIUS) * uniform_load(shells[0])[1:, 0]
    above = np.arange(n // 2, n)
    G = np.zeros((len(above), 4 * n))
    G[np.arange(len(above)), above] = -1.0
    G[np.arange(len(above)), n + above - n // 2] = 1.0
    give = np.linalg.solve(K, np.column_stack([force, G.T]))
    compliance, gaps = G @ give[:, 1:], G @ give[:, 0]
    scale = float(np.max(compliance))
    reaction = solve_lcp(compliance / scale, gaps, gaps < 0.0)
    assert reaction is not None
    w = give[:, 0] + give[:, 1:] @ reaction / scale
    return {"inner tip": w[n - 1], "outer tip": w[2 * n - 1]}


def test_two_petals_in_contact(tmp_path: Path) -> None:
    """A petal under pressure that lies on the next one, which bends by what it carries: tips within 1 %."""
    theirs, ours = two_by_calculix(tmp_path), two_by_petalfoil(192)
    for place, value in ours.items():
        assert_allclose(value, theirs[place], rtol=1e-2, err_msg=place)


# ------------------------------------------------------------------------------------------ large rotations


def pressed_by_calculix(folder: Path, name: str) -> float:
    """Force of the journal on one hinged petal of a bearing, from its free arc to the bore (NLGEOM) [N].

    As the elastica: half a petal, whose end a rigid link keeps at the metric radius. The journal grows.
    """
    of = case(name)
    assert of.petals is not None
    assert of.pack is not None
    petals, pack, width, cells = of.petals, of.pack, 1e-3, 40
    R, t, half = pack.bend_radius, petals.mean.thickness, 0.5 * petals.arc_length / pack.bend_radius
    middle = PressedPetal(petals.arc_length / pack.metric_radius, R / pack.metric_radius).free()[0] * pack.metric_radius
    angles = np.linspace(0.0, half, 2 * cells + 1)
    deck = ccx.Deck(width)
    arc = [(middle - R + R * math.cos(a), R * math.sin(a), a) for a in angles]
    petal = deck.strip("PETAL", arc, t)
    around = np.linspace(-0.02, 0.6, 201)
    start = middle - 0.5 * t - 2e-5
    journal = deck.ring("JOURNAL", start, list(around), 1e-3)
    axis = {k: deck.node(0.0, 0.0, 0.5 * k * width) for k in (0, 2)}
    grown = pressed_radius(of) - 0.5 * t - start
    moved = [
        f"{number}, {way}, {way}, {grown * part:.12e}"
        for (_, i, _), number in journal.items()
        for way, part in ((1, math.cos(around[i])), (2, math.sin(around[i])))
    ]
    printed = ccx.run(
        folder,
        [
            *deck.lines,
            *ccx.node_set("MIDDLE", (number for (_, i, _), number in petal.items() if i == 0)),
            *ccx.node_set("JOURNAL", journal.values()),
            *ccx.node_set("AXIS", axis.values()),
            *(line for k in axis for line in ("*MPC", f"BEAM, {petal[1, 2 * cells, k]}, {axis[k]}")),
            *ccx.surface("INSIDE", range(1, cells + 1), ccx.INNER_FACE),
            *ccx.surface("OUTSIDE", range(cells + 1, cells + 201), ccx.OUTER_FACE),
            *ccx.steel(("PETAL", "JOURNAL"), petals.mean.youngs_modulus, petals.mean.poisson_ratio),
            *ccx.touching("INSIDE", "OUTSIDE", 1e13),
            *("*BOUNDARY", "ALL, 3, 3", "MIDDLE, 2, 2", "AXIS, 1, 2"),
            *("*STEP, NLGEOM, INC=400", "*STATIC", "0.02, 1., 1e-5, 0.1", "*BOUNDARY", *moved),
            *("*NODE PRINT, NSET=JOURNAL, FREQUENCY=999, TOTALS=ONLY", "RF", "*END STEP"),
        ],
    )
    (x, y, _) = ccx.totals(printed)[-1]
    return 2.0 * math.hypot(x, y) / width * of.bearing.length


@pytest.mark.parametrize("name", ["paper_n8", pytest.param("rig", marks=pytest.mark.long)])
def test_preload_of_a_petal_from_its_free_arc(tmp_path: Path, name: str) -> None:
    """Solid elements through large rotations press with the force of the elastica, within 0.2 %."""
    of = case(name, **{"petals.linear_about": "bore"})
    assert pressed_by_calculix(tmp_path, name) == pytest.approx(elastica_force(of, pressed_radius(of)), rel=2e-3)
