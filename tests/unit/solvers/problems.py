"""Small problems with gaps and known answers."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity import SparseRows
from tests.verification.shell_helpers import ElasticProblem, rows_of

Array = NDArray[np.float64]

CELLS = 40
OBSTACLE = 0.25**2 / 2.0
"""Distance at which a string under unit load first touches a quarter of the way: a node of the grid."""


def string(cells: int = CELLS, distance: float = OBSTACLE) -> ElasticProblem:
    """A string of unit length and tension, fixed at both ends, pressed by a unit load against a flat obstacle."""
    h, n = 1.0 / cells, cells - 1
    K = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)) / h
    G = rows_of(n, (np.arange(n), -1.0))
    return ElasticProblem(sp.csr_array(K) / h, np.ones(n), G, np.full(n, distance), np.ones(n))


def string_answer(cells: int = CELLS) -> tuple[Array, Array]:
    """Deflections and reactions over the unit of nodal force; parabolas, which the grid reproduces exactly."""
    x = np.arange(1, cells) / cells
    side = np.minimum(np.minimum(x, 1.0 - x), 0.25)
    lam = np.where(side >= 0.25, 1.0, 0.0)
    lam[[cells // 4 - 1, 3 * cells // 4 - 1]] = 0.5  # where the string lands it bears half of its load itself
    return 0.25 * side - side**2 / 2.0, lam


@dataclass(frozen=True)
class Spring:
    """One unknown `x > 0` and a gap `1 - x`; a spring `x` balances a film `strength / gap`, which reads the gap."""

    strength: float

    @property
    def G(self) -> SparseRows:
        """The gap closes as x grows."""
        return SparseRows([[-1.0]])

    @property
    def acting(self) -> SparseRows:
        """Its reaction acts along it."""
        return self.G

    @property
    def weight(self) -> Array:
        """One gap."""
        return np.ones(1)

    @property
    def elimination_key(self) -> None:
        """The solver orders the elimination itself."""

    @property
    def positive(self) -> slice:
        """x itself."""
        return slice(0, 1)

    def gaps(self, x: Array) -> Array:
        """`1 - x`."""
        return 1.0 - x

    def admits(self, x: Array) -> bool:
        """The film is open."""
        return bool(x[0] < 1.0)

    def linearize(self, x: Array, shift: Array | None = None) -> "SpringLine":
        """The film reads `1 - x + shift`."""
        return SpringLine(self.strength, x, 1.0 - x + (0.0 if shift is None else shift))


@dataclass(frozen=True)
class SpringLine:
    """The spring at one point."""

    strength: float
    x: Array
    film: Array

    @property
    def residual(self) -> Array:
        """`x - strength / film`."""
        return self.x - self.strength / self.film

    @property
    def row_scale(self) -> Array:
        """A unit force."""
        return np.ones(1)

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """The film stiffens as the gap closes; a step in time adds a damper."""
        return sp.csc_array([[1.0 - self.strength / self.film[0] ** 2 + barrier_weight[0] + rate]])

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """A wider gap weakens the film."""
        return self.strength / self.film**2 * change
