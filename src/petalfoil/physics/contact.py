"""One-sided constraints of the package (18)-(22): gaps, linear in deflections and journal displacement.

    journal   g_J = r0 + W - delta/2 - R_j - (e_x cos theta + e_y sin theta) - h_min     exposed strips         (K1)
    bushing   g_B = r_m - r0 - W                                                         phi < phi0             (K2)
    petals    g_P = (r0 + W)^{l+1} - (r0 + W)^l - delta                                  phi0 <= phi <= phi1    (K3)

Every gap is `g = rest + by_e e + G W >= 0`; its nodal reaction `lam >= 0` pushes with `G^T lam` and is complementary
to it (K4). The same `G` serves both, so the reactions do no work but through the gaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.package import PackageMesh

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Contacts:
    """Gaps of a wall.

    Attributes
    ----------
    G : (m, n) sparse
        Derivative of the gaps by the deflection unknowns [1].
    rest : (m,) array
        Gaps of the free shape with a centred journal [m].
    by_e : (m, 2) array
        Derivative of the gaps by the journal's displacement [1].
    area : (m,) array
        Area that each gap's node stands for: reaction over area is contact pressure [m^2].
    journal, bushing, petals : slice
        The rows of each kind.
    """

    G: sp.csr_array
    rest: Array
    by_e: Array
    area: Array
    journal: slice
    bushing: slice
    petals: slice

    def gaps(self, W: Array, e: Array) -> Array:
        """Gaps at deflections `W` (n,) and displacement `e` (2,), shape (m,) [m]."""
        gaps: Array = self.rest + self.by_e @ e + self.G @ W
        return gaps


def package_contacts(mesh: PackageMesh, free_radius: Array, sizes: dict[str, float]) -> Contacts:
    """Gaps of a package of petals.

    Parameters
    ----------
    mesh : PackageMesh
        Grid of the package.
    free_radius : (n_node,) array
        `r0` of the free petal at its nodes [m].
    sizes : dict
        `journal_radius`, `metric_radius`, `thickness` (with coating), `contact_film_thickness` [m].
    """
    R_j, r_m, delta, h_min = (
        sizes[k] for k in ("journal_radius", "metric_radius", "thickness", "contact_film_thickness")
    )
    number, n, N = mesh.free_numbers(), mesh.count, mesh.cells
    r0 = np.broadcast_to(free_radius[None, :, None], mesh.shape)
    theta = np.broadcast_to(mesh.theta[:, :, None], mesh.shape)
    area = np.broadcast_to(r_m * mesh.arc_weight[:, None] * mesh.axial.weight, mesh.shape)
    above, below = number[:, mesh.on_neighbour], number[np.arange(1, n + 1) % n, : mesh.n_node - N]

    film, wall, lap = mesh.exposed, mesh.on_bushing, mesh.on_neighbour
    journal_gap = r0[:, film] - 0.5 * delta - R_j - h_min
    bushing_gap = r_m - r0[:, wall]
    petal_gap = r0[:, : mesh.n_node - N] - r0[:, lap] - delta

    n_J, n_B, n_P = journal_gap.size, bushing_gap.size, petal_gap.size
    m = n_J + n_B + n_P
    rows = np.concatenate([np.arange(m), n_J + n_B + np.arange(n_P)])
    cols = np.concatenate([number[:, film].ravel(), number[:, wall].ravel(), above.ravel(), below.ravel()])
    signs = np.concatenate([np.ones(n_J), -np.ones(n_B), -np.ones(n_P), np.ones(n_P)])
    held = cols < 0  # a root does not move
    shape = (m, n * (mesh.n_node - 1) * mesh.n_z)
    G = sp.coo_array((signs[~held], (rows[~held], cols[~held])), shape=shape).tocsr()
    by_e = np.zeros((m, 2))
    by_e[:n_J] = -np.stack([np.cos(theta[:, film]).ravel(), np.sin(theta[:, film]).ravel()], axis=1)
    return Contacts(
        G,
        np.concatenate([journal_gap.ravel(), bushing_gap.ravel(), petal_gap.ravel()]),
        by_e,
        np.concatenate([area[:, film].ravel(), area[:, wall].ravel(), area[:, lap].ravel()]),
        slice(0, n_J),
        slice(n_J, n_J + n_B),
        slice(n_J + n_B, m),
    )


def bore_contacts(theta: Array, room: float, area: Array) -> Contacts:
    """Gaps between the journal and a bore that does not move: only the journal's displacement closes them.

    Parameters
    ----------
    theta : (m,) array
        Angles of the film nodes [rad].
    room : float
        Clearance less the film floor [m].
    area : (m,) array
        Area of each node [m^2].
    """
    m, none = len(theta), slice(0, 0)
    by_e = -np.stack([np.cos(theta), np.sin(theta)], axis=1)
    return Contacts(sp.csr_array((m, 0)), np.full(m, room), by_e, area, slice(0, m), none, none)
