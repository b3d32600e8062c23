"""The whole way of the work in a browser, on hits with a model: what the page shows is what the command line prints."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from accessible import grave_findings
from driven import (
    IN_A_BROWSER,
    MOVING,
    NAMELESS,
    Page,
    commanded,
    identified,
    printed,
    rms,
)

pytestmark = IN_A_BROWSER


def test_the_way_of_the_work(browser, serve, beam, tmp_path):
    """Hits, modes, shapes, model, update, diagnosis, undo, a kill, export."""
    served = serve(beam)
    page = Page(browser, served)
    page.open("modes")
    nominal = page.modes()
    assert nominal == printed(identified(beam, tmp_path))
    throw_out_a_hit(page)
    page.open("modes")
    without = page.modes()
    assert without != nominal
    drop_and_pick(page, without)
    watch_shapes(page)
    slide_and_pair(page)
    update_the_model(page)
    answer = diagnose_and_stop(page)

    page.tab.goto("about:blank")
    served.kill()
    served.start()
    page.open("modes")
    assert page.modes() == without
    page.open("hits")
    assert not page.tab.locator('[data-hit="1+Z:3"]').is_checked()
    page.open("diagnosis")
    assert page.tab.locator("#diagnosis-answer").inner_text() == answer

    folder = export(page)
    for command, name in (("identify", "modes"), ("update", "update"), ("diagnose", "diagnose")):
        found = commanded(command, folder / "study.toml", tmp_path)
        assert found == json.loads((folder / f"{name}.json").read_text(encoding="utf-8")), command
    assert printed(identified(folder / "study.toml", tmp_path)) == without
    assert page.faults == []
    assert page.foreign == []


def throw_out_a_hit(page: Page) -> None:
    page.open("hits")
    assert page.tab.locator("#title").inner_text() == "Cantilever beam, dry"
    page.tab.locator('[data-hit="1+Z:3"]').uncheck()
    page.settle()
    assert not page.tab.locator('[data-hit="1+Z:3"]').is_checked()
    assert "left out by the user" in page.tab.locator(".verdict").inner_text()


def drop_and_pick(page: Page, modes: list[list[str]]) -> None:
    tab = page.tab
    tab.get_by_label("drop mode 2").click()
    page.settle()
    assert len(page.modes()) == len(modes) - 1
    assert modes[1][0] not in [row[0] for row in page.modes()]
    tab.get_by_role("button", name="dropped").click()  # taken back
    page.settle()
    assert page.modes() == modes
    tab.locator("#undo").click()  # ... and that undone
    page.settle()
    assert len(page.modes()) == len(modes) - 1
    tab.locator("#pick-hertz").fill("153.96")
    tab.locator("#pick").click()
    page.settle()
    assert page.modes() == modes


def watch_shapes(page: Page) -> None:
    page.open("shapes")
    assert page.tab.locator(".page-shapes tbody tr").count() == 3
    page.tab.locator(MOVING).wait_for()


def slide_and_pair(page: Page) -> None:
    tab = page.tab
    page.open("model")
    before = tab.locator("#rms").inner_text()
    tab.locator("#factor-E").fill("0.9")
    page.settle()
    assert tab.locator("#rms").inner_text() != before
    tab.locator("#factor-E").fill("1")
    tab.get_by_text(before, exact=True).wait_for()
    tab.locator("#effect").select_option("clamp_rotation")
    stiffness = tab.locator("#effect-stiffness")
    tab.get_by_text(before, exact=True).wait_for(state="detached")  # the effect in its middle size
    page.settle()
    middle = tab.locator("#rms").inner_text()
    stiffness.fill(stiffness.get_attribute("min"))  # as soft as the effect may be ...
    tab.get_by_text(middle, exact=True).wait_for(state="detached")
    page.settle()
    soft = tab.locator("#rms").inner_text()
    stiffness.fill(str((float(stiffness.get_attribute("min")) + float(stiffness.get_attribute("max"))) / 2))
    tab.get_by_text(soft, exact=True).wait_for(state="detached")  # ... is further off than half way
    assert rms(soft) > rms(tab.locator("#rms").inner_text())
    tab.locator("#slide-reset").click()
    page.settle()
    assert tab.locator("#rms").inner_text() == before
    tab.locator('[data-pair="2"]').select_option("4")  # re-paired by hand ...
    page.settle()
    assert tab.locator('[data-pair="2"]').input_value() == "4"
    assert tab.locator("#rms").inner_text() != before
    paired = tab.locator("#rms").inner_text()
    tab.locator("#undo").click()  # ... and taken back
    page.settle()
    assert tab.locator("#rms").inner_text() == before
    tab.locator("#redo").click()  # ... done again, and taken back
    page.settle()
    assert tab.locator("#rms").inner_text() == paired
    tab.locator("#undo").click()
    page.settle()
    assert tab.locator("#rms").inner_text() == before


def update_the_model(page: Page) -> None:
    page.open("update")
    page.tab.locator("#start-update").click()
    page.tab.locator("#update-answer").wait_for()
    assert "r.m.s." in page.tab.locator("#update-answer").inner_text()
    drawn = page.tab.locator(".drawing figcaption strong")
    assert "after" in drawn.first.inner_text()
    page.open("shapes")
    page.tab.locator("#model-which").select_option(label="updated")
    assert "model updated" in page.tab.locator(".page-shapes caption").inner_text()
    page.tab.locator(MOVING).wait_for()


def diagnose_and_stop(page: Page) -> str:
    tab = page.tab
    page.open("diagnosis")
    tab.locator("#start-diagnose").click()
    tab.locator("#stop-diagnose").wait_for()
    tab.locator("#stop-diagnose").click()
    tab.get_by_text("Stopped").wait_for()
    page.settle()
    tab.locator("#start-diagnose").click()
    tab.locator("#diagnosis-answer").wait_for()
    answer = str(tab.locator("#diagnosis-answer").inner_text())
    tab.locator(".drawing svg.drawn").nth(4).wait_for()
    headings = tab.locator("#page h2").all_inner_texts()
    assert headings[2:7] == [
        "How large the gap is",
        "Where it sits",
        "What causes it",
        "How far it closes",
        "FRFs before and after",
    ]
    report_opens(page, answer)
    tab.locator("#accept-0").click()
    page.settle()
    assert tab.locator("#undo").get_attribute("title").startswith("undo: accept ")
    assert "diagnose the rest" in tab.locator("#accepted").inner_text()
    assert tab.locator("#start-diagnose").inner_text() == "Diagnose the rest"
    tab.locator("#undo").click()
    tab.locator("#diagnosis-answer").wait_for()
    assert tab.locator("#diagnosis-answer").inner_text() == answer
    return answer


def report_opens(page: Page, answer: str) -> None:
    with page.tab.expect_popup() as opened:
        page.tab.get_by_role("link", name="The whole report").click()
    report = opened.value
    report.wait_for_load_state()
    assert answer in report.locator("header").inner_text()
    report.locator("figure svg.drawn").nth(3).wait_for(state="attached")
    report.close()


def export(page: Page) -> Path:
    page.tab.locator("#export").click()
    page.tab.locator("#notice.done").wait_for()
    folder = page.served.path.parent / "study-modalkit-export"
    assert {p.name for p in folder.iterdir()} == {
        *("study.toml", "modes.json", "modes.csv", "modes.uff", "frfs.uff"),
        *("update.json", "update.html", "diagnose.json", "diagnose.html"),
    }
    return folder


def test_a_refused_change_says_why_and_changes_nothing(browser, shown):
    page = Page(browser, shown)
    page.open("modes")
    before = page.modes()
    page.tab.locator("#band-low").fill("400")
    page.tab.locator("#band-high").fill("20")
    page.tab.locator("#band-set").click()
    page.tab.locator("#notice.error").wait_for()
    assert "20" in page.tab.locator("#notice").inner_text()
    assert page.modes() == before
    assert page.tab.locator("#undo").is_disabled()


def test_a_typed_limit_outlasts_an_undo_and_enter_sets_it(browser, serve, beam):
    """What was said of a mode ends with the state it was of; a study without a model has a form for one."""
    text = beam.read_text(encoding="utf-8")
    beam.write_text(text[: text.index("[model]")], encoding="utf-8")
    page = Page(browser, serve(beam))
    page.open("modes")
    page.tab.locator("#pick-hertz").fill("300")
    page.tab.locator("#pick-hertz").press("Enter")
    page.tab.locator("#readout", has_text="mode").wait_for()
    page.settle()
    page.tab.locator("#band-high").fill("480")
    page.tab.locator("#undo").click()
    page.settle()
    assert page.tab.locator("#readout").inner_text() == ""
    assert page.tab.locator("#band-high").input_value() == "480"
    page.tab.locator("#band-high").press("Enter")
    page.tab.locator("#undo[title*='band 5 to 480 Hz']").wait_for()
    page.open("model")
    assert page.tab.locator("#form-type option").all_inner_texts()[0] == "beam"
    assert page.faults == []


def test_a_file_alone_whose_title_is_a_script(browser, serve, tmp_path):
    title = "<img src=x onerror=document.title='owned'><script>document.title='owned'</script>"
    name = "a<b>&amp;.uff"
    sample = Path(__file__).resolve().parents[3] / "sample_data" / "beam_dry" / "beam_dry.uff"
    shutil.copy(sample, tmp_path / name)
    study = tmp_path / "study.toml"
    study.write_text(f'title = "{title}"\n[test]\nfiles = ["{name}"]\n', encoding="utf-8")
    page = Page(browser, serve(study))
    for where in ("hits", "modes", "shapes", "model", "update", "diagnosis"):
        page.open(where)
    assert page.tab.locator("#title").inner_text() == title
    assert page.tab.title().startswith(title[:20])
    assert page.tab.locator("img").count() == 0
    assert page.faults == []
    assert page.foreign == []


@pytest.mark.parametrize(("width", "scheme"), [(1400, "dark"), (390, "light")])
def test_nothing_is_wider_than_the_page_and_everything_has_a_name(browser, shown, width, scheme):
    page = Page(browser, shown, viewport={"width": width, "height": 850}, color_scheme=scheme)
    for where in ("hits", "modes", "shapes", "model", "update", "diagnosis"):
        page.open(where)
        assert page.tab.evaluate("document.documentElement.scrollWidth <= window.innerWidth"), where
        assert page.tab.evaluate(NAMELESS) == [], where
    assert page.faults == []


@pytest.mark.parametrize(
    ("width", "scheme"), [(1400, "light"), (1400, "dark"), (390, "light"), (390, "dark")]
)
def test_axe_has_nothing_grave_to_say(browser, shown, width, scheme):
    """Contrast, names, roles and order of every page, as axe-core sees them."""
    page = Page(
        browser, shown, viewport={"width": width, "height": 900}, color_scheme=scheme, bypass_csp=True
    )
    for where in ("hits", "modes", "shapes", "model", "update", "diagnosis"):
        page.open(where)
        assert grave_findings(page.tab) == [], where
    assert page.foreign == []


def test_axe_has_nothing_grave_to_say_of_a_file_without_a_model(browser, serve, faint):
    page = Page(browser, serve(faint), viewport={"width": 1400, "height": 900}, bypass_csp=True)
    for where in ("hits", "modes", "shapes", "model", "update", "diagnosis"):
        page.open(where)
        assert grave_findings(page.tab) == [], where
    assert page.foreign == []


def test_the_keyboard_reaches_hits_and_poles(browser, shown):
    page = Page(browser, shown)
    page.open("hits")
    page.tab.locator('[data-hit="1+Z:1"]').focus()
    page.tab.keyboard.press("Space")
    page.settle()
    assert not page.tab.locator('[data-hit="1+Z:1"]').is_checked()
    page.tab.locator("#title").click()
    page.tab.keyboard.press("Control+z")
    page.settle()
    assert page.tab.locator('[data-hit="1+Z:1"]').is_checked()
