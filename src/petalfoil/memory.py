"""Memory that a case's grid needs, told before it is taken.

Nearly all of it is the factorisation of the coupled system. With nested dissection a grid of `N` unknowns fills in to
some ``c N log2 N`` entries (George 1973); `c` is measured, at the peak of whole runs of `solve`.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace

from petalfoil.case import Case, ModelKind, PetalTheory
from petalfoil.errors import DefinitionError
from petalfoil.units.writing import format_quantity

BYTES_WITH_PETALS = 900.0
"""`c` of film and petals [bytes]: measured 430 to 660 over 4 000 to 160 000 unknowns, to 780 with adapted stations."""

BYTES_WITH_STRETCHING = 1200.0
"""`c` of film and petals that stretch [bytes]: measured 540 to 1160 over 3 700 to 290 000 unknowns."""

BYTES_OF_FILM = 350.0
"""`c` of a film alone [bytes]: measured 220 to 330, over 2 000 to 130 000 unknowns."""

SMALLER = 0.98
"""Factor between the grids that are tried for one that fits."""


@dataclass(frozen=True)
class GridSize:
    """Size of a case's grid.

    Attributes
    ----------
    petals : int
        Petals; 0 in a plain bearing.
    overlap : float
        Petal angle over pitch [1]; 0 in a plain bearing.
    cells : int
        Cells per pitch; of a plain bearing round the circle.
    axial : int
        Cells over the whole length; 0 in a 2-D model.
    symmetric : bool
        Half the length is gridded.
    stretches : bool
        Petals also have displacements along themselves and along the shaft.
    """

    petals: int
    overlap: float
    cells: int
    axial: int
    symmetric: bool
    stretches: bool = False

    @property
    def unknowns(self) -> int:
        """Number of pressures and displacements of petals."""
        stations = 1 + (self.axial // 2 if self.symmetric else self.axial)
        if not self.petals:
            return self.cells * stations
        along, each = math.ceil(self.overlap * self.cells), 3 * stations - 1 if self.stretches else stations
        return self.petals * (along * each + self.cells * stations)

    @property
    def memory(self) -> float:
        """Estimate of the memory that solving takes at its peak, beside Python itself [bytes]."""
        with_petals = BYTES_WITH_STRETCHING if self.stretches else BYTES_WITH_PETALS
        factor = with_petals if self.petals else BYTES_OF_FILM
        return factor * self.unknowns * math.log2(self.unknowns)

    @property
    def words(self) -> str:
        """The keys of a case that give this grid."""
        along = f"cells_per_pitch = {self.cells}"
        return f"{along}, axial_cells = {self.axial}" if self.axial else along

    def scaled(self, factor: float) -> GridSize:
        """The grid with `factor` as many cells each way, an even number along the axis."""
        axial = max(2 * int(0.5 * factor * self.axial), 2) if self.axial else 0
        return replace(self, cells=max(int(factor * self.cells), 4), axial=axial)


def grid_of(case: Case) -> GridSize:
    """The grid of a case."""
    pack, axial = case.pack, 0 if case.model.kind is ModelKind.TWO_D else case.axial_cells
    count, overlap = (0, 0.0) if pack is None else (pack.count, pack.overlap)
    stretches = case.petal_theory is PetalTheory.SHELL and axial > 0
    return GridSize(count, overlap, case.cells_per_pitch, axial, case.symmetric, stretches)


def check_memory(case: Case, bearings: int = 1) -> None:
    """Refuse a grid that needs more memory than there is.

    Parameters
    ----------
    case : Case
        The case that is to be solved.
    bearings : int
        Equal bearings that are solved together.

    Raises
    ------
    DefinitionError
        The message tells the memory needed and available, and a grid of the same proportions that fits.
    """
    grid, available = grid_of(case), available_memory()
    if bearings * grid.memory <= available:
        return
    fitting = _fitting(grid, available / bearings)
    raise DefinitionError(
        f"model.cells_per_pitch: a grid of {grid.words} has {bearings * grid.unknowns:.2g} unknowns and needs some "
        f"{_gigabytes(bearings * grid.memory)} of memory, {_gigabytes(available)} are available; allowed: {fitting}",
        key="model.cells_per_pitch",
        given=case.cells_per_pitch,
        allowed=fitting,
    )


def available_memory() -> float:
    """Memory that can be taken without swapping and within the limits of this process [bytes]."""
    import psutil

    return min(float(psutil.virtual_memory().available), within_limits())


def within_limits() -> float:
    """Memory that the operating system still grants this process; infinite without limits [bytes].

    Near such a limit the sparse factorisation does not fail: it goes on with little memory, for minutes.
    """
    if os.name != "posix":
        return math.inf
    import resource

    import psutil

    used = psutil.Process().memory_info()
    taken = {resource.RLIMIT_AS: used.vms, resource.RLIMIT_DATA: getattr(used, "data", used.rss)}
    limits = {kind: resource.getrlimit(kind)[0] for kind in taken}
    granted = (limits[kind] - size for kind, size in taken.items() if limits[kind] != resource.RLIM_INFINITY)
    return max(float(min(granted, default=math.inf)), 0.0)


def _fitting(grid: GridSize, available: float) -> str:
    """Words for a grid of about the same proportions that fits into `available` [bytes]."""
    factor = SMALLER
    while (smaller := grid.scaled(factor)).memory > available:
        if smaller.cells == 4:
            return "none here, free some memory"
        factor *= SMALLER
    return f"up to {smaller.words}"


def _gigabytes(size: float) -> str:
    return f"{format_quantity(size / 1e9, '1', digits=2)} GB"
