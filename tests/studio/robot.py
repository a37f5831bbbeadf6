"""A browser without a window: it opens a page, moves a slider or types, and reads the results, as the real one does."""

from __future__ import annotations

import asyncio
import json
import re
import uuid
from typing import Any

import aiohttp
import socketio

from tests.studio.server import Studio

GRID = re.compile(r"cells_per_pitch = (\d+), [\d.]+ s")
CLIENT = re.compile(r"'client_id': '([\w-]+)'")


class Robot:
    """One page of a studio.

    Parameters
    ----------
    studio : Studio
        The server.
    tab : str, optional
        Number of the tab; that of a former robot reloads its page.
    """

    def __init__(self, studio: Studio, tab: str | None = None) -> None:
        self.tab = tab or str(uuid.uuid4())
        self.elements: dict[str, dict[str, Any]] = {}
        self._studio = studio
        self._headers = {"Origin": f"http://{studio.host}", "Cookie": studio.cookie}
        self._socket = socketio.AsyncClient(reconnection=False)
        self._client = ""

    async def open(self) -> None:
        """Open the page."""
        async with aiohttp.ClientSession(headers=self._headers) as web, web.get(f"http://{self._studio.host}/") as page:
            assert page.status == 200
            found = CLIENT.search(await page.text())
        assert found is not None
        self._client = found[1]
        query = {"client_id": self._client, "next_message_id": "0", "implicit_handshake": "true"}
        query |= {"document_id": str(uuid.uuid4()), "tab_id": self.tab}
        self._socket.on("update", self._update)
        self._socket.on("run_javascript", self._answer)
        address = "&".join(f"{name}={value}" for name, value in query.items())
        url = f"http://{self._studio.host}/?{address}"
        await self._socket.connect(
            url, headers=self._headers, transports=["websocket"], socketio_path="/_nicegui_ws/socket.io"
        )

    async def leave(self) -> None:
        """Close the page."""
        await self._socket.disconnect()

    async def type_in(self, path: str, text: str) -> None:
        """Type a value into the field of a key."""
        name, field = next(pair for pair in self.elements.items() if self._label(pair[1]).startswith(f"{path} "))
        await self._emit(name, field, "update:value", text)
        await self._emit(name, field, "keydown", None)

    def results(self) -> dict[str, str]:
        """The present results by name; empty before there are any."""
        for element in self.elements.values():
            rows = element.get("props", {}).get("rows", [])
            if rows and "level" in rows[0]:
                return {row["name"]: row["now"] for row in rows}
        return {}

    def grid(self) -> int:
        """Cells per pitch of the present results; 0 before there are any."""
        notes = (GRID.search(str(element.get("text", ""))) for element in self.elements.values())
        return next((int(note[1]) for note in notes if note is not None), 0)

    @staticmethod
    def _label(element: dict[str, Any]) -> str:
        return str(element.get("props", {}).get("aria-label", ""))

    async def _emit(self, name: str, element: dict[str, Any], event: str, argument: Any) -> None:
        for listener in element["events"]:
            if listener["type"] == event:
                given = {"id": int(name), "client_id": self._client, "listener_id": listener["listener_id"]}
                await self._socket.emit("event", given | {"args": [json.dumps(argument)]})

    async def _update(self, message: dict[str, Any]) -> None:
        for name, element in message.items():
            if isinstance(element, dict):
                self.elements[name] = element

    async def _answer(self, message: dict[str, Any]) -> None:
        if "innerWidth" in message["code"]:
            answer = {"request_id": message["request_id"], "client_id": self._client, "result": [False, 1400]}
            await self._socket.emit("javascript_response", answer)


async def until(holds: Any, seconds: float = 60.0, pause: float = 0.2) -> None:
    """Wait until something holds, with a pause [s] between two looks: twenty robots that look often starve the server.

    Raises
    ------
    TimeoutError
        It does not.
    """
    async with asyncio.timeout(seconds):
        while not holds():
            await asyncio.sleep(pause)
