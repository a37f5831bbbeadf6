"""The paper's packages (its section 3.8), where it is silent, and what was assumed instead."""

from __future__ import annotations

from dataclasses import dataclass

from petalfoil.case import Case

CITATION = (
    "S. Surovtcev, E. Zadorozhnaya, N. Khozenyuk, O. Mashkov. Building of a mathematical model for solving the "
    "elastic–gas-dynamic task of the gas lubrication theory for petal bearings. Mathematics 2023, 11(13), 2901"
)
DOI = "10.3390/math11132901"


def package(count: int, **changes: object) -> Case:
    """The paper's flat study with `count` petals, the journal central; its silent values as in `SILENT`."""
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
class Silence:
    """One thing a reader needs to repeat the study.

    Attributes
    ----------
    what : str
        The thing.
    paper : str
        What the paper says of it.
    assumed : str
        What this report takes.
    """

    what: str
    paper: str
    assumed: str


STATED = "R_j = 25 mm, R_p = 1.6 R_j, δ = 0.176 mm, L = 50 mm, l = 1.8 R_j, H* = 1 mm, ω = 8000 1/s, n = 6, 8, 10"

SILENT = (
    Silence("petal material", "not given", "steel, 200 GPa, Poisson's ratio 0.3"),
    Silence("gas", "not given", "air at 1 bar and 20 °C, 18.5 µPa·s, no slip"),
    Silence("mount of the root", "both written down, rigid (24) and hinged (25); not said which", "hinged"),
    Silence("root tilt", "not given; the free shape is known by its bend radius only", "chordal: the free edge of the "
            "free petal lies on the bore (20.1° from the bore's tangent)"),
    Silence("coating", "δ with it and δ0 without are both used, one number is given", "none: all of it is metal"),
    Silence("film floor H_min", "named in (18), no number", "1 µm"),
    Silence("bushing radius", "not given; H* is called the montage clearance", "R_B = R_j + H* = 26 mm"),
    Silence("range of e in Figure 8", "only in the picture", "0 to 280 µm"),
    Silence("direction of e, places of the roots", "not given", "downward (θ = −90°), first root at θ = 0"),
    Silence("sense of the petals", "not given in words", "from root to free edge with the rotation"),
    Silence("load of the flat model", "not given", "force per length times L"),
    Silence("load characteristic", "the modulus |F| of (64); the concluding sentence does not say at which e",
            "|F| at e = 100, 200 and 280 µm, and other readings below"),
    Silence("numbers behind Figures 6, 7 and 8", "pictures without tables", "compared by the sentences about them"),
)  # fmt: skip

DEPARTURES = (
    "Petals touch petals: the third restriction (19) is kept as contact between two elastic petals. The paper folds it "
    "into fixed bounds (21), (22), which know two layers; ten petals lie in three. The study above has the bounds too.",
    "Film and petals are solved together by Newton's method, not in turn; pressures are upwinded where the film is "
    "thin, (56) is central. Both are of second order.",
    "Curvatures (38) take the metric radius throughout; the printed 1/r0² before the twist has the wrong dimension.",
    "The film floor only stops the journal: as in the paper, it does not enter the gas.",
)
