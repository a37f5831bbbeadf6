"""What another site, another program or a hostile case may try is refused, and the server answers others on."""

from __future__ import annotations

import re
import socket
import threading
from collections import Counter
from collections.abc import Iterator

import pytest

from petalfoil.studio.guard import REQUESTS_IN_A_BURST
from tests.studio.server import Studio, running_studio

pytestmark = pytest.mark.slow
pytest.importorskip("nicegui")

SOCKET = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket"


@pytest.fixture(scope="module")
def studio() -> Iterator[Studio]:
    with running_studio() as server:
        yield server


def opens(studio: Studio, **headers: str) -> bool:
    """Whether a web socket opens with these headers instead of a browser's own."""
    known = {"Origin": f"http://{studio.host}", "Connection": "Upgrade", "Upgrade": "websocket"}
    key = {"Sec_WebSocket_Version": "13", "Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ=="}
    status, _ = studio.get(SOCKET, **known | key | headers)
    assert status in (101, 403)
    return status == 101


def test_the_browser_itself_is_let_through(studio: Studio) -> None:
    status, page = studio.get()
    assert (status, "petalfoil studio" in page) == (200, True)
    assert opens(studio)


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "localhost.evil.example", "127.0.0.1:1"])
def test_a_foreign_host_is_refused_on_both_channels(studio: Studio, host: str) -> None:
    assert studio.get(Host=host)[0] == 421
    assert not opens(studio, Host=host)


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1", "file://"])
def test_a_foreign_origin_is_refused_on_both_channels(studio: Studio, origin: str) -> None:
    assert studio.get(Origin=origin)[0] == 403
    assert not opens(studio, Origin=origin)


@pytest.mark.parametrize("cookie", ["", "petalfoil_token=x", "a=b; c"])
def test_without_the_token_nothing_is_told(studio: Studio, cookie: str) -> None:
    status, words = studio.get(Cookie=cookie)
    assert (status, studio.token in words, "Eight petals" in words) == (403, False, False)
    assert not opens(studio, Cookie=cookie)


@pytest.mark.parametrize(
    "path",
    [
        "/../../etc/passwd",
        "/_nicegui/3.18.0/static/../../../../etc/passwd",
        "/_nicegui/3.18.0/static/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
        "/_nicegui/3.18.0/libraries/..%2f..%2fetc%2fpasswd",
        "/_nicegui/3.18.0/resources/x/../../../../etc/passwd",
        "//etc/passwd",
        "/docs",
        "/openapi.json",
    ],
)
def test_no_path_leads_out_of_the_assets(studio: Studio, path: str) -> None:
    status, text = studio.get(path)
    assert status in (403, 404)
    assert "root:" not in text


def test_a_large_upload_is_refused(studio: Studio) -> None:
    origin = f"http://{studio.host}"
    try:
        status = studio.get("/_nicegui/client/x/upload/1", "POST", b"x" * 10 * 2**20, Origin=origin)[0]
    except (BrokenPipeError, ConnectionResetError):
        status = 413  # the server hangs up while the rest is still being sent
    assert status == 413
    assert studio.get()[0] == 200


def flood(studio: Studio, count: int, cookie: str) -> Counter[int]:
    """Status of requests that are sent at once, without waiting for the answer before."""
    lines = f"GET /favicon.ico HTTP/1.1\r\nHost: {studio.host}\r\nCookie: {cookie}\r\n"
    asked = (count - 1) * f"{lines}\r\n" + f"{lines}Connection: close\r\n\r\n"
    with socket.create_connection(("127.0.0.1", studio.port), timeout=60.0) as connection:
        sending = threading.Thread(target=connection.sendall, args=(asked.encode(),))
        sending.start()
        text = b"".join(iter(lambda: connection.recv(65536), b""))
        sending.join()
    return Counter(int(status) for status in re.findall(rb"HTTP/1\.1 (\d{3})", text))


def test_a_thousand_requests_a_second_are_answered_briefly(studio: Studio) -> None:
    assert flood(studio, 1000, "none") == {403: 1000}
    codes = flood(studio, 2000, f"{studio.cookie}; petalfoil_browser_{studio.port}=noisy")
    assert codes[429] > 0
    assert codes[200] >= REQUESTS_IN_A_BURST
    assert sum(codes.values()) == 2000
    quiet = f"{studio.cookie}; petalfoil_browser_{studio.port}=quiet"
    assert studio.get(Cookie=quiet)[0] == 200
