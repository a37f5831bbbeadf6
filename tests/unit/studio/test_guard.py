"""Whoever does not know the token, comes from another site, or sends too much is answered without the application."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from petalfoil.studio.guard import MOST_BODY, PAGES_IN_A_BURST, REQUESTS_IN_A_BURST, Guard

PORT, TOKEN, HOST = 8123, "secret", "127.0.0.1:8123"
COOKIE = f"petalfoil_token_{PORT}={TOKEN}"


class Application:
    """Counts what reaches it, and reads what it is sent."""

    def __init__(self) -> None:
        self.reached: list[str] = []
        self.read = 0

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        self.reached.append(scope["type"])
        if scope["type"] == "websocket":
            await send({"type": "websocket.accept"})
            return
        while (message := await receive())["type"] == "http.request":
            self.read += len(message["body"])
            if not message.get("more_body"):
                break
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"page"})


def guarded() -> tuple[Guard, Application]:
    application = Application()
    return Guard(application, TOKEN, PORT, ["127.0.0.1", "localhost"]), application


def ask(guard: Guard, kind: str = "http", path: str = "/", query: str = "", **given: Any) -> list[dict[str, Any]]:
    """What the guard sends for a request; `body` is a list of pieces."""
    headers = {"host": HOST, "cookie": COOKIE, **given.get("headers", {})}
    scope = {
        "type": kind,
        "method": given.get("method", "GET"),
        "path": path,
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in headers.items() if value is not None],
    }
    pieces = list(given.get("body", [b""]))
    sent: list[dict[str, Any]] = []

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": pieces.pop(0), "more_body": bool(pieces)}

    async def send(message: Any) -> None:
        sent.append(message)

    asyncio.run(guard(scope, receive, send))
    return sent


def test_the_browser_that_knows_the_token_is_let_through_on_both_channels() -> None:
    guard, application = guarded()
    assert ask(guard)[0]["status"] == 200
    assert ask(guard, "websocket", headers={"origin": f"http://{HOST}"})[0]["type"] == "websocket.accept"
    assert application.reached == ["http", "websocket"]


@pytest.mark.parametrize("kind", ["http", "websocket"])
@pytest.mark.parametrize(
    "headers",
    [
        {"host": "evil.example:8123"},
        {"host": "127.0.0.1:9999"},
        {"host": "127.0.0.1"},
        {"host": None},
        {"origin": "http://evil.example"},
        {"origin": "https://127.0.0.1:8123"},
        {"origin": "http://127.0.0.1:9999"},
        {"origin": "null"},
        {"cookie": None},
        {"cookie": f"petalfoil_token_{PORT}=wrong"},
        {"cookie": "petalfoil_token_9999=secret"},
    ],
)
def test_foreign_hosts_origins_and_tokens_are_refused(kind: str, headers: dict[str, Any]) -> None:
    guard, application = guarded()
    own = {"origin": f"http://{HOST}"} if kind == "websocket" else {}
    (first, *_) = ask(guard, kind, headers=own | headers)
    if kind == "websocket":
        assert (first["type"], first["code"]) == ("websocket.close", 1008)
    else:
        assert first["status"] in (403, 421)
    assert application.reached == []


def test_a_web_socket_or_a_form_without_an_origin_is_refused() -> None:
    guard, application = guarded()
    assert ask(guard, "websocket")[0]["type"] == "websocket.close"
    assert ask(guard, method="POST")[0]["status"] == 403
    assert application.reached == []


def test_the_token_moves_from_the_address_into_a_cookie_that_scripts_cannot_read() -> None:
    guard, application = guarded()
    start = ask(guard, query=f"token={TOKEN}", headers={"cookie": None})[0]
    headers = [(name.decode(), value.decode()) for name, value in start["headers"]]
    cookies = [value for name, value in headers if name == "set-cookie"]
    assert start["status"] == 303
    assert ("location", "/") in headers
    assert any(cookie.startswith(f"{COOKIE};") for cookie in cookies)
    assert all("HttpOnly" in cookie and "SameSite=Strict" in cookie for cookie in cookies)
    assert application.reached == []
    assert ask(guard, query="token=wrong", headers={"cookie": None})[0]["status"] == 403


@pytest.mark.parametrize("claimed", [str(10 * 2**20), "-1", "1e9", "9" * 20])
def test_a_large_body_is_refused_by_what_it_claims(claimed: str) -> None:
    guard, application = guarded()
    headers = {"origin": f"http://{HOST}", "content-length": claimed}
    assert ask(guard, method="POST", headers=headers)[0]["status"] == 413
    assert application.reached == []


def test_a_large_body_without_a_claim_is_cut_off() -> None:
    guard, application = guarded()
    body = [b"x" * 16384] * 640
    ask(guard, method="POST", headers={"origin": f"http://{HOST}"}, body=body)
    assert 0 < application.read <= MOST_BODY


def test_a_browser_that_asks_too_often_waits_while_another_is_served() -> None:
    guard, _ = guarded()
    noisy = {"cookie": f"{COOKIE}; petalfoil_browser_{PORT}=noisy"}
    codes = [ask(guard, path="/x", headers=noisy)[0]["status"] for _ in range(REQUESTS_IN_A_BURST + 200)]
    assert codes[:REQUESTS_IN_A_BURST] == [200] * REQUESTS_IN_A_BURST
    assert 429 in codes
    quiet = {"cookie": f"{COOKIE}; petalfoil_browser_{PORT}=quiet"}
    assert ask(guard, path="/x", headers=quiet)[0]["status"] == 200


def test_pages_are_counted_over_all_browsers() -> None:
    guard, _ = guarded()
    codes = [
        ask(guard, headers={"cookie": f"{COOKIE}; petalfoil_browser_{PORT}={number}"})[0]["status"]
        for number in range(PAGES_IN_A_BURST + 20)
    ]
    assert codes[:PAGES_IN_A_BURST] == [200] * PAGES_IN_A_BURST
    assert 429 in codes


def test_every_answer_forbids_other_sites() -> None:
    guard, _ = guarded()
    for start in (ask(guard)[0], ask(guard, headers={"cookie": None})[0]):
        headers = {name.decode(): value.decode() for name, value in start["headers"]}
        assert "default-src 'self'" in headers["content-security-policy"]
        assert headers["x-frame-options"] == "DENY"
        assert headers["referrer-policy"] == "no-referrer"
