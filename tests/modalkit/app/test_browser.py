"""The whole way of the work in a browser, on hits with a model: what the page shows is what the command line prints.

Needs Debian's ``chromium`` (or one named by ``MODALKIT_CHROMIUM``); without it these tests are skipped.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from accessible import grave_findings
from glider import make_glider
from opening import FAINT

CHROMIUM = os.environ.get("MODALKIT_CHROMIUM") or shutil.which("chromium")
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium here: apt-get install chromium"),
]
sync = pytest.importorskip("playwright.sync_api", reason="no playwright here")

PATIENCE = 240_000
"""Milliseconds that a page may take on a machine shared with others."""


class Served:
    """The app as a process of its own, which can be killed."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.start()

    def start(self) -> None:
        command = [sys.executable, "-m", "modalkit", "app", str(self.path), "--no-browser"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.address

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()
        assert self.process.stdout is not None
        self.process.stdout.close()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync.sync_playwright() as playwright:
        arguments = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        one = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield one
        one.close()


@pytest.fixture
def serve() -> Iterator[Callable[[Path], Served]]:
    started: list[Served] = []

    def start(path: Path) -> Served:
        started.append(Served(path))
        return started[-1]

    yield start
    for one in started:
        one.kill()


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Serve the study of a beam to the tests that leave it as they find it."""
    folder = tmp_path_factory.mktemp("shown")
    shutil.copytree(Path(__file__).resolve().parents[3] / "sample_data" / "beam_dry", folder / "beam_dry")
    served = Served(folder / "beam_dry" / "study.toml")
    yield served
    served.kill()


class Page:
    """A tab, with everything it complained of and every foreign address it asked."""

    def __init__(self, browser: Any, served: Served, **options: Any) -> None:
        self.served, self.faults, self.foreign = served, [], []
        self.tab = browser.new_page(**options)
        self.tab.set_default_timeout(PATIENCE)
        self.tab.on("console", self._listen)
        self.tab.on("pageerror", lambda error: self.faults.append(str(error)))
        self.tab.on("request", self._watch)

    def _listen(self, message: Any) -> None:
        refused = "422" in message.text  # a change that cannot be made, which the page says itself
        if message.type == "error" and not refused:
            self.faults.append(message.text)

    def _watch(self, request: Any) -> None:
        if not request.url.startswith((self.served.address, "data:", "blob:", "about:")):
            self.foreign.append(request.url)

    def open(self, name: str) -> None:
        self.tab.goto(f"{self.served.address}#{name}")
        self.tab.locator(f".page-{name}").wait_for(state="attached")
        self.settle()

    def settle(self) -> None:
        """Wait until nothing is being computed or drawn: the page is marked as busy from each event on."""
        self.tab.locator('#page[aria-busy="false"]').wait_for(state="attached")

    def modes(self) -> list[list[str]]:
        """Return the columns of frequency, damping, and their standard deviations on the page of the modes."""
        rows = self.tab.locator(".page-modes tbody tr").all()
        return [row.locator("td").all_inner_texts()[:4] for row in rows]


def commanded(command: str, path: Path, folder: Path, *options: str) -> dict[str, Any]:
    """Return the JSON that the command line gives of a study."""
    out = folder / f"{command}.json"
    words = [sys.executable, "-m", "modalkit", command, str(path), *options, "--json", str(out)]
    subprocess.run(words, check=True, capture_output=True)
    return json.loads(out.read_text(encoding="utf-8"))


def identified(path: Path, folder: Path) -> dict[str, Any]:
    """Return the modes that the command line gives of a study."""
    return commanded("identify", path, folder)


def printed(document: dict[str, Any]) -> list[list[str]]:
    """Return the same columns of a JSON file of modes, with the decimals of the command line."""
    return [
        [
            f"{mode['frequency_hz']:.4f}",
            f"{mode['frequency_sigma_hz']:.5f}",
            f"{100 * mode['damping_ratio']:.4f}",
            f"{100 * mode['damping_sigma']:.5f}",
        ]
        for mode in document["modes"]
    ]


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


MOVING = "canvas[data-fps]:not([data-fps='0.0'])"
"""The picture of shapes once it has moved."""


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


def rms(text: str) -> float:
    """Return the number of a line of the page of the model [%]."""
    return float(text.split(maxsplit=1)[0])


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
    assert "into the model" in tab.locator("#undo").get_attribute("title")
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
    """What was said of a mode ends with the state it was of; a study without a model says what to write."""
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
    assert 'type = "calculix"' in page.tab.locator("#no-model").inner_text()
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


NAMELESS = """[...document.querySelectorAll("main button, main input, main select, main textarea, header button")]
  .filter((e) => e.checkVisibility())
  .filter((e) => !(e.textContent.trim() && e.tagName === "BUTTON"))
  .filter((e) => !e.getAttribute("aria-label") && !e.labels?.length)
  .map((e) => e.outerHTML.slice(0, 80))"""
"""Controls that a screen reader could not name."""


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


def test_a_region_is_softened_and_every_number_can_be_read_on_a_phone(browser, serve, tmp_path):
    page = Page(browser, serve(make_glider(tmp_path / "glider")), viewport={"width": 390, "height": 850})
    page.open("model")
    page.tab.locator(".heatmaplayer image").wait_for(state="attached")
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
    page.tab.locator(".heatmaplayer image").wait_for(state="attached")
    assert page.tab.evaluate(OVERLAPS) == []
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


SIZE = """async () => {
  const { Body } = await import("./static/body.js");
  const made = [];
  new Body({ add: (object) => made.push(object) }, [[0, 0, 0]]);
  return made[0].material.size;
}"""
"""The size of a point, as three.js is told."""


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
