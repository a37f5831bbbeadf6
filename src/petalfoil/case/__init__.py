"""WHAT is asked: frozen, validated definitions; TOML in and out. Nothing is solved here.

In the order data flows:

- `number_fields`: kinds of numbers (quantity, count) and their checks.
- `problems`: all problems of a definition → one `DefinitionError`.
- `hints`: what a wrong key or word was meant to be.
- `definition`: the base of all definitions.
- `gas_properties`: a gas by its name.
- `sections`: the tables of bearing, surface, operation and model.
- `metals`: metals by their names.
- `petal_table`: the table of the petals.
- `bump_foil_table`: the tables of a bump foil and of backing springs.
- `gas`: the table of the gas.
- `second_bearing`: what differs in the second bearing of a rotor.
- `rotor`: the table of the rotor.
- `heat_table`: the table of the heat network, and the gas as it warms up.
- `growth`: the tables of shaft and bushing, and how they grow.
- `wall_tables`: base and registry of the tables that describe a wall.
- `free_shape`: radius of a free petal bent to an arc.
- `measured_shape`: radius of a measured one.
- `shape_file`: its rows from a CSV file.
- `pack_geometry`: geometry that follows, and whether the foil pack can be assembled.
- `toml`: files and texts.
- `whole_case`: why a case cannot be solved that no single key shows.
- `definitions`: `Case`, which puts all of it together.
- `attribute_texts`: texts below the attributes of definitions.
- `keys`: every key with unit, range, default and meaning, and what a case says to it.
- `parameters`: numbers of a case that may vary, by dotted path.
- `implausible_answers`: warnings about an answer: stress, contact, bottomed-out pack, wide error bars.
- `plausibility`: warnings about a case: units, surface speed (Mach number), turbulence, materials, measured shapes.

All numbers are floats in SI units; texts such as ``"25 um"`` are read when a definition is made.
"""

from petalfoil.case.bump_foil_table import Backing, BumpFoil, Feet, Springs
from petalfoil.case.definitions import Case
from petalfoil.case.free_shape import arc_radius, chordal_tilt
from petalfoil.case.gas import Gas
from petalfoil.case.growth import Bushing, Growth, Shaft
from petalfoil.case.heat_table import Heat, HotGas
from petalfoil.case.implausible_answers import NEUTRAL, NEUTRAL_DAMPING, neutral, warnings_of_errors
from petalfoil.case.pack_geometry import PackGeometry, pack_of
from petalfoil.case.parameters import Parameter, parameter_of, parameters_of, parameters_of_petals, with_values
from petalfoil.case.petal_table import LinearAbout, Mount, Petals, PetalTheory
from petalfoil.case.plausibility import warnings_of
from petalfoil.case.rotor import Rotor, Which
from petalfoil.case.second_bearing import SecondBearing
from petalfoil.case.sections import (
    Bearing,
    ContactDiscretization,
    Edges,
    FrictionHistory,
    JournalRubbing,
    Method,
    Model,
    ModelKind,
    Operation,
    Surface,
)
from petalfoil.case.wall_tables import WallTable, register_table, unregister_table

__all__ = [
    "NEUTRAL",
    "NEUTRAL_DAMPING",
    "Backing",
    "Bearing",
    "BumpFoil",
    "Bushing",
    "Case",
    "ContactDiscretization",
    "Edges",
    "Feet",
    "FrictionHistory",
    "Gas",
    "Growth",
    "Heat",
    "HotGas",
    "JournalRubbing",
    "LinearAbout",
    "Method",
    "Model",
    "ModelKind",
    "Mount",
    "Operation",
    "PackGeometry",
    "Parameter",
    "PetalTheory",
    "Petals",
    "Rotor",
    "SecondBearing",
    "Shaft",
    "Springs",
    "Surface",
    "WallTable",
    "Which",
    "arc_radius",
    "chordal_tilt",
    "neutral",
    "pack_of",
    "parameter_of",
    "parameters_of",
    "parameters_of_petals",
    "register_table",
    "unregister_table",
    "warnings_of",
    "warnings_of_errors",
    "with_values",
]
