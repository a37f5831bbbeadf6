"""Where the server is, and the start of a studio: its first worker loads while the server does."""

from __future__ import annotations

import ipaddress
import secrets
import socket
import webbrowser
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from petalfoil.errors import UsageError
from petalfoil.studio.worker_pool import WorkerPool, default_size

LOOPBACK = "127.0.0.1"


@dataclass(frozen=True)
class Address:
    """Where the server is.

    Attributes
    ----------
    host : str
        Address that it listens to.
    port : int
        Its port.
    token : str
        What the first request must know.
    """

    host: str
    port: int
    token: str

    @property
    def url(self) -> str:
        """What is opened in a browser."""
        host = LOOPBACK if self.host == "0.0.0.0" else self.host
        return f"http://{host}:{self.port}/?token={self.token}"

    def names(self) -> list[str]:
        """Names that a browser may know the server by."""
        if not ipaddress.ip_address(self.host).is_unspecified:
            return ["localhost", LOOPBACK, self.host] if self.host == LOOPBACK else [self.host]
        import psutil

        found = [address.address for addresses in psutil.net_if_addrs().values() for address in addresses]
        return ["localhost", socket.gethostname().lower(), *found]


async def run_studio(
    case: Path | None, place: tuple[Address, socket.socket], told: Callable[[str], None], *, browse: bool
) -> None:
    """Start the workers, load the page and serve it until Ctrl-C.

    A worker and the server load for a second or two each, on two cores at the same time.

    Parameters
    ----------
    case : Path or None
        Case that a new page begins with; None for the paper's eight petals.
    place : (Address, socket)
        Where the server is, and the socket that listens there.
    told : callable
        Called with the address when the server answers.
    browse : bool
        Whether to open a browser.

    Raises
    ------
    DefinitionError
        The case is refused.
    """
    engine = WorkerPool(default_size())
    await engine.start()
    try:
        from petalfoil.studio.design import Design
        from petalfoil.studio.server import serve

        design = Design.starting() if case is None else Design.from_file(case)
    except BaseException:
        await engine.stop()
        raise

    def ready(url: str) -> None:
        told(url)
        if browse:
            webbrowser.open(url)

    await serve(engine, design, *place, ready)


def address_of(host: str, port: int, *, to_network: bool) -> tuple[Address, socket.socket]:
    """Where the server will be, and a socket that listens there; port 0 takes a free one.

    Raises
    ------
    UsageError
        The host is not this machine alone and `to_network` is not set; the port is taken.
    """
    try:
        is_loopback = ipaddress.ip_address(host).is_loopback
    except ValueError:
        raise UsageError(
            f"--host: {host!r} is no IP address; allowed: {LOOPBACK}, or an address of this machine"
        ) from None
    if not is_loopback and not to_network:
        raise UsageError(
            f"--host: {host} can be reached by other machines, which then compute on this one, unencrypted: anyone on "
            "the way can read the token. Say --allow-network if that is meant, or forward a port by ssh instead"
        )
    listening = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
    except OSError as error:
        listening.close()
        raise UsageError(
            f"--port: {host}:{port} cannot be used: {error.strerror}; --port 0 takes a free one"
        ) from error
    listening.listen(128)
    return Address(host, listening.getsockname()[1], secrets.token_urlsafe(24)), listening
