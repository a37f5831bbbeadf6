"""A page as PDF, printed by a browser of the machine or by WeasyPrint."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from importlib.util import find_spec
from pathlib import Path

from petalfoil.errors import StoreError, UsageError
from petalfoil.results.atomic import replacing

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
"""Programs that print a page without a window."""

PRINT_TIME = 120.0
"""A browser that has not printed a page without scripts after this time never will [s]."""

FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--no-pdf-header-footer",
         "--disable-background-networking", "--disable-component-update", "--disable-sync")  # fmt: skip
"""Print and do nothing else: above all, ask no server for anything."""


def printer() -> str:
    """What prints here: path of a browser, or ``"weasyprint"``.

    Raises
    ------
    UsageError
        There is neither.
    """
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is not None:
        return found
    if find_spec("weasyprint") is not None:
        return "weasyprint"
    raise UsageError(
        f"a PDF needs a browser ({', '.join(BROWSERS[:3])}) or WeasyPrint (pip install 'petalfoil[pdf]'); there is "
        "neither. Leave --pdf out and print the page from any browser"
    )


def write_pdf(page: Path, target: Path) -> None:
    """Print a page.

    Parameters
    ----------
    page : Path
        The HTML file.
    target : Path
        The PDF file.

    Raises
    ------
    UsageError
        Nothing on this machine prints.
    StoreError
        The page was not printed.
    """
    program = printer()
    with replacing(target) as temporary:
        if program == "weasyprint":
            from weasyprint import HTML

            HTML(filename=str(page)).write_pdf(str(temporary))
        else:
            _print_by_browser(program, page, temporary)


def _print_by_browser(program: str, page: Path, target: Path) -> None:
    with tempfile.TemporaryDirectory() as profile:
        options = [*FLAGS, f"--user-data-dir={profile}", f"--print-to-pdf={target}", page.resolve().as_uri()]
        try:
            done = subprocess.run([program, *options], capture_output=True, text=True, timeout=PRINT_TIME, check=False)
        except subprocess.TimeoutExpired as error:
            raise StoreError(f"{program} did not print {page} within {PRINT_TIME:.0f} s") from error
    if done.returncode != 0 or not target.is_file():
        said = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise StoreError(f"{program} did not print {page}: {said}")
