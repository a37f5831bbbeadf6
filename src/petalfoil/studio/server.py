"""The server: guard, page, workers and the sessions of the tabs that are open."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable
from typing import Any

import uvicorn
from fastapi import FastAPI
from nicegui import __version__ as nicegui_version
from nicegui import app as nicegui_app
from nicegui import ui
from nicegui.dependencies import esm_modules

from petalfoil.studio.address import Address
from petalfoil.studio.design import Design
from petalfoil.studio.guard import Guard
from petalfoil.studio.page import Page
from petalfoil.studio.page_session import Session
from petalfoil.studio.tasks import warm_up
from petalfoil.studio.worker_pool import WorkerPool

MOST_SESSIONS = 64
"""Tabs whose state is kept; beyond, the one that was left longest ago is forgotten."""
CONNECT = 20.0
"""Time that a browser has to open its web socket after it asked for the page [s]."""
LARGEST_MESSAGE = 256 * 1024
"""Largest message of a browser on the web socket [bytes]: a long text in a field."""
RECONNECT = 20.0
"""Time after which a page whose connection broke is taken for left [s]: a busy machine may answer late."""
FROZEN = 40.0
"""Time that a browser may be silent while it draws until its connection is closed, and with it what it says next is
lost [s]: a 3-D view drawn by software on a busy machine took 13."""
PART_OF_RECONNECT = 0.4
"""NiceGUI's share of the time to reconnect, as an application has it, that is given to a silent browser."""
RESENT = 30
"""Messages that are kept for a connection that breaks: a picture has 100 kB, and a page that missed more reloads."""
WIDE = 900
"""Width of a window above which the case stands beside the pictures [px]."""
LOOK = "[matchMedia('(prefers-color-scheme: dark)').matches, innerWidth]"
"""What the browser is asked for: whether its user prefers a dark page, and the width of its window."""
CHARTS = "nicegui-plotly"
"""Name of the script that draws the charts, 4.6 MB."""
KEY = "petalfoil_session"
"""Name under which a tab keeps the key of its session and its own number, which a copy of the tab does not have."""


class Sessions:
    """The sessions by key; a tab that is reloaded finds its own again.

    Parameters
    ----------
    engine : WorkerPool
        Who computes.
    design : Design
        What a new session begins with.

    Attributes
    ----------
    building : Lock
        Held while a page is built. Pages that open at once are built one after the other: between two parts of one of
        them the others are kept alive, and a busy machine would otherwise let all of them time out.
    """

    def __init__(self, engine: WorkerPool, design: Design) -> None:
        self._engine, self._design = engine, design
        self.building = asyncio.Lock()
        self._sessions: OrderedDict[str, Session] = OrderedDict()

    def open(self, key: str | None, *, is_copy: bool = False) -> Session | None:
        """The session of a key, or a new one, with the same design where a tab was copied.

        None where too many pages are open.
        """
        known = self._sessions.get(key or "")
        if known is not None and not is_copy:
            self._sessions.move_to_end(known.key)
            return known
        if len(self._sessions) >= MOST_SESSIONS and not self._forget_one():
            return None
        session = Session(self._engine, self._design if known is None else known.design)
        self._sessions[session.key] = session
        return session

    def leave(self, session: Session, page: Page) -> None:
        """A page is gone: nothing is computed for it any more, but its state is kept for a while."""
        if session.listener == page.changed:
            session.listener = None
            self._engine.leave(session.key)

    def _forget_one(self) -> bool:
        left = next((session for session in self._sessions.values() if session.listener is None), None)
        if left is not None:
            del self._sessions[left.key]
        return left is not None


async def serve(
    engine: WorkerPool, design: Design, address: Address, listening: socket.socket, told: Callable[[str], None]
) -> None:
    """Serve the page until Ctrl-C, and end the workers.

    Parameters
    ----------
    engine : WorkerPool
        Workers that have been started.
    design : Design
        The case that a new page begins with.
    address : Address
        Where the server is.
    listening : socket
        Socket that listens there.
    told : callable
        Called with the address when the server answers.
    """

    @contextlib.asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        told(address.url)
        loading = asyncio.get_running_loop().run_in_executor(None, warm_up)  # while the browser loads the page
        yield
        await loading
        await engine.stop()

    application = _application(lifespan, Sessions(engine, design))
    guarded = Guard(application, address.token, address.port, address.names())
    config = uvicorn.Config(
        guarded,
        log_level="warning",
        access_log=False,
        server_header=False,
        lifespan="on",
        ws_max_size=LARGEST_MESSAGE,
        timeout_graceful_shutdown=2,
    )
    await uvicorn.Server(config).serve(sockets=[listening])


def _application(lifespan: Any, sessions: Sessions) -> FastAPI:
    """The application behind the guard."""
    application = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, openapi_url=None)

    @ui.page("/", title="petalfoil studio", reconnect_timeout=RECONNECT)
    async def index() -> None:
        ui.add_head_html(f'<link rel="modulepreload" href="{charts_script()}">')
        await show(sessions)

    ui.run_with(
        application,
        title="petalfoil studio",
        favicon="🌸",
        dark=None,
        tailwind=False,
        show_welcome_message=False,
        reconnect_timeout=FROZEN / PART_OF_RECONNECT,
        message_history_length=RESENT,
        binding_refresh_interval=None,
    )
    return application


def charts_script() -> str:
    """Address of the script that draws the charts: a browser that knows it loads it while the page is built."""
    key = next(key for key, module in esm_modules.items() if module.name == CHARTS)
    return f"/_nicegui/{nicegui_version}/esm/{key}/index.js"


async def show(sessions: Sessions) -> None:
    """Build the page in a browser that has just connected."""
    client = ui.context.client
    await client.connected(timeout=CONNECT)
    tab = nicegui_app.storage.tab
    key, of_tab = tab.get(KEY, (None, None))
    session = sessions.open(key, is_copy=of_tab != client.tab_id)
    if session is None:
        ui.label(f"{MOST_SESSIONS} pages are open: close one of them, and load this one again")
        return
    is_dark, width = await ui.run_javascript(LOOK, timeout=CONNECT)
    if session.key != key:
        tab[KEY] = (session.key, client.tab_id)
        session.is_dark = bool(is_dark)
    page = Page(session, is_wide=width > WIDE)
    session.go_on()  # the first answer is computed while the page is built
    async with sessions.building:
        await page.build()
    session.listener = page.changed
    client.on_delete(lambda: sessions.leave(session, page))
