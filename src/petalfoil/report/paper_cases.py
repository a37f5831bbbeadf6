"""The bearings of the paper (its section 3.8), the inputs that it does not state, and the assumptions for them."""

from __future__ import annotations

from dataclasses import dataclass

from petalfoil.case import Case

CITATION = (
    "S. Surovtcev, E. Zadorozhnaya, N. Khozenyuk, O. Mashkov. Building of a mathematical model for solving the "
    "elastic–gas-dynamic task of the gas lubrication theory for petal bearings. Mathematics 2023, 11(13), 2901"
)
DOI = "10.3390/math11132901"


IN_3D = {"model.kind": "3d", "petals.theory": "inextensible"}
"""The paper's bearings in 3-D: its petals bend only."""


def paper_case(count: int, **changes: object) -> Case:
    """The 2-D bearing of the paper with `count` petals and a centred journal; unstated inputs as in `UNSTATED`."""
    case = Case.model_validate(
        {
            "title": f"Paper, 2-D study, {count} petals",
            "bearing": {"journal_radius": 0.025, "bushing_radius": 0.026, "length": 0.05},
            "petals": {
                "count": count,
                "arc_length": 0.045,
                "thickness": 0.176e-3,
                "bend_radius": 0.04,
                "root_tilt": "chordal",
                "mount": "hinged",
                "youngs_modulus": 200e9,
                "poisson_ratio": 0.3,
            },
            "gas": {"viscosity": 18.5e-6, "ambient_pressure": 1e5, "temperature": 293.15},
            "surface": {"contact_film_thickness": 1e-6, "friction_coefficient": 0.3},
            "operation": {"speed": 8000.0},
            "model": {"kind": "2d"},
        }
    )
    return case.replace(**changes) if changes else case


@dataclass(frozen=True)
class UnstatedInput:
    """An input that is needed to repeat the calculation of the paper.

    Attributes
    ----------
    what : str
        The input.
    paper : str
        What the paper says about it.
    assumed : str
        The value in this report.
    """

    what: str
    paper: str
    assumed: str


STATED = "R_j = 25 mm, R_p = 1.6 R_j, δ = 0.176 mm, L = 50 mm, l = 1.8 R_j, H* = 1 mm, ω = 8000 1/s, n = 6, 8, 10"

UNSTATED = (
    UnstatedInput("petal material", "not given", "steel, 200 GPa, Poisson's ratio 0.3"),
    UnstatedInput("gas", "not given", "air at 1 bar and 20 °C, 18.5 µPa·s, no slip"),
    UnstatedInput(
        "mount of the root", "both are given, clamped (24) and hinged (25), without saying which is used", "hinged"
    ),
    UnstatedInput(
        "root tilt",
        "not given; only the bend radius of the free shape is",
        "chordal: the free edge of the free petal lies on the bore (20.1° from the bore's tangent)",
    ),
    UnstatedInput("coating", "δ with coating and δ0 without are both used; one number is given", "none"),
    UnstatedInput("contact film thickness H_min", "named in (18), no number", "1 µm"),
    UnstatedInput("bushing radius", "not given; H* is called the montage clearance", "R_B = R_j + H* = 26 mm"),
    UnstatedInput("range of e in Figure 8", "only in the figure", "0 to 280 µm"),
    UnstatedInput("direction of e, angles of the roots", "not given", "downward (θ = −90°), first root at θ = 0"),
    UnstatedInput(
        "orientation of the petals", "not given in words", "from the root to the free edge in the direction of rotation"
    ),
    UnstatedInput("load of the 2-D model", "not given", "force per length times L"),
    UnstatedInput(
        "load characteristic",
        "the modulus |F| of (64); the concluding sentence does not say at which e",
        "|F| at e = 100, 200 and 280 µm, and other interpretations below",
    ),
    UnstatedInput(
        "numbers behind Figures 6, 7 and 8", "figures without tables", "compared with the statements about them"
    ),
)

DEPARTURES = (
    "The third constraint (19) is contact between two elastic petals. The paper replaces it by the fixed bounds (21), "
    "(22) for two layers of petals; ten petals lie in three layers. The assumptions above include these bounds.",
    "Film and petals are solved simultaneously by Newton's method, not in turn. The advection term uses upwind "
    "differences where the film is thin; (56) uses central differences. Both are of second order.",
    "Curvatures (38) use the metric radius everywhere. The printed factor 1/r0² of the twist has the wrong dimension.",
    "The contact film thickness limits the approach of the journal. As in the paper, it does not enter the gas film.",
)
