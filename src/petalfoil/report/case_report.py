"""The report of a case: a page for a design review, its results beside it."""

from __future__ import annotations

import json
import os
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from petalfoil.analysis.arguments import LoadVector, Mass
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import new_run
from petalfoil.errors import StoreError
from petalfoil.report import case_page, pdf
from petalfoil.report.case_results import Part, Progress, Request, compute
from petalfoil.report.report_files import refuse_foreign
from petalfoil.results.atomic import replacing
from petalfoil.results.store import save

PAGE, PRINTED, SUMMARY, CASE = "index.html", "report.pdf", "report.json", "case.toml"
"""Files of the report."""
OWN = (CASE, SUMMARY, PAGE)
"""Files by which a folder is known as that of a report of a case."""


def report(request: Request, folder: Path, *, print_it: bool, progress: Progress) -> tuple[tuple[Part, ...], Path]:
    """Compute all parts and write them into `folder`; returns the parts and the path of the page.

    Raises
    ------
    UsageError
        A PDF is asked for, and nothing on this machine prints; or the folder holds other files.
    StoreError
        A file cannot be written.
    """
    refuse_foreign(folder, OWN)
    if print_it:
        pdf.printer()
    started, date = new_run(), datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    parts = compute(request, progress)
    page = case_page.render(request, parts, started.seconds, date)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _put(folder / CASE, request.case.to_toml())
        _put(folder / SUMMARY, json.dumps(summary(parts), indent=1, allow_nan=False, ensure_ascii=False) + "\n")
        _put(folder / PAGE, page)
    except OSError as error:
        raise StoreError(f"cannot write to {folder}: {error.strerror}") from error
    for part in parts:
        if part.dataset is not None:
            save(part.dataset, folder / f"{part.name}.nc")
    if print_it:
        pdf.write_pdf(folder / PAGE, folder / PRINTED)
    return parts, folder / PAGE


def design_report(
    case: Case,
    folder: str | os.PathLike[str] = "report",
    *,
    load: Any = None,
    mass: Any = None,
    error: bool = True,
    print_pdf: bool = False,
) -> Path:
    """Compute what a design review asks about a bearing, and write it as one page with its data.

    Drawing, operating points, lift-off, stiffness and damping, stability, error bars, warnings, inputs and assumptions,
    and what it takes to compute it again.

    Parameters
    ----------
    case : Case
        The bearing.
    folder : str or path
        Where to; it is made if it is not there. An earlier report of a case in it is written anew.
    load : quantity or pair, optional
        Load on the rotor instead of the case's; a single value acts along -y.
    mass : quantity, optional
        Mass of the rotor; by default rotor.mass of the case, else load over gravity.
    error : bool
        Whether results have error bars from a grid study.
    print_pdf : bool
        Whether the page is printed to ``report.pdf``, by a browser or WeasyPrint.

    Returns
    -------
    pathlib.Path
        The page, ``index.html``. A part without a result says why on the page.

    Raises
    ------
    UnitError, UsageError
        An argument cannot be read; a PDF is asked for and nothing on this machine prints; or the folder holds other
        files.
    StoreError
        Something cannot be written.
    """
    request = request_of(case, load=load, mass=mass, error=error)
    return report(request, Path(folder), print_it=print_pdf, progress=_no_progress)[1]


def request_of(case: Case, *, load: Any, mass: Any, error: bool, names: tuple[str, str] = ("load", "mass")) -> Request:
    """A request from numbers or texts; a refusal calls the arguments by `names`."""
    load = None if load is None else LoadVector(help="").named(names[0], load)
    mass = None if mass is None else _MASS.named(names[1], mass)
    return Request(case=case, load=load, mass=mass, error=error)


def summary(parts: tuple[Part, ...]) -> dict[str, Any]:
    """The results of all parts in SI units, as `--json` prints them; or why there are none."""
    return {
        part.name: json.loads(part.answer.to_json()) if part.answer else {"refused": f"{part.refusal}"}
        for part in parts
    }


_MASS = Mass.__metadata__[0]  # type: ignore[attr-defined]


def _put(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _no_progress(part: float, text: str) -> None:
    """Report no progress."""
