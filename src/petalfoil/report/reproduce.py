"""The whole report: calculations, then files."""

from __future__ import annotations

import os
from pathlib import Path

from petalfoil.equilibrium.run_context import new_run
from petalfoil.report import assumptions, paper_grids
from petalfoil.report.assumptions import CLAMPED, REFERENCE
from petalfoil.report.claims import Evidence
from petalfoil.report.interpretations import interpretations
from petalfoil.report.load_characteristics import TANGENT, Progress, Scope, family_2d, family_3d
from petalfoil.report.report_files import PAGE, SHEET, SUMMARY, refuse_foreign, write

WORK_FRACTIONS = (0.05, 0.3, 0.07, 0.3, 0.24, 0.04)
"""Fractions of the computing time: four families, the assumptions, the grids."""


def run(scope: Scope | None = None, progress: Progress | None = None) -> Evidence:
    """Compute all results of the report."""
    scope, started = scope or Scope(), new_run()
    parts = _parts(progress or _no_progress)
    reference, tangent = ("reference", REFERENCE.description), ("tangent", CLAMPED.description)
    reference_2d = family_2d(*reference, {}, scope, parts[0])
    reference_3d = family_3d(*reference, {}, scope, parts[1])
    tangent_2d = family_2d(*tangent, TANGENT, scope, parts[2])
    tangent_3d = family_3d(*tangent, TANGENT, scope, parts[3])
    return Evidence(
        reference_2d=reference_2d,
        reference_3d=reference_3d,
        tangent_2d=tangent_2d,
        tangent_3d=tangent_3d,
        assumptions=assumptions.run(scope, parts[4]),
        reference_interpretations=interpretations(reference_2d, {}, scope),
        tangent_interpretations=interpretations(tangent_2d, TANGENT, scope),
        grids=paper_grids.run(scope, parts[5]),
        seconds=started.seconds,
    )


def report(folder: Path, scope: Scope | None = None, progress: Progress | None = None) -> tuple[Evidence, Path]:
    """Compute all results and write them into `folder`; returns the results and the path of the page.

    Raises
    ------
    UsageError
        The folder holds other files.
    """
    refuse_foreign(folder, (SHEET, SUMMARY, PAGE))
    evidence = run(scope, progress)
    return evidence, write(evidence, folder)


def reproduce(folder: str | os.PathLike[str] = "paper", *, progress: Progress | None = None) -> Path:
    """Compute the figures and claims of the paper, in 2-D and 3-D, and write a page with data.

    Parameters
    ----------
    folder : str or path
        Where to; it is made if it is not there. Earlier pages of the paper in it are written anew.
    progress : callable, optional
        Called with the part done (0 to 1) and a text.

    Returns
    -------
    pathlib.Path
        The page, ``index.html``.

    Raises
    ------
    UsageError
        The folder holds other files.
    StoreError
        Something cannot be written.
    """
    return report(Path(folder), progress=progress)[1]


def _parts(progress: Progress) -> list[Progress]:
    """Progress functions of the parts of the report."""
    parts, start = [], 0.0
    for fraction in WORK_FRACTIONS:
        parts.append(_part(progress, start, fraction))
        start += fraction
    return parts


def _part(progress: Progress, start: float, length: float) -> Progress:
    def tell(fraction: float, text: str) -> None:
        progress(start + length * fraction, text)

    return tell


def _no_progress(fraction: float, text: str) -> None:
    """Report no progress."""
