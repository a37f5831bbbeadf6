"""The paper behind the model."""

from __future__ import annotations

import os
from pathlib import Path

from petalfoil.api.arguments import Progress


def reproduce(folder: str | os.PathLike[str] = "report", *, progress: Progress | None = None) -> Path:
    """Compute the figures and claims of the paper, flat and in space, and write a page with data.

    Parameters
    ----------
    folder : str or path
        Where to; it is made if it is not there.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    pathlib.Path
        The page, ``index.html``.

    Raises
    ------
    StoreError
        Something cannot be written.
    """
    from petalfoil.report.reproduce import report

    return report(Path(folder), progress=progress)[1]
