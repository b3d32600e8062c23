"""Forms in a browser: a model, text with its columns, lines drawn by hand, pages that fill as results come."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from accessible import grave_findings
from driven import (
    IN_A_BROWSER,
    MOVING,
    NAMELESS,
    SAMPLES,
    Page,
    rms,
)
from text_hits import hits

from acquisition import read_uff, write_uff

pytestmark = IN_A_BROWSER


def test_a_file_of_hits_gets_its_model_from_a_form(browser, serve, tmp_path):
    """A warning's field writes the key; the form makes the model; both are changes that can be undone."""
    (test,) = read_uff(SAMPLES / "beam_dry" / "beam_dry.uff").tests
    write_uff(tmp_path / "hits.uff", tests=[replace(test, decay=0.0)])
    page = Page(browser, serve(tmp_path / "hits.uff"), viewport={"width": 390, "height": 850})
    page.open("hits")
    field = page.tab.locator('[id="ask-test.exponential_window"]')
    assert float(field.input_value()) == pytest.approx(8.0, rel=0.02)
    page.tab.locator('[id="ask-test.exponential_window-set"]').click()
    page.settle()
    assert field.count() == 0
    page.open("model")
    typed = {
        "length": "376",
        "width": "30.5",
        "thickness": "4.7625",
        "material.E": "210 GPa",
        "material.density": "7850",
    }
    for name, value in typed.items():
        page.tab.locator(f'[id="form-model.{name}"]').fill(value)
    page.tab.locator("#form-make").click()  # free, as no end is clamped: a model, but another one
    page.tab.locator("#rms").wait_for()
    page.tab.locator("#undo").click()
    page.settle()
    for name, value in typed.items():
        page.tab.locator(f'[id="form-model.{name}"]').fill(value)
    page.tab.locator('[id="form-model.clamped-x0"]').check()
    page.tab.locator("#form-make").click()
    page.tab.get_by_text("over 3 pairs").wait_for()
    assert 10 < rms(page.tab.locator("#rms").inner_text()) < 20
    assert page.faults == []
    assert page.foreign == []


def test_lines_are_drawn_by_hand(browser, serve, beam):
    """Two points clicked are joined; named, they are parted; the page is drawn anew without a fault."""
    served = serve(beam)
    page = Page(browser, served, viewport={"width": 1400, "height": 1000})
    tab = page.tab
    page.open("shapes")
    tab.locator(MOVING).wait_for()
    tab.locator("#join-on").check()
    tab.locator('[data-view="front (x-z)"]').click()
    tab.wait_for_timeout(500)
    tab.locator("canvas").scroll_into_view_if_needed()
    places = points_of(tab)
    first, last = sorted(places)[0], sorted(places)[-1]
    tab.mouse.click(*places[first])
    tab.get_by_text(f"from point {first}: click another one").wait_for()
    tab.mouse.click(*places[last])
    tab.locator(f"#undo[title='undo: connect points {first} and {last}']").wait_for()
    page.settle()
    text = tab.locator("#join-from").locator("option").all_inner_texts()
    tab.locator("#join-from").select_option(label=str(first))
    tab.locator("#join-to").select_option(label=str(last))
    assert {str(first), str(last)} <= set(text)
    tab.locator("#join").click()
    tab.locator(f"#undo[title='undo: disconnect points {first} and {last}']").wait_for()
    page.settle()
    tab.locator("#join-reset").click()
    page.settle()
    assert tab.locator("#join-reset").count() == 0
    assert tab.evaluate(NAMELESS) == []
    assert tab.locator("#notice.error").count() == 0
    assert page.faults == []


def points_of(tab: Any) -> dict[int, tuple[float, float]]:
    """Return where points are on the screen: the text that is shown under the mouse names them."""
    box, tip = tab.locator("canvas").bounding_box(), tab.locator(".tip")
    found: dict[int, tuple[float, float]] = {}
    for i in range(0, int(box["width"]), 24):
        for j in range(0, int(box["height"]), 24):
            x, y = box["x"] + i, box["y"] + j
            tab.mouse.move(x, y)
            if tip.is_visible():
                found.setdefault(int(tip.inner_text().split()[1].rstrip(":")), (x, y))
    return found


