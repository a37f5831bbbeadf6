"""Measures how soon the studio answers: after its start, and after a change of the thickness.

python -m tests.studio.latency [--changes N]

All times are on the wall clock. Those of server and solver are measured by a browser without a window, which draws
nothing; those of Chromium, which draws by software, come after them. Run it on a machine that does nothing else: the
load before it began is printed.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import time
from statistics import median
from typing import Any

from playwright.sync_api import Page, sync_playwright

from tests.studio.robot import Robot, until
from tests.studio.server import CHROMIUM, OPTIONS, Studio, running_studio

WAIT = 120.0
"""Time for an answer on a machine that others use [s]."""
LOOK = 0.01
"""Time between two looks whether an answer is there [s]."""
REST = 0.5
"""Time between two changes [s]."""
FINISHED = "document.querySelector('.status')?.textContent.includes('with error bars')"
WATCH = """
() => {
  const note = name => { window.seen[name] ??= performance.now(); };
  const notes = () => [...document.querySelectorAll('.numbers .grid-note')].map(one => one.textContent).join();
  window.seen = {};
  addEventListener('keydown', () => { window.seen = {change: performance.now()}; }, true);
  new MutationObserver(() => {
    if (notes().includes('= 32')) note('coarse numbers');
    else if (window.seen['coarse numbers']) note('numbers on 128 cells');
  }).observe(document.querySelector('.numbers'), {subtree: true, childList: true, characterData: true});
  document.querySelector('.section-chart .js-plotly-plot').on('plotly_afterplot', () => {
    if (window.seen['coarse numbers']) note('coarse picture');
    if (window.seen['numbers on 128 cells']) note('picture on 128 cells');
  });
}
"""
"""Notes when a slider is moved, when the numbers change, and when the cross-section has been drawn after them."""

Times = dict[str, float]


def first_answer(begin: float, studio: Studio) -> Times:
    """Start to first answer [s], without drawing."""

    async def first() -> Times:
        printed = time.monotonic() - begin
        robot = Robot(studio)
        await robot.open()
        await until(robot.results, WAIT, LOOK)
        found = {"address printed": printed, "first answer": time.monotonic() - begin}
        await robot.leave()
        return found

    return asyncio.run(first())


def answers(studio: Studio, changes: int) -> list[Times]:
    """A typed thickness to the coarse answer and the one on 128 cells [s], without drawing."""

    async def change(robot: Robot, thickness: float) -> Times:
        before, begin = robot.results(), time.monotonic()
        await robot.type_in("petals.thickness", f"{thickness} um")
        await until(lambda: robot.results() != before and robot.grid() == 32, WAIT, LOOK)
        coarse = time.monotonic() - begin
        await until(lambda: robot.grid() == 128, WAIT, LOOK)
        return {"coarse answer": coarse, "answer on 128 cells": time.monotonic() - begin}

    async def all_of_them() -> list[Times]:
        robot = Robot(studio)
        await robot.open()
        await until(lambda: robot.grid() == 128, WAIT)
        found = []
        for k in range(changes):
            await asyncio.sleep(REST)
            found.append(await change(robot, 177.0 + k))
        await robot.leave()
        return found

    return asyncio.run(all_of_them())


def first_drawn(begin: float, page: Page, studio: Studio) -> Times:
    """Start to first numbers and picture [s] in Chromium."""
    printed = time.monotonic() - begin
    page.goto(studio.url)
    page.wait_for_selector(".numbers tbody tr")
    numbers = time.monotonic() - begin
    page.wait_for_selector(".section-chart .main-svg .scatterlayer .trace")
    return {"address printed": printed, "first numbers shown": numbers, "first picture drawn": time.monotonic() - begin}


def drawn(page: Page, changes: int) -> list[Times]:
    """A step of the slider to numbers and pictures [s] in Chromium."""
    page.wait_for_function(FINISHED)
    page.evaluate(WATCH)
    found = []
    for _ in range(changes):
        page.wait_for_timeout(1e3 * REST)
        page.get_by_label("slide petals.thickness", exact=True).locator("[tabindex]").focus()
        page.keyboard.press("ArrowRight")
        page.wait_for_function("window.seen['picture on 128 cells']")
        seen: Times = page.evaluate("window.seen")
        found.append({name: 1e-3 * (at - seen["change"]) for name, at in seen.items() if name != "change"})
    return found


def show(title: str, found: list[Times]) -> None:
    """Print medians and the largest values of times."""
    print(title)
    for name in found[0]:
        values = [one[name] for one in found]
        print(f"  {name:24} {median(values):6.2f} s, at most {max(values):.2f} s of {len(values)}")


def main(options: Any) -> None:
    """Measure and print."""
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    begin = time.monotonic()
    with running_studio() as studio:
        show("after the start, server and solver", [first_answer(begin, studio)])
        show("after a change, server and solver", answers(studio, options.changes))
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=str(CHROMIUM), args=list(OPTIONS))
        page = browser.new_page(viewport={"width": 1440, "height": 1000})
        page.set_default_timeout(1e3 * WAIT)
        begin = time.monotonic()
        with running_studio() as studio:
            show("after the start, in Chromium", [first_drawn(begin, page, studio)])
            show("after a step of the slider, in Chromium", drawn(page, options.changes))
        browser.close()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--changes", type=int, default=15, help="how often the thickness is changed")
    main(parser.parse_args())
