"""The report in a browser: at a desk and on a phone, with mouse and keys, in light and dark, on paper."""

import pytest

from tests.browser import CHROMIUM, Browser

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")
CELL = "details[open] table.grid button"
LISTED = "[...document.querySelectorAll('#drawer tbody tr')].map(row => row.textContent)"


@pytest.fixture(scope="module")
def browser():
    with Browser() as opened:
        yield opened


@pytest.mark.parametrize("width", [1280, 390])
def test_a_click_on_a_cell_lists_the_runs_behind_it(browser, report, width):
    browser.open(report, width)
    assert browser.run("document.documentElement.scrollWidth <= innerWidth")
    browser.click(CELL)
    rows = browser.run(LISTED)
    assert len(rows) == 2
    assert rows[0].startswith("i0")
    box = browser.run(
        "(b => [b.left, b.right, b.top, b.bottom])(document.querySelector('#drawer').getBoundingClientRect())"
    )
    assert box[0] >= 0
    assert box[1] <= width
    assert 0 < box[2] < box[3] <= 900
    browser.click("#close")
    assert browser.run("document.querySelector('#drawer').hidden")
    assert browser.errors() == []
    assert browser.requests() == []


def test_the_keyboard_reaches_cells_and_comes_back(browser, report):
    browser.open(report)
    browser.run(f"document.querySelector('{CELL}').focus()")
    first = browser.run("document.activeElement.getAttribute('aria-label')")
    browser.press("ArrowRight")
    second = browser.run("document.activeElement.getAttribute('aria-label')")
    assert first != second
    browser.press("Enter")
    assert browser.run("document.querySelector('#drawer-title').textContent").startswith(second)
    assert len(browser.run(LISTED)) == 2
    browser.press("Escape")
    assert browser.run("document.activeElement.getAttribute('aria-label')") == second
    assert browser.run("document.querySelectorAll('table.grid').length") == browser.run(
        "document.querySelectorAll('table.grid button[tabindex=\"0\"]').length"
    )


def test_the_theme_follows_the_system_until_it_is_chosen(browser, report):
    colour = "getComputedStyle(document.body).backgroundColor"
    browser.open(report, dark=True)
    dark = browser.run(colour)
    browser.click("#theme")
    assert browser.run("document.querySelector('#theme').textContent") == "Theme: light"
    assert browser.run(colour) != dark
    browser.click("#theme")
    assert browser.run(colour) == dark
    browser.run("localStorage.clear()")


def test_it_prints_whole_and_on_white_even_where_the_system_is_dark(browser, report, tmp_path):
    browser.open(report, dark=True)
    dark = [{"name": "prefers-color-scheme", "value": "dark"}]
    browser.call("Emulation.setEmulatedMedia", media="print", features=dark)
    assert browser.run("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    browser.call("Emulation.setEmulatedMedia", media="")
    browser.paper(tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
