"""Charts, tables and shapes in a browser: what is read off them, on a phone and a fine screen, too."""

from __future__ import annotations

import time

import pytest
from driven import (
    IN_A_BROWSER,
    PATIENCE,
    Page,
    commanded,
    printed,
    rms,
)
from glider import make_glider
from opening import FAINT

pytestmark = IN_A_BROWSER


def test_a_region_is_softened_and_every_number_can_be_read_on_a_phone(browser, serve, tmp_path):
    page = Page(browser, serve(make_glider(tmp_path / "glider")), viewport={"width": 390, "height": 850})
    page.open("model")
    page.tab.locator(".page-model .cell").first.wait_for(state="attached")
    assert page.tab.evaluate(OVERLAPS) == []
    before = page.tab.locator("#rms").inner_text()
    page.tab.locator("#region").select_option("wing_left_outer")
    slider = page.tab.locator('[id="factor-wing_left_outer.E"]')
    slider.evaluate("input => { input.value = Math.log10(0.6); input.dispatchEvent(new Event('input')); }")
    page.tab.get_by_text("over 17 pairs").wait_for()
    assert rms(page.tab.locator("#rms").inner_text()) < rms(before)
    page.tab.locator("#slide-reset").click()
    page.tab.get_by_text(before, exact=True).wait_for()
    page.open("modes")
    rows = page.tab.locator(".page-modes tbody tr")
    assert max(row.bounding_box()["height"] for row in rows.all()) < THREE_LINES
    page.tab.locator(".page-modes .cell").first.wait_for(state="attached")
    assert page.tab.evaluate(OVERLAPS) == []
    assert page.faults == []


def test_charts_and_tables_are_read_off(browser, shown):
    """Letters beside poles, two cursors, FRFs over one another, a table that sorts, is copied, and does not jump."""
    page = Page(browser, shown, viewport={"width": 1400, "height": 700})
    tab = page.tab
    tab.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.open("modes")
    assert {"o", "s"} <= set(
        tab.locator(".page-modes .chart").first.locator(".textpoint text").all_text_contents()
    )
    for name, hertz in (("A", "24.47"), ("B", "153.96")):
        tab.get_by_label(f"cursor {name} [Hz]").fill(hertz)
        tab.keyboard.press("Enter")
    tab.get_by_text("B − A: 129.49 Hz, measured").wait_for()
    assert tab.locator(".page-modes text.in").get_by_text("100", exact=True).count() == 3
    tab.evaluate("window.scrollTo(0, 0)")
    tab.evaluate(
        "document.querySelector('.page-modes .chart').emit('plotly_click', {points: [{customdata: 2}]})"
    )
    assert tab.locator("tr.chosen").inner_text().startswith("3")
    assert tab.evaluate("window.scrollY") == 0
    frequency = tab.get_by_role("button", name="frequency [Hz]", exact=True)
    frequency.click()
    frequency.click()
    assert [row[0] for row in page.modes()] == sorted(
        (row[0] for row in page.modes()), key=float, reverse=True
    )
    tab.get_by_role("button", name="Copy").click()
    tab.get_by_role("button", name="Copied").wait_for()
    copied = [line.split("\t") for line in tab.evaluate("navigator.clipboard.readText()").split("\n")]
    assert copied[0][:2] == ["mode", "frequency [Hz]"]
    assert [line[1] for line in copied[1:]] == [row[0] for row in page.modes()]
    page.open("hits")
    tab.locator("#overlay").check()
    page.settle()
    assert tab.evaluate("[...document.querySelectorAll('.chart')].at(-1).data.length") >= 5
    assert page.faults == []
    assert page.foreign == []


def test_shapes_are_seen_from_the_usual_directions_over_the_structure_at_rest(browser, shown):
    page = Page(browser, shown)
    page.open("shapes")
    canvas = page.tab.locator("canvas[data-fps]")
    canvas.wait_for()
    page.tab.locator("#play").click()
    pictures = []
    for name in ("oblique", "top (x-y)", "front (x-z)"):
        page.tab.locator(f'[data-view="{name}"]').click()
        page.tab.wait_for_timeout(500)
        pictures.append(canvas.screenshot())
    page.tab.locator("#rest").check()
    page.tab.wait_for_timeout(500)
    pictures.append(canvas.screenshot())
    assert len(set(pictures)) == 4
    assert page.faults == []


def test_without_a_graphics_card_few_pixels_are_drawn_while_shapes_move(browser, shown):
    """One each, without further samples, on whatever screen; a picture that stands still is drawn as fine as any."""
    page = Page(browser, shown, device_scale_factor=2)
    page.open("shapes")
    canvas = page.tab.locator("canvas[data-fps]")
    canvas.wait_for()
    if canvas.get_attribute("data-soft") != "true":
        pytest.skip("this machine has a graphics card")
    assert canvas.evaluate(PIXELS) == pytest.approx(1.0, abs=0.01)
    assert canvas.evaluate("c => c.getContext('webgl2').getContextAttributes().antialias") is False
    page.tab.locator("#play").click()
    ends = time.monotonic() + PATIENCE / 1000
    while canvas.evaluate(PIXELS) != pytest.approx(2.0, abs=0.01):
        assert time.monotonic() < ends
        page.tab.wait_for_timeout(100)
    assert page.faults == []


def test_points_of_shapes_are_as_large_on_a_fine_screen(browser, shown):
    """Sizes are those of the page's pixels; three.js multiplies by the pixels drawn."""
    sizes = []
    for scale in (1, 2):
        page = Page(browser, shown, device_scale_factor=scale)
        page.open("shapes")
        sizes.append(page.tab.evaluate(SIZE))
    assert sizes[0] == sizes[1] > 0


def test_a_faint_mode_is_picked_by_keys(browser, serve, faint, tmp_path):
    """What the automatic choice leaves out is kept once it is picked, with the numbers of the command line."""
    page = Page(browser, serve(faint))
    page.open("modes")
    before = page.modes()
    page.tab.locator("#pick-hertz").focus()
    page.tab.keyboard.type(str(FAINT))
    page.tab.keyboard.press("Enter")
    page.tab.get_by_role("button", name="picked").wait_for()
    page.settle()
    picked = page.modes()
    assert len(picked) == len(before) + 1
    assert any(abs(float(row[0]) - FAINT) < 0.01 * FAINT for row in picked)
    assert "picked by you" in page.tab.locator(".page-modes table").inner_text()
    named = commanded("identify", faint, tmp_path, "--add", str(FAINT))
    assert printed(named) == picked
    assert page.faults == []


THREE_LINES = 80
"""Height of a row of three lines at the most [pixels]."""


OVERLAPS = """[...document.querySelectorAll(".xaxislayer-above")].flatMap((layer) => {
  const boxes = [...layer.querySelectorAll(".xtick text")].map((t) => [t.textContent, t.getBoundingClientRect()]);
  boxes.sort((a, b) => a[1].left - b[1].left);
  return boxes.slice(1).filter(([, b], i) => boxes[i][1].right > b.left).map(([text]) => text);
})"""
"""Numbers at an axis that run into those before them."""


PIXELS = "canvas => canvas.width / canvas.clientWidth"
"""Pixels drawn per pixel of the page."""


SIZE = """async () => {
  const { Body } = await import("./static/body.js");
  const made = [];
  new Body({ add: (object) => made.push(object) }, [[0, 0, 0]]);
  return made[0].material.size;
}"""
"""The size of a point, as three.js is told."""