WIDER = """[...document.querySelectorAll(".js-plotly-plot")]
  .map((e) => [e.querySelector("svg.main-svg").getBoundingClientRect().width, e.clientWidth])
  .filter(([drawn, wide]) => Math.abs(drawn - wide) > 1)"""
"""Charts that are not as wide as their place."""

HEIGHTS = """[...document.querySelectorAll(".js-plotly-plot")]
  .map((e) => e.querySelector("svg.main-svg").getBoundingClientRect().height)"""
"""Heights of the charts [px]."""


def test_pages_fill_as_results_come(browser, serve, beam):
    """FRFs before the poles, single causes before the answer."""
    page = Page(browser, serve(beam), viewport={"width": 1400, "height": 850})
    tab = page.tab
    held: list[Any] = []

    def hold(route: Any) -> None:
        held.append(route)

    tab.route("**/api/modes", hold)
    tab.goto(f"{page.served.address}#modes")
    tab.locator("#readout", has_text="poles and modes follow").wait_for()
    tab.locator(".page-modes .js-plotly-plot").nth(1).wait_for()
    assert tab.locator(".page-modes tbody tr").count() == 0
    held[0].continue_()
    tab.locator(".page-modes tbody tr").first.wait_for()
    page.settle()
    assert tab.locator("#readout").inner_text() == ""
    tab.unroute("**/api/modes")
    assert tab.locator(".page-modes .js-plotly-plot").count() == 2
    tab.locator(".page-modes .drawing svg").first.wait_for()  # MACs, beside the second, which got narrower
    tab.wait_for_timeout(500)
    assert tab.evaluate(WIDER) == []
    heights = tab.evaluate(HEIGHTS)
    assert min(heights) > 200
    tab.set_viewport_size({"width": 900, "height": 700})
    tab.wait_for_timeout(1000)
    assert tab.evaluate(WIDER) == []
    assert tab.evaluate(HEIGHTS) == heights
    page.open("diagnosis")
    tab.locator("#start-diagnose").click()
    tab.locator("#so-far tbody tr").nth(3).wait_for()
    assert "no cause" in tab.locator("#so-far tbody").inner_text()
    assert tab.locator("#stop-diagnose").is_visible()
    assert tab.locator("#diagnosis-answer").count() == 0
    tab.locator("#diagnosis-answer").wait_for()
    assert tab.locator("#so-far tbody tr").count() == 0
    tab.locator(".drawing svg.drawn").nth(3).wait_for()
    assert tab.locator("#accept-0").is_visible()
    assert tab.locator("#notice.error").count() == 0
    assert page.faults == []


def test_a_folder_of_text_becomes_a_study(browser, serve, tmp_path):
    """Guesses are corrected, an error is seen and mended, layout and study are written, the page of hits follows."""
    names = hits(tmp_path)
    page = Page(browser, serve(tmp_path), viewport={"width": 390, "height": 850}, bypass_csp=True)
    tab = page.tab
    tab.goto(page.served.address)
    tab.locator("#import-usable", has_text="4 hits at 2 points").wait_for()
    assert grave_findings(tab) == []
    assert tab.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert tab.evaluate(NAMELESS) == []
    tab.locator(f'[data-file="{names[3]}"]').uncheck()
    tab.locator("#import-usable", has_text="3 hits at 2 points").wait_for()
    tab.locator("#import-unit-1").fill("V")
    tab.locator("#import-error", has_text="'V' is not a known unit of force").wait_for()
    assert tab.locator("#import-write").is_disabled()
    tab.locator("#import-unit-1").fill("lbf")
    tab.locator("#import-usable").wait_for()
    tab.locator("#import-write").click()
    tab.locator('[data-hit="2+Z:1"]').wait_for()
    page.settle()
    assert (tmp_path / "layout.toml").read_text(encoding="utf-8").count('unit = "lbf"') == 1
    assert len(read_hits(tmp_path / "study.toml")) == 3
    assert page.faults == []


def read_hits(study: Path) -> list[str]:
    """Return the files of a study."""
    return list(tomllib.loads(study.read_text(encoding="utf-8"))["test"]["files"])
