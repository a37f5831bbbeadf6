"""The page in Debian's Chromium: it shows what the command line prints, without an error or a request outside."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from petalfoil.analysis import known_verbs
from petalfoil.case import Case
from petalfoil.results.tables import tables_of
from tests.studio.server import CHROMIUM, OPTIONS, Studio, running_studio, why_no_browser

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(bool(why_no_browser()), reason=why_no_browser() or "there is a browser"),
]
playwright = pytest.importorskip("playwright.sync_api")
Browser = playwright.Browser
Page, Locator = playwright.Page, playwright.Locator

PATIENCE = 60_000.0
"""Time for an answer on a machine that others use [ms]."""
NOT_OF_THE_STATE = {"time"}
"""Results that differ from run to run."""


@pytest.fixture(scope="module")
def studio() -> Iterator[Studio]:
    with running_studio() as server:
        yield server


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=str(CHROMIUM), args=list(OPTIONS))
        yield running
        running.close()


@pytest.fixture
def page(studio: Studio, browser: Browser) -> Iterator[Page]:
    """A page of its own; afterwards nothing was logged as an error, and nothing was asked of another server."""
    context = browser.new_context(viewport={"width": 1440, "height": 1000}, accept_downloads=True)
    shown = context.new_page()
    errors: list[str] = []
    shown.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    shown.on("pageerror", lambda error: errors.append(str(error)))
    outside: list[str] = []
    own = (f"http://{studio.host}/", f"ws://{studio.host}/", "data:", "blob:")
    shown.on("request", lambda request: None if request.url.startswith(own) else outside.append(request.url))
    shown.set_default_timeout(PATIENCE)
    shown.goto(studio.url)
    answered(shown)
    yield shown
    context.close()
    assert (errors, outside) == ([], [])


def answered(page: Page, words: str = "converged in") -> None:
    """Wait until the header says that an answer is there."""
    page.wait_for_function("words => document.querySelector('.status')?.textContent.includes(words)", arg=words)


def numbers(page: Page) -> dict[str, dict[str, str]]:
    """Results by label: their cells by the heading of the column."""
    read = "all => all.map(row => [...row.querySelectorAll('th, td')].map(cell => cell.textContent.trim()))"
    headings, *lines = page.eval_on_selector_all(".numbers tr", read)
    return {cells[0]: dict(zip(headings, cells, strict=True)) for cells in lines}


def drag(page: Page, name: str, part: float) -> None:
    """Drag a slider by a part of its length, in steps as a hand does."""
    box = page.get_by_label(f"slide {name}", exact=True).bounding_box()
    assert box is not None
    share = 0.43  # where a slider from a quarter to twice its value begins
    y = box["y"] + 0.5 * box["height"]
    page.mouse.move(box["x"] + share * box["width"], y)
    page.mouse.down()
    for step in range(1, 11):
        page.mouse.move(box["x"] + (share + 0.1 * step * part) * box["width"], y)
        page.wait_for_timeout(40)
    page.mouse.up()


def type_in(page: Page, path: str, text: str) -> None:
    """Type a value into the field of a key."""
    field = page.locator(f'[aria-label^="{path} "]')
    field.fill(text)
    field.press("Enter")


def downloaded_case(page: Page, folder: Path) -> Case:
    """The case that the page saves."""
    page.locator(".top").get_by_label("Save").click()
    with page.expect_download() as download:
        page.get_by_text("Case, TOML").click()
    download.value.save_as(folder / "case.toml")
    return Case.load(folder / "case.toml")


def printed(case: Case) -> dict[str, tuple[str, str]]:
    """Values and error bars that `petalfoil balance --error` prints for a case, by label."""
    balance = known_verbs.find("balance")
    assert balance is not None
    run = balance.start(case, balance.read({"error": True}), lambda part, text: None)
    for _ in balance.advance(run, lambda part, text: None):
        pass
    (table,) = tables_of(balance.answer(run))
    return {line[0].strip(): (line[1].strip(), line[2].strip("± ") if len(line) > 3 else "") for line in table.lines}


def test_dragging_moves_picture_and_numbers_to_those_of_balance(page: Page, tmp_path: Path) -> None:
    before, picture = numbers(page), page.inner_html(".section-chart .main-svg >> nth=0")
    drag(page, "petals.thickness", 0.1)
    page.wait_for_function(
        "old => !document.querySelector('.numbers').textContent.includes(old)",
        arg=before["minimum film thickness"]["now"],
    )
    page.wait_for_selector(".numbers .grid-note:has-text('balance: cells_per_pitch = 128')")
    answered(page, "with error bars")
    page.wait_for_function("[...document.querySelectorAll('.numbers th')].some(one => one.textContent.trim() === '±')")
    after, case = numbers(page), downloaded_case(page, tmp_path)
    assert case.petals is not None
    assert case.petals.thickness > 180e-6
    assert page.inner_html(".section-chart .main-svg >> nth=0") != picture
    expected = printed(case)
    shown = {label: (cells["now"], cells["±"]) for label, cells in after.items() if label not in NOT_OF_THE_STATE}
    assert {"bearing force", "minimum film thickness", "peak pressure", "friction torque"} <= set(shown)
    assert shown["minimum film thickness"][1]
    assert shown == {label: expected[label] for label in shown}


def test_a_refusal_stands_at_its_field_and_goes_when_it_is_mended(page: Page) -> None:
    before = numbers(page)
    type_in(page, "petals.thickness", "12 N")
    page.get_by_text("measures something else").wait_for()
    near = page.locator(".key", has=page.locator('[aria-label^="petals.thickness "]'))
    assert "expected a length" in near.inner_text()
    assert numbers(page)["minimum film thickness"]["now"] == before["minimum film thickness"]["now"]
    type_in(page, "petals.thickness", "180 umm")
    near.get_by_text("did you mean 'um'?").wait_for()
    type_in(page, "petals.thickness", "180 um")
    near.get_by_text("did you mean").wait_for(state="detached")
    answered(page)
    assert numbers(page)["minimum film thickness"]["now"] != before["minimum film thickness"]["now"]


def test_a_long_run_is_cancelled_and_the_next_is_answered(page: Page) -> None:
    page.locator(".table-of-case", has_text="model").last.locator(".q-item").first.click()
    type_in(page, "model.cells_per_pitch", "80")
    page.wait_for_selector(".numbers .grid-note:has-text('balance: cells_per_pitch = 80')")
    page.get_by_label("kind", exact=True).first.click()
    page.get_by_role("option", name="3d").click()
    page.get_by_role("button", name="Cancel").wait_for()
    page.get_by_text("first answer, coarse 2-D").wait_for()
    page.get_by_role("button", name="Cancel").click()
    answered(page, "cancelled")
    page.get_by_label("kind", exact=True).first.click()
    page.get_by_role("option", name="2d").click()
    answered(page)
    page.wait_for_selector(".numbers .grid-note:has-text('balance: cells_per_pitch = 80')")


def test_a_pinned_design_stands_beside_the_new_one_and_history_goes_back(page: Page) -> None:
    answered(page, "with error bars")
    first = numbers(page)["minimum film thickness"]["now"]
    page.get_by_label("Pin as A").click()
    type_in(page, "petals.thickness", "190 um")
    page.wait_for_selector(".past tbody tr:nth-child(2)")
    answered(page, "with error bars")
    row = numbers(page)["minimum film thickness"]
    assert float(row["A"]) == pytest.approx(float(first), rel=1e-2)  # to the digits of the table, without a bar
    assert re.fullmatch(r"[+-][\d.]+ %", row["difference"])
    assert row["now"] != first
    assert page.evaluate("document.querySelector('.film-chart').data.length") == 4
    page.locator(".past tbody tr").last.click()
    answered(page, "with error bars")
    page.wait_for_function(
        "first => [...document.querySelectorAll('.numbers tbody tr')].some(row =>"
        " row.cells[0].textContent.trim() === 'minimum film thickness' &&"
        " [...row.cells].some(cell => cell.textContent.trim() === first))",
        arg=first,
    )


def test_the_state_survives_a_reload_and_another_tab_has_its_own(page: Page, studio: Studio) -> None:
    type_in(page, "petals.thickness", "185 um")
    page.wait_for_selector(".past tbody tr:nth-child(2)")
    answered(page, "with error bars")
    before = numbers(page)
    page.reload()
    answered(page)
    page.wait_for_selector(".numbers tbody tr")
    assert page.locator('[aria-label^="petals.thickness "]').input_value() == "185 um"
    assert numbers(page) == before
    assert page.locator(".past tbody tr").count() == 2
    other = page.context.new_page()
    other.goto(studio.url)
    answered(other)
    assert other.locator('[aria-label^="petals.thickness "]').input_value() == "176 um"


def test_a_script_in_a_title_is_text_and_files_open_again(page: Page, tmp_path: Path) -> None:
    title = "<script>window.hacked = 1</script><img src=x onerror='window.hacked = 1'>"
    case = Case.load(Path(__file__).parents[2] / "examples" / "paper_n8.toml").replace(title=title)
    (tmp_path / "evil.toml").write_text(case.to_toml())
    page.set_input_files("input[type=file]", tmp_path / "evil.toml")
    page.get_by_text("<script>window.hacked", exact=False).first.wait_for()
    answered(page)
    page.get_by_role("tab", name="Log").click()
    assert page.evaluate("window.hacked") is None
    assert downloaded_case(page, tmp_path) == case


def test_a_question_is_answered_from_its_declaration(page: Page) -> None:
    page.get_by_role("tab", name="curve").click()
    page.get_by_label("curve eccentricities").fill("0 um : 100 um : 3")
    page.get_by_role("button", name="Run curve").click()
    answered(page, "curve: done")
    page.wait_for_selector(".question tbody tr:nth-child(3)")
    assert page.evaluate("document.querySelector('.question .js-plotly-plot').data[0].x.length") == 3
    page.get_by_label("curve eccentricities").fill("0 N : 100 um : 3")
    page.get_by_role("button", name="Run curve").click()
    page.locator(".question .refusal:visible", has_text="eccentricities").wait_for()


def test_every_analysis_has_a_tab(page: Page) -> None:
    for verb in known_verbs.summaries():
        page.get_by_role("tab", name=verb, exact=True).click()
        page.get_by_role("button", name=f"Run {verb}", exact=True).wait_for()


def test_a_stress_beyond_its_limit_is_coloured(page: Page) -> None:
    assert page.locator(".numbers .warned").count() == 0
    type_in(page, "petals.yield_strength", "300 MPa")
    page.locator(".numbers td.warned", has_text="maximum bending stress").wait_for()
    page.locator(".numbers .warning", has_text="yield").first.wait_for()


def test_a_grid_of_ten_million_cells_is_refused_while_another_page_is_answered(
    page: Page, studio: Studio, tmp_path: Path
) -> None:
    text = downloaded_case(page, tmp_path).to_toml()
    grids = {
        'kind = "2d"\ncells_per_pitch = 10_000_000': "at most 4096",  # stands in a table that was folded
        'kind = "3d"\ncells_per_pitch = 4096\naxial_cells = 512': "the page runs up to",
    }
    for grid, words in grids.items():
        (tmp_path / "huge.toml").write_text(text.replace('kind = "2d"', grid))
        page.set_input_files("input[type=file]", tmp_path / "huge.toml")
        field = page.locator(".key", has=page.locator('[aria-label^="model.cells_per_pitch "]'))
        field.get_by_text(words).wait_for()
    other = page.context.new_page()
    other.goto(studio.url)
    answered(other)


def test_what_is_no_case_or_too_large_is_not_opened(page: Page, tmp_path: Path) -> None:
    for name, content, words in (
        ("no.toml", b"\xff\xfe", "no text in UTF-8"),
        ("other.toml", b"[bearing", "the file is refused"),
        ("large.toml", b"#" * 10 * 2**20, "up to 64 kB"),
    ):
        (tmp_path / name).write_bytes(content)
        page.set_input_files("input[type=file]", tmp_path / name)
        page.get_by_text(words).first.wait_for()
    assert page.locator('[aria-label^="petals.thickness "]').input_value() == "176 um"


def click_on(page: Page, point: Locator) -> None:
    """Click on a point of a drawing, which takes clicks once the mouse has rested on it."""
    point.wait_for()
    point.scroll_into_view_if_needed()
    page.wait_for_timeout(500)
    box = point.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.wait_for_timeout(300)
    page.mouse.down()
    page.mouse.up()


def test_a_point_of_a_map_opens_its_case(page: Page) -> None:
    page.get_by_role("tab", name="Map").click()
    page.get_by_label("values over").fill("160 um, 190 um")
    page.get_by_role("button", name="Run map").click()
    answered(page, "map: done")
    click_on(page, page.locator(".past .scatterlayer .point").last)
    page.wait_for_function("document.querySelector('[aria-label^=\"petals.thickness \"]').value === '190 µm'")


def test_a_point_of_a_map_over_two_parameters_opens_its_case(page: Page) -> None:
    page.locator(".table-of-case", has_text="model").last.locator(".q-item").first.click()
    type_in(page, "model.cells_per_pitch", "16")
    page.wait_for_selector(".numbers .grid-note:has-text('balance: cells_per_pitch = 16')")
    page.get_by_role("tab", name="Map").click()
    page.get_by_label("values over").fill("160 um, 190 um")
    page.get_by_label("and", exact=True).click()
    page.get_by_role("option", name="petals.arc_length").click()
    page.get_by_label("values and").fill("44 mm, 45 mm")
    page.get_by_role("button", name="Run map").click()
    answered(page, "map: done")
    assert page.locator(".past .contourlayer path").count() > 0
    click_on(page, page.locator(".past .scatterlayer .point").first)
    page.wait_for_function("document.querySelector('[aria-label^=\"petals.arc_length \"]').value === '44 mm'")
    assert page.locator('[aria-label^="petals.thickness "]').input_value() == "160 µm"


def test_a_worker_that_is_killed_is_told_and_the_page_goes_on(page: Page, studio: Studio) -> None:
    page.locator(".table-of-case", has_text="model").last.locator(".q-item").first.click()
    page.get_by_label("kind", exact=True).first.click()
    page.get_by_role("option", name="3d").click()
    page.get_by_text("first answer, coarse 2-D").wait_for()
    for worker in studio.workers():
        worker.kill()
    page.get_by_text("the worker process ended unexpectedly").first.wait_for()
    page.get_by_label("kind", exact=True).first.click()
    page.get_by_role("option", name="2d").click()
    answered(page)


def test_the_3d_view_alone_uses_webgl(page: Page) -> None:
    assert page.locator("canvas").count() == 0
    page.get_by_role("button", name="3-D").click()
    page.locator("canvas").first.wait_for()
    page.get_by_role("button", name="Cross-section").click()
    page.locator("canvas").first.wait_for(state="detached")


def test_names_for_screen_readers_and_a_narrow_window(page: Page) -> None:
    nameless = page.evaluate(
        "[...document.querySelectorAll('button, input:not([type=file]), [role=slider]')].filter(one => one.offsetParent"
        " && !(one.getAttribute('aria-label') || one.textContent.trim() || one.closest('label')?.textContent.trim()"
        " || one.closest('[aria-label]'))).map(one => one.outerHTML.slice(0, 120))"
    )
    assert nameless == []
    page.set_viewport_size({"width": 400, "height": 800})
    page.wait_for_function("document.documentElement.scrollWidth <= 400")


def test_every_file_of_the_menu_is_what_it_says(page: Page, tmp_path: Path) -> None:
    begins = {
        "Table, CSV": b"status",
        "NetCDF, all data": b"\x89HDF",
        "Figure, PNG": b"\x89PNG",
        "Figure, SVG": b"<?xml",
        "Report, one HTML page": b"<!DOCTYPE html>",
    }
    answered(page, "with error bars")
    for words, head in begins.items():
        page.locator(".top").get_by_label("Save").click()
        with page.expect_download() as download:
            page.locator(".q-menu").get_by_text(words).click()
        download.value.save_as(tmp_path / "file")
        assert (tmp_path / "file").read_bytes().startswith(head), words
    page.locator(".top").get_by_label("Save").click()
    page.get_by_text("Lines of Python").click()
    lines = page.get_by_label("lines of Python").input_value()
    assert "petalfoil.balance(case" in lines
    compile(lines, "lines", "exec")


def test_a_motion_plays_its_section(page: Page, tmp_path: Path) -> None:
    rotor = '\n[rotor]\nmass = "1.5 kg"\nunbalance = "1 um"\n'
    text = downloaded_case(page, tmp_path).replace(**{"model.cells_per_pitch": 16, "operation.load": None}).to_toml()
    (tmp_path / "rotor.toml").write_text(text + rotor)
    page.set_input_files("input[type=file]", tmp_path / "rotor.toml")
    page.wait_for_selector(".numbers .grid-note:has-text('solve: cells_per_pitch = 16')")
    page.get_by_role("tab", name="orbit").click()
    page.get_by_label("orbit revolutions").fill("2")
    page.get_by_role("button", name="Run orbit").click()
    answered(page, "orbit: done")
    chart = page.locator(".motion-chart")
    chart.wait_for()
    journal = (
        "document.querySelector('.motion-chart').data.find(one => one.xaxis === 'x4' && one.line.width === 1).x[0]"
    )
    before = page.evaluate(journal)
    chart.get_by_text("animate").click()
    page.wait_for_function(f"{journal} !== {before!r}")


def test_a_design_of_a_front_opens_its_case(page: Page) -> None:
    type_in(page, "petals.thickness", "175 um")
    answered(page)
    page.get_by_role("tab", name="Optimum").click()
    page.get_by_label("range varied", exact=True).fill("160 um : 190 um")
    page.get_by_label("range also varied").fill("44 mm : 46 mm")
    page.get_by_label("designs", exact=True).fill("many")
    page.get_by_role("button", name="Run search").click()
    page.locator(".past .refusal:visible", has_text="whole number").wait_for()
    page.get_by_label("designs", exact=True).fill("12")
    page.get_by_role("button", name="Run search").click()
    answered(page, "search: done")
    click_on(page, page.locator(".past .scatterlayer .point:visible").last)
    page.wait_for_function("document.querySelector('[aria-label^=\"petals.thickness \"]').value !== '175 um'")


def test_capacity_has_a_tab_of_its_own(page: Page) -> None:
    page.locator(".table-of-case", has_text="model").last.locator(".q-item").first.click()
    type_in(page, "model.cells_per_pitch", "16")
    page.wait_for_selector(".numbers .grid-note:has-text('balance: cells_per_pitch = 16')")
    page.get_by_role("tab", name="capacity").click()
    page.get_by_role("button", name="Run capacity").click()
    page.locator(".question .refusal:visible", has_text="give 'min film thickness', 'contact fraction'").wait_for()
    page.set_default_timeout(4.0 * PATIENCE)  # twenty balances and more
    page.get_by_label("capacity min film").fill("4 um")
    page.get_by_role("button", name="Run capacity").click()
    answered(page, "capacity: done")
    page.locator(".question:visible", has_text="load capacity").wait_for()


CONTRAST = """
([selector, least]) => {
  const colour = text => text.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map(one => one / 255).map(one =>
    one <= 0.04045 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4).reduce((sum, one, k) =>
    sum + one * [0.2126, 0.7152, 0.0722][k], 0);
  const ground = element => {
    for (let one = element; one; one = one.parentElement) {
      const found = colour(getComputedStyle(one).backgroundColor);
      if (found.length < 4 || found[3] === 1) return found;
    }
    return [255, 255, 255];
  };
  return [...document.querySelectorAll(selector)].filter(one => one.offsetParent && one.textContent.trim()
    && ![...one.children].some(child => child.textContent.trim())).map(one => {
      const [a, b] = [light(colour(getComputedStyle(one).color)), light(ground(one))].sort((x, y) => y - x);
      return [(a + 0.05) / (b + 0.05), one.textContent.trim().slice(0, 40), getComputedStyle(one).color];
    }).filter(([ratio]) => ratio < least);
}
"""
"""Texts whose contrast with what is behind them is below a ratio (WCAG 2, 1.4.3)."""


def test_texts_have_contrast_on_a_light_and_a_dark_page(page: Page) -> None:
    texts = "div, span, label, td, th, button, p"
    assert page.evaluate(CONTRAST, [texts, 4.5]) == []
    page.get_by_label("light or dark").click()
    page.wait_for_selector("body.body--dark")
    page.wait_for_timeout(1000)
    assert page.evaluate(CONTRAST, [texts, 4.5]) == []


FOCUSED = """
(one => one ? one.getAttribute('role') || one.tagName : '')(
  document.activeElement.closest('[role=slider], [role=tab], button, input'))
"""
"""What kind of control has the focus."""


def test_the_keyboard_reaches_fields_sliders_and_tabs(page: Page) -> None:
    """A person without a mouse changes the thickness with the arrow keys, and sees where the focus is."""
    page.get_by_label("slide petals.thickness", exact=True).locator("[tabindex]").focus()
    before = page.locator('[aria-label^="petals.thickness "]').input_value()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.wait_for_function(
        "old => document.querySelector('[aria-label^=\"petals.thickness \"]').value !== old", arg=before
    )
    seen = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        seen.add(page.evaluate(FOCUSED))
    assert {"INPUT", "slider"} <= seen
    assert {"BUTTON", "tab"} & seen
