"""The verbs as functions: a case in, labelled data out.

Each is the same analysis as the verb of the command line. Speeds, displacements, loads and angles are SI numbers or
texts with a unit, as in a case.

- ``positions``  `solve`, `converge`, `curve`, `static`, `check`: the journal is where the caller puts it
- ``loads``      `balance`, `liftoff`, `runup`: the journal is where its load puts it
- ``dynamics``   `coefficients`, `stability`: small motions about either
- ``motion``     `orbit`: the journal through time
- ``paper``      `reproduce`: the paper's figures and claims
- ``arguments``  what callers give, to SI numbers
"""

from petalfoil.api.dynamics import coefficients, stability
from petalfoil.api.loads import balance, liftoff, runup
from petalfoil.api.motion import orbit
from petalfoil.api.paper import reproduce
from petalfoil.api.positions import check, converge, curve, solve, static

__all__ = [
    "balance",
    "check",
    "coefficients",
    "converge",
    "curve",
    "liftoff",
    "orbit",
    "reproduce",
    "runup",
    "solve",
    "stability",
    "static",
]
