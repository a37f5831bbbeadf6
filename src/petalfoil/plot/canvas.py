"""The figure as a notebook shows it, and as it is written to a file."""

from __future__ import annotations

import io
from pathlib import Path

from matplotlib.figure import Figure

from petalfoil.errors import StoreError, UsageError
from petalfoil.results.atomic import replacing

DPI = 150
"""Resolution of a file."""
NOTEBOOK_DPI = 90
"""Resolution in a notebook, whose column is narrower than a page."""

# No date in the file: drawing a result again does not make another file of it.
_METADATA: dict[str, dict[str, str | None]] = {
    "png": {"Software": "petalfoil"},
    "pdf": {"Creator": "petalfoil", "CreationDate": None},
    "svg": {"Creator": "petalfoil", "Date": None},
}


class ResultFigure(Figure):
    """A matplotlib figure that a notebook shows as the value of a cell; it opens no window and is not pyplot's."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=NOTEBOOK_DPI)
        return buffer.getvalue()


def save(fig: Figure, path: str | Path) -> None:
    """Write a figure; a former file is replaced whole, or left alone if the writing fails.

    Parameters
    ----------
    fig : matplotlib.figure.Figure
        Figure to write.
    path : str or Path
        Where to; the suffix chooses the format: png, pdf or svg.

    Raises
    ------
    UsageError
        The suffix is none of these.
    StoreError
        The file cannot be written.
    """
    target = Path(path)
    form = figure_format(target)
    try:
        with replacing(target) as temporary:
            fig.savefig(temporary, format=form, dpi=DPI, metadata=_METADATA[form])
    except OSError as error:
        raise StoreError(f"cannot write {target}: {error}") from error


def figure_format(path: Path) -> str:
    """Format that the suffix of a figure's file asks for."""
    form = path.suffix.lower().removeprefix(".")
    if form not in _METADATA:
        allowed = ", ".join(f".{name}" for name in _METADATA)
        raise UsageError(
            f"a figure is written as one of {allowed}; {path.name!r} asks for {path.suffix or 'no format'!r}"
        )
    return form
