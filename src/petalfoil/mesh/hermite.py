"""Cubic Hermite elements: values and slopes at nodes make a curve with a continuous slope.

On an element of length `h`, with `t` in [0, 1], a curve is

    w(t) = H_0(t) w_0 + H_1(t) h w_0' + H_2(t) w_1 + H_3(t) h w_1'                                     (S5)

so that `dw/dt = h w'`. The element of fourth order in the value of a bent beam, third in its slope.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity import compressed

Array = NDArray[np.float64]
Index = NDArray[np.intp]

COEFFICIENTS = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=np.float64)
"""Row `k` holds the powers of `t` in `H_k`."""


def differentiated(coefficients: Array) -> Array:
    """Powers of `t` in the derivatives."""
    return coefficients[:, 1:] * np.arange(1, coefficients.shape[1])


DERIVATIVES = (COEFFICIENTS, differentiated(COEFFICIENTS), differentiated(differentiated(COEFFICIENTS)))
"""The same in `H_k` and its first two derivatives."""

BOTH = np.concatenate([COEFFICIENTS, np.pad(DERIVATIVES[1], ((0, 0), (0, 1)))]).T
"""Columns hold the powers of `t` in `H_k`, then those in their first derivatives."""


def basis(t: Array, derivative: int = 0) -> Array:
    """`H_0 ... H_3` at places `t` (k,) of an element, or a derivative of them by `t`; (k, 4)."""
    coefficients = DERIVATIVES[derivative]
    return np.asarray(powers(t)[:, : coefficients.shape[1]] @ coefficients.T)


def powers(t: Array) -> Array:
    """Powers of places `t` (k,) up to the third, (k, 4)."""
    out = np.ones((len(t), 4))
    out[:, 1] = t
    np.multiply(t, t, out=out[:, 2])
    np.multiply(out[:, 2], t, out=out[:, 3])
    return out


def rows(element: Index, t: Array, length: Array, derivative: int = 0) -> sp.csr_array:
    """Weights of nodal (value, slope) pairs in a curve at places `t` (k,) of elements (k,); (k, 2 nodes).

    `length` (n_element,) is that of the elements; element `e` lies between the nodes `e` and `e + 1`. A derivative is
    by `t`.
    """
    columns, weights = entries(element, t, length, derivative)
    starts = np.arange(0, weights.size + 1, weights.shape[1])
    shape = (len(element), 2 * len(length) + 2)
    return compressed(sp.csr_array, weights.ravel(), columns.ravel(), starts, shape)


def entries(element: Index, t: Array, length: Array, derivative: int = 0) -> tuple[Index, Array]:
    """Columns and values of `rows`, (k, 4) each."""
    weights = basis(t, derivative)
    weights[:, 1::2] *= length[element][:, None]
    return 2 * element[:, None] + np.arange(4), weights


def entries_with_slopes(element: Index, t: Array, length: Array) -> tuple[Index, Array]:
    """Columns (k, 4) of `rows`, and its values of the curve and of its slope by `t`, (k, 2, 4)."""
    weights = (powers(t) @ BOTH).reshape(-1, 2, 4)
    weights[:, :, 1::2] *= length[element][:, None, None]
    return 2 * element[:, None] + np.arange(4), weights


def integral_basis(t: Array) -> Array:
    """Integrals of `H_0 ... H_3` from the start of an element to places `t` (k,) by `t`, (k, 4)."""
    powers = np.arange(1, COEFFICIENTS.shape[1] + 1)
    return np.asarray(t[:, None] ** powers @ (COEFFICIENTS / powers).T)


def integrals(element: Index, t: Array, length: Array) -> Array:
    """Weights of nodal (value, slope) pairs in the integral of a curve from its first node; (k, 2 nodes).

    Places and `length` as in `rows`; the integral is by the same angle as `length`.
    """
    over = integral_basis(np.asarray(t))
    whole = integral_basis(np.ones(1))[0]
    before = np.arange(len(length)) < element[:, None]
    each = np.where(before[:, :, None], whole, 0.0)
    each[np.arange(len(element)), element] = over
    each *= length[:, None]
    each[:, :, 1::2] *= length[:, None]
    out = np.zeros((len(element), 2 * len(length) + 2))
    shape = (len(element), 2 * len(length))
    out[:, :-2] += each[:, :, :2].reshape(shape)
    out[:, 2:] += each[:, :, 2:].reshape(shape)
    return out


def located(angle: Array, nodes: Array) -> tuple[Index, Array]:
    """Element and place in it of each `angle` between the first and the last of the `nodes`."""
    element = np.clip(np.searchsorted(nodes, angle, side="right") - 1, 0, len(nodes) - 2)
    return element, (angle - nodes[element]) / np.diff(nodes)[element]
