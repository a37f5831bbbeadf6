"""Draws the picture of the studio in README and how-to: a thicker petal beside the pinned first design.

python -m tests.studio.picture docs/images/studio.png
"""

from __future__ import annotations

import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from tests.studio.server import CHROMIUM, OPTIONS, running_studio

WAIT = 240_000.0
"""Time for an answer [ms]."""
DONE = "document.querySelector('.status')?.textContent.includes('with error bars')"


def main(target: Path) -> None:
    """Open a page, pin its design, thicken the petals, and keep what is seen."""
    with running_studio() as studio, sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=str(CHROMIUM), args=list(OPTIONS))
        page = browser.new_page(viewport={"width": 1440, "height": 1000})
        page.set_default_timeout(WAIT)
        page.goto(studio.url)
        page.wait_for_function(DONE)
        page.get_by_label("Pin as A").click()
        field = page.locator('[aria-label^="petals.thickness "]')
        field.fill("190 um")
        field.press("Enter")
        page.wait_for_selector(".past tbody tr:nth-child(2)")
        page.wait_for_function(DONE)
        page.mouse.move(700, 5)
        page.wait_for_timeout(1000)
        page.screenshot(path=target)
        browser.close()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m tests.studio.picture PICTURE.png")
    main(Path(sys.argv[1]))
