"""All of the report in order."""

from __future__ import annotations

import os
from pathlib import Path

from petalfoil.analysis.session import Clock
from petalfoil.report import families, grids, study
from petalfoil.report.claims import Evidence
from petalfoil.report.families import TANGENT, Progress
from petalfoil.report.files import write
from petalfoil.report.meanings import meanings
from petalfoil.report.scope import Scope
from petalfoil.report.variations import CLAMPED, REFERENCE

WEIGHTS = (0.05, 0.3, 0.07, 0.3, 0.24, 0.04)
"""Shares of the work: four families, the study, the grids."""


def run(scope: Scope | None = None, progress: Progress | None = None) -> Evidence:
    """Compute everything."""
    scope, clock = scope or Scope(), Clock()
    parts = _parts(progress or _silent)
    reference, tangent = ("reference", REFERENCE.says), ("tangent", CLAMPED.says)
    flat = families.flat(*reference, {}, scope, parts[0])
    spatial = families.spatial(*reference, {}, scope, parts[1])
    clamped = families.flat(*tangent, TANGENT, scope, parts[2])
    clamped_spatial = families.spatial(*tangent, TANGENT, scope, parts[3])
    rows = study.run(scope, parts[4])
    return Evidence(
        flat=flat,
        spatial=spatial,
        tangent=clamped,
        tangent_spatial=clamped_spatial,
        study=rows,
        meanings=meanings(flat, {}, scope),
        tangent_meanings=meanings(clamped, TANGENT, scope),
        grids=grids.run(scope, parts[5]),
        seconds=clock.seconds,
    )


def report(folder: Path, scope: Scope | None = None, progress: Progress | None = None) -> tuple[Evidence, Path]:
    """Compute everything and write it into `folder`; gives the page too."""
    evidence = run(scope, progress)
    return evidence, write(evidence, folder)


def reproduce(folder: str | os.PathLike[str] = "report", *, progress: Progress | None = None) -> Path:
    """Compute the figures and claims of the paper, in 2-D and 3-D, and write a page with data.

    Parameters
    ----------
    folder : str or path
        Where to; it is made if it is not there.
    progress : callable, optional
        Called with the part done (0 to 1) and a text.

    Returns
    -------
    pathlib.Path
        The page, ``index.html``.

    Raises
    ------
    StoreError
        Something cannot be written.
    """
    return report(Path(folder), progress=progress)[1]


def _parts(progress: Progress) -> list[Progress]:
    """Progress of each part as a share of the whole."""
    parts, start = [], 0.0
    for weight in WEIGHTS:
        parts.append(_share(progress, start, weight))
        start += weight
    return parts


def _share(progress: Progress, start: float, weight: float) -> Progress:
    def tell(share: float, text: str) -> None:
        progress(start + weight * share, text)

    return tell


def _silent(share: float, text: str) -> None:
    """Tell nobody."""
