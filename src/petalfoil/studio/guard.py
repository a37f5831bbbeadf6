"""Who may speak to the server, and how much: checked on every request and every web socket before anything else.

A page of another site that a browser has open can send requests to 127.0.0.1 and open web sockets to it. A name of
another site can be made to point to 127.0.0.1 (DNS rebinding). So `Host` must be an address of the server, `Origin`
must be the server itself, and whoever comes first must know the token that the command line printed. The token stands
in the address once; the answer moves it into a cookie that scripts cannot read and that other sites cannot send.
"""

from __future__ import annotations

import secrets
import time
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

from starlette.types import ASGIApp, Message, Receive, Scope, Send

MOST_BODY = 72 * 1024
"""Size of the largest request [bytes]: a case of 64 kB and what a form adds to it."""
REQUESTS_IN_A_BURST, REQUESTS_A_SECOND = 400, 100
"""Requests of one browser: opening the page takes some 100."""
PAGES_IN_A_BURST, PAGES_A_SECOND = 60, 4
"""Pages of all browsers: each takes memory until it is left."""
MOST_BROWSERS = 256
"""Browsers whose requests are counted; beyond, the one that was silent longest is forgotten."""

HEADERS = {
    "content-security-policy": (
        "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
        "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self'; object-src 'none'; base-uri 'self'; "
        "form-action 'self'; frame-ancestors 'none'"
    ),
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
}
"""What every answer tells the browser: nothing is loaded from, sent to or framed by another site."""


@dataclass
class Bucket:
    """Requests that are still allowed: `burst` at once, `rate` more each second."""

    burst: float
    rate: float
    left: float = field(init=False)
    at: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        """Begin full."""
        self.left = self.burst

    def take(self) -> bool:
        """Whether another request is allowed now."""
        now = time.monotonic()
        self.left = min(self.burst, self.left + self.rate * (now - self.at))
        self.at = now
        if self.left < 1.0:
            return False
        self.left -= 1.0
        return True


@dataclass(frozen=True)
class Refusal:
    """An answer without the application: HTTP status and words."""

    status: int
    words: str


