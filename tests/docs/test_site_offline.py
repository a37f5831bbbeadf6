"""The built site: no warning, no dead link, and no request to another server when a browser loads every page."""

from __future__ import annotations

import fcntl
import functools
import http.server
import importlib
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
import xarray as xr

from tests.docs.site import GALLERY
from tests.docs.texts import DOCS, ROOT

pytestmark = pytest.mark.slow

pytest.importorskip("sphinx", reason="needs petalfoil[docs]")
playwright = pytest.importorskip("playwright.sync_api", reason="needs petalfoil[docs]")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
QUIET = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"]
QUIET += ["--disable-component-update", "--disable-sync"]
CUT = ["--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"]
"""No other server has an address. A handler of requests would do the same, but then a browser keeps no file."""
PATIENCE = 120_000.0
"""Time that a page may take on a machine that others use [ms]: that of the theory takes 14 s of processor time."""


class Page(HTMLParser):
    """Anchors and links of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect what a tag names and where it leads."""
        given = dict(attrs)
        self.anchors |= {value for name in ("id", "name") if (value := given.get(name))}
        self.links += [value for name in ("href", "src") if (value := given.get(name))]


@pytest.fixture(scope="module")
def site() -> Path:
    """The site, built where `make docs` builds it: what that has made is brought up to date, one worker at a time."""
    build = ROOT / "build"
    build.mkdir(exist_ok=True)
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-d", str(build / "doctrees")]
    with (build / "docs.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        built = subprocess.run([*command, str(DOCS), str(build / "docs")], capture_output=True, text=True, cwd=ROOT)
    assert built.returncode == 0, built.stderr
    return build / "docs"


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    """The pages of the site."""
    written = [path for path in sorted(site.rglob("*.html")) if "_static" not in path.parts]
    return {path: Page(path.read_text(encoding="utf-8")) for path in written}


@pytest.fixture
def address(site: Path) -> Iterator[str]:
    """Address of the site on a server of this machine."""
    handler = functools.partial(Silent, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()


class Silent(http.server.SimpleHTTPRequestHandler):
    """A server of files that writes no log, and whose files a browser may keep."""

    protocol_version = "HTTP/1.1"

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""

    def end_headers(self) -> None:
        """Let scripts and styles be asked for once."""
        self.send_header("Cache-Control", "max-age=3600")
        super().end_headers()


def test_all_links_inside_the_site_resolve(pages: dict[Path, Page]) -> None:
    assert len(pages) > 50
    lost = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            anchors = pages[target].anchors if target in pages else None
            if not target.exists() or (parts.fragment and anchors is not None and parts.fragment not in anchors):
                lost.append((path.name, link))
    assert lost == []


def test_the_search_knows_keys_and_commands(site: Path) -> None:
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert "bend_radius" in index
    assert "liftoff" in index


@pytest.mark.parametrize("script", GALLERY, ids=lambda path: path.stem)
def test_a_script_of_the_gallery_shows_a_figure_and_its_result(script: Path, site: Path) -> None:
    """The build runs the script; it ends where the result did not converge."""
    page = (site / "gallery" / f"{script.stem}.html").read_text(encoding="utf-8")
    assert f"sphx_glr_{script.stem}_001.png" in page
    assert re.search(r"^result = ", script.read_text(encoding="utf-8"), re.MULTILINE)


def test_a_result_that_did_not_converge_ends_the_build(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    gallery, failed = importlib.import_module("gallery"), xr.Dataset({"converged": ((), False)})
    block = {"example_globals": {"result": failed}, "src_file": "plot_solve.py", "image_path_iterator": iter(())}
    with pytest.raises(ValueError, match="plot_solve"):
        gallery.scraper(None, block, {"src_dir": str(DOCS)})


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_no_page_asks_another_server_and_no_script_fails(address: str, site: Path, pages: dict[Path, Page]) -> None:
    requests: list[str] = []
    problems: list[str] = []
    with playwright.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=[*QUIET, *CUT])
        tab = browser.new_page()
        tab.set_default_timeout(PATIENCE)
        tab.on("request", lambda asked: requests.append(asked.url))
        tab.on("pageerror", lambda error: problems.append(f"{tab.url}: {error}"))
        tab.on("response", lambda got: problems.append(f"{got.status}: {got.url}") if got.status >= 400 else None)
        for path in [path for path in pages if path != site / "theory.html"]:
            tab.goto(f"{address}/{path.relative_to(site).as_posix()}", wait_until="load")
        tab.goto(f"{address}/theory.html", wait_until="load")
        tab.wait_for_selector("mjx-container svg")
        formulas = tab.locator("mjx-container").count()
        broken = tab.locator("mjx-container [data-mml-node='merror']").count()
        tab.goto(f"{address}/search.html?q=bend_radius", wait_until="load")
        tab.wait_for_selector("#search-results li a")
        found = {link.get_attribute("href") for link in tab.locator("#search-results li a").all()}
        browser.close()
    outside = [url for url in requests if not url.startswith((address, "data:", "blob:"))]
    assert (outside, problems) == ([], [])
    assert len(requests) > len(pages)
    assert "reference/case-file.html" in {str(link).partition("#")[0].partition("?")[0] for link in found}
    assert formulas > 100
    assert broken == 0
