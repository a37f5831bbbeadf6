"""``petalfoil studio``: the page on which a bearing is changed and answers."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from petalfoil.cli.failures import handled
from petalfoil.cli.streams import emit, say
from petalfoil.errors import UsageError

CaseFile = Annotated[Path | None, typer.Argument(metavar="[CASE]", help="Case to begin with, a TOML file.")]
Port = Annotated[int, typer.Option(min=0, max=65535, help="Port of the page; 0 takes a free one.")]
NoBrowser = Annotated[bool, typer.Option("--no-browser", help="Print the address and open no browser.")]
Host = Annotated[str, typer.Option(metavar="ADDRESS", help="Address to listen to; needs --allow-network.")]
AllowNetwork = Annotated[
    bool,
    typer.Option("--allow-network", help="Let other machines use the page: unencrypted, by whoever has the token."),
]


def studio(
    case: CaseFile = None,
    port: Port = 0,
    no_browser: NoBrowser = False,
    host: Host = "127.0.0.1",
    allow_network: AllowNetwork = False,
) -> None:
    """Open a local web page: change a bearing, and see its results.

    Prints the address, which holds a token, on standard output. The page
    is served to this machine alone and loads nothing from elsewhere.
    Ctrl-C ends it. Needs the extra "studio" of petalfoil.

    Example: petalfoil studio case.toml
    """
    with handled():
        if find_spec("nicegui") is None:
            raise UsageError("the studio needs NiceGUI and Plotly: pip install 'petalfoil[studio]'")
        import asyncio

        from petalfoil.studio.address import address_of, run_studio

        place = address_of(host, port, to_network=allow_network)
        try:
            asyncio.run(run_studio(case, place, lambda url: emit(f"{url}\n"), browse=not no_browser))
        except KeyboardInterrupt:  # the usual end: Ctrl-C, or the signal of a service manager
            say("the studio is closed")