class Guard:
    """An ASGI application in front of another one.

    Parameters
    ----------
    app : ASGI application
        What is guarded.
    token : str
        What the address must hold.
    port : int
        Port of the server, which names its cookies: browsers do not tell ports apart.
    hosts : iterable of str
        Names and addresses of this server, without port.
    """

    def __init__(self, app: ASGIApp, token: str, port: int, hosts: Iterable[str]) -> None:
        self.app = app
        self._token = token
        self._token_cookie, self._browser_cookie = f"petalfoil_token_{port}", f"petalfoil_browser_{port}"
        self._hosts = {f"{host}:{port}" for host in hosts}
        self._origins = {f"http://{host}" for host in self._hosts}
        self._browsers: OrderedDict[str, Bucket] = OrderedDict()
        self._pages = Bucket(PAGES_IN_A_BURST, PAGES_A_SECOND)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or answer it."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        cookies = _cookies(headers.get("cookie", ""))
        refusal = self._refusal(scope, headers, cookies)
        if refusal is not None:
            await _refuse(refusal, scope, send)
        elif scope["type"] == "http" and "token" in _query(scope):
            await self._welcome(scope, send, cookies)
        elif scope["type"] == "http":
            await self.app(scope, _limited(receive), _with_headers(send))
        else:
            await self.app(scope, receive, send)

    def _refusal(self, scope: Scope, headers: Mapping[str, str], cookies: Mapping[str, str]) -> Refusal | None:
        """Why a request is refused; None where it is let through."""
        if headers.get("host", "").lower() not in self._hosts:
            return Refusal(421, "this server has another name: use the address that petalfoil studio printed")
        if not self._is_same_origin(scope, headers):
            return Refusal(403, "requests of other sites are refused")
        if not self._knows_token(scope, cookies):
            return Refusal(403, "open the address that petalfoil studio printed: it holds a token that this one lacks")
        if _size(headers) > MOST_BODY:
            return Refusal(413, f"requests have up to {MOST_BODY:,} bytes")
        return self._too_many(scope, cookies)

    def _is_same_origin(self, scope: Scope, headers: Mapping[str, str]) -> bool:
        """Whether `Origin` is this server; a page that is opened by its address has none, a web socket always one."""
        origin = headers.get("origin")
        if origin is not None:
            return origin.lower() in self._origins
        return scope["type"] == "http" and scope["method"] in ("GET", "HEAD")

    def _knows_token(self, scope: Scope, cookies: Mapping[str, str]) -> bool:
        given = (*_query(scope).get("token", []), cookies.get(self._token_cookie, ""))
        return any(secrets.compare_digest(one.encode(), self._token.encode()) for one in given)

    def _too_many(self, scope: Scope, cookies: Mapping[str, str]) -> Refusal | None:
        """The refusal of a request above the rate of its browser, or of a page above that of all."""
        browser = cookies.get(self._browser_cookie, "")[:64]
        bucket = self._browsers.setdefault(browser, Bucket(REQUESTS_IN_A_BURST, REQUESTS_A_SECOND))
        self._browsers.move_to_end(browser)
        while len(self._browsers) > MOST_BROWSERS:
            self._browsers.popitem(last=False)
        is_page = scope["type"] == "http" and scope["path"] == "/" and "token" not in _query(scope)
        if not bucket.take() or (is_page and not self._pages.take()):
            return Refusal(429, "too many requests: wait a few seconds")
        return None

    async def _welcome(self, scope: Scope, send: Send, cookies: Mapping[str, str]) -> None:
        """Put the token into a cookie, and lead to the address without it."""
        browser = cookies.get(self._browser_cookie) or secrets.token_urlsafe(16)
        known = ((self._token_cookie, self._token), (self._browser_cookie, browser))
        kept = [f"{name}={value}; Path=/; HttpOnly; SameSite=Strict" for name, value in known]
        headers = [(b"location", b"/"), *((b"set-cookie", cookie.encode()) for cookie in kept)]
        await _answer(send, 303, b"", headers)


def _query(scope: Scope) -> dict[str, list[str]]:
    return parse_qs(scope.get("query_string", b"").decode("latin-1"))


def _cookies(header: str) -> dict[str, str]:
    try:
        return {name: morsel.value for name, morsel in SimpleCookie(header).items()}
    except CookieError:
        return {}


def _size(headers: Mapping[str, str]) -> int:
    """Size that a request claims to have; one that is no number is too large."""
    claimed = headers.get("content-length", "0")
    return int(claimed) if claimed.isascii() and claimed.isdigit() and len(claimed) < 12 else MOST_BODY + 1


def _limited(receive: Receive) -> Receive:
    """Receive a body up to its largest size; beyond it, the rest is taken for a connection that broke."""
    received = 0

    async def limited() -> Message:
        nonlocal received
        message = await receive()
        received += len(message.get("body", b""))
        return {"type": "http.disconnect"} if received > MOST_BODY else message

    return limited


def _with_headers(send: Send) -> Send:
    """Add the headers of every answer."""

    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            ours = [(name.encode(), value.encode()) for name, value in HEADERS.items()]
            theirs = [pair for pair in message.get("headers", []) if pair[0].decode("latin-1").lower() not in HEADERS]
            message = {**message, "headers": [*theirs, *ours]}
        await send(message)

    return sent


async def _refuse(refusal: Refusal, scope: Scope, send: Send) -> None:
    """Answer a request without the application; a web socket is closed before it opens."""
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": refusal.words[:120]})
        return
    await _answer(send, refusal.status, refusal.words.encode(), [(b"content-type", b"text/plain; charset=utf-8")])


async def _answer(send: Send, status: int, body: bytes, headers: list[tuple[bytes, bytes]]) -> None:
    start: dict[str, Any] = {"type": "http.response.start", "status": status, "headers": headers}
    await _with_headers(send)(start)
    await send({"type": "http.response.body", "body": body})
