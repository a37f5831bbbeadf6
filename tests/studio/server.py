"""A studio in a process of its own, and a browser for it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import urlsplit

import psutil

CHROMIUM = Path("/usr/bin/chromium")
"""Debian's browser; `apt-get install chromium` brings it."""
OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
STARTS, ENDS = 60.0, 15.0
"""Time for a server to start and to end on a machine that others use [s]."""


@dataclass(frozen=True)
class Studio:
    """A server that answers.

    Attributes
    ----------
    process : Popen
        Its process.
    url : str
        Its address with the token.
    """

    process: subprocess.Popen[str]
    url: str

    @property
    def port(self) -> int:
        """Its port."""
        port = urlsplit(self.url).port
        assert port is not None
        return port

    @property
    def token(self) -> str:
        """Its token."""
        found = re.search(r"token=([\w-]+)", self.url)
        assert found is not None
        return found[1]

    @property
    def host(self) -> str:
        """Its address as `Host` names it."""
        return f"127.0.0.1:{self.port}"

    @property
    def cookie(self) -> str:
        """What a browser sends that has opened the page."""
        return f"petalfoil_token_{self.port}={self.token}"

    def get(self, path: str = "/", method: str = "GET", body: bytes = b"", **headers: str) -> tuple[int, str]:
        """Status and text of an answer to a request with the cookie and headers that are given instead."""
        connection = HTTPConnection("127.0.0.1", self.port, timeout=20.0)
        known = {"Host": self.host, "Cookie": self.cookie} | {k.replace("_", "-"): v for k, v in headers.items()}
        connection.request(method, path, body=body or None, headers={k: v for k, v in known.items() if v})
        answer = connection.getresponse()
        text = "" if answer.status == 101 else answer.read().decode(errors="replace")
        connection.close()
        return answer.status, text

    def workers(self) -> list[psutil.Process]:
        """The processes that compute."""
        children = psutil.Process(self.process.pid).children()
        return [child for child in children if any("petalfoil.studio.worker" in part for part in child.cmdline())]


@contextmanager
def running_studio(*arguments: str) -> Iterator[Studio]:
    """A studio that is ended with the block."""
    command = [sys.executable, "-m", "petalfoil", "studio", *arguments, "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        yield Studio(process, process.stdout.readline().strip())
    finally:
        if process.poll() is None:
            process.terminate()
        process.wait(ENDS)
        process.stdout.close()


def why_no_browser() -> str:
    """Why there is no test in a browser; empty where there is."""
    if not CHROMIUM.exists():
        return f"no browser: {CHROMIUM} is missing (apt-get install chromium)"
    return "" if shutil.which(str(CHROMIUM)) else f"{CHROMIUM} cannot be run"


def wait_until(holds: Callable[[], bool], seconds: float) -> bool:
    """Whether something holds within some seconds."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if holds():
            return True
        time.sleep(0.05)
    return holds()
