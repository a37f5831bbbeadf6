"""``petalfoil docs``: the documentation in a browser."""

from __future__ import annotations

import webbrowser
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Annotated

import typer

import petalfoil
from petalfoil.cli.failures import handled
from petalfoil.cli.streams import emit, say
from petalfoil.errors import UsageError

PACKAGE = Path(petalfoil.__file__).parent
SITES = (PACKAGE / "site", PACKAGE.parents[1] / "build" / "docs")
"""Where the pages may be: in an installed wheel that carries them, or beside the sources, where `make docs` builds."""
LABEL = "Documentation"
"""Label under which the project names the address of its documentation."""


def docs(
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Print the address and open no browser.")] = False,
) -> None:
    """Open the documentation in a browser, and print its address.

    The pages that came with the installation, or those that "make docs"
    built in a copy of the sources; they need no network. Otherwise the
    address that the project names.

    Example: petalfoil docs
    """
    with handled():
        address = address_of_docs()
        emit(f"{address}\n")
        if not no_browser and not webbrowser.open(address):
            say("no browser could be started: open the address in one")


def address_of_docs() -> str:
    """Address of the first page.

    Raises
    ------
    UsageError
        There are neither pages nor an address.
    """
    for site in SITES:
        if (page := site / "index.html").is_file():
            return page.as_uri()
    try:
        urls = metadata("petalfoil").get_all("Project-URL", [])
    except PackageNotFoundError:  # run from sources that are not installed
        urls = []
    for url in urls:
        label, _, address = url.partition(", ")
        if label == LABEL:
            return str(address)
    raise UsageError(
        "this installation came without the pages of the documentation, and the project names no address of them. In a "
        "copy of the sources, 'make docs' builds them in build/docs; 'petalfoil docs' opens them there"
    )
