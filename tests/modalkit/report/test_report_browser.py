"""Reports in a browser: silent, alone, no wider than the page, their numbers within reach of mouse and keys.

Needs Debian's ``chromium`` (or one named by ``MODALKIT_CHROMIUM``); without it these tests are skipped.
"""

from __future__ import annotations

import csv
import os
import re
import shutil
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from accessible import grave_findings
from glider import make_glider
from report_pages import complete
from test_localisation_figure import diagnosis_with

from modalkit.report import Basis, diagnosis_report, identification_report, page
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from modalkit.workflow.identification import read

CHROMIUM = os.environ.get("MODALKIT_CHROMIUM") or shutil.which("chromium")
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium here: apt-get install chromium"),
]
sync = pytest.importorskip("playwright.sync_api", reason="no playwright here")

ROOT = Path(__file__).resolve().parents[3]
NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)
SCRIPT = "<script>window.taken = 1</script>"
DATA = ("beam", "plate", "glider")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync.sync_playwright() as playwright:
        arguments = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        one = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield one
        one.close()


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return a diagnosis of a beam, modes of a plate, and modes of a glider whose title is a script."""
    folder = tmp_path_factory.mktemp("reports")
    pages = {}
    session = open_study(read_study(ROOT / "sample_data" / "beam_dry" / "study.toml"))
    pages["beam"] = diagnosis_report(complete(diagnosis_with("beam", "class")), [session], when=NOON)
    for name, study in (
        ("plate", ROOT / "sample_data" / "plate_dry" / "study.toml"),
        ("glider", make_glider(folder / "glider", title=SCRIPT)),
    ):
        test = read_study(study).test
        processed = read([study.parent / file for file in test.files])
        pages[name] = identification_report(
            processed, processed.identify(band=test.band), Basis(NOON), title=processed.content.title
        )
    own = open_study(folder / "glider" / "study.toml")
    pages["standing"] = diagnosis_report(complete(diagnosis_with("beam", "none")), [own], when=NOON)
    for name, document in pages.items():
        (folder / f"{name}.html").write_text(page(document), encoding="utf-8")
    return {name: folder / f"{name}.html" for name in pages}


class Tab:
    """A report that is open, with all it complained of and all it asked of others."""

    def __init__(self, browser: Any, path: Path, *, width: int = 1400, scheme: str = "light") -> None:
        self.faults: list[str] = []
        self.foreign: list[str] = []
        self.page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
        self.page.on("console", lambda m: self.faults.append(m.text) if m.type == "error" else None)
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("request", self._watch)
        self.page.goto(path.as_uri())
        self.page.locator("svg.drawn").first.wait_for()

    def _watch(self, request: Any) -> None:
        if not request.url.startswith(("file:", "blob:", "data:")):
            self.foreign.append(request.url)

    def moving(self) -> None:
        """Wait until the shapes move."""
        self.page.locator("[id=shapes]").scroll_into_view_if_needed()
        self.page.locator("canvas[data-fps]").first.wait_for(timeout=60_000)

    def close(self) -> None:
        self.page.close()
        assert not self.faults
        assert not self.foreign


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 390])
@pytest.mark.parametrize("name", DATA)
def test_a_report_is_silent_alone_and_no_wider_than_the_page(
    browser: Any, reports: dict[str, Path], name: str, width: int, scheme: str
) -> None:
    assert reports[name].stat().st_size < 4_000_000
    tab = Tab(browser, reports[name], width=width, scheme=scheme)
    charts, figures = tab.page.locator("svg.drawn").count(), tab.page.locator("figure").count()
    assert figures == charts + tab.page.locator(".space").count() >= 5
    tab.moving()
    assert tab.page.evaluate("document.documentElement.scrollWidth") <= width
    colours = tab.page.evaluate("getComputedStyle(document.body).backgroundColor")
    light = sum(int(part) for part in re.findall(r"\d+", colours)[:3]) > 3 * 128
    assert light is (scheme == "light")
    tab.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 390])
@pytest.mark.parametrize("name", DATA)
def test_axe_has_nothing_grave_to_say(
    browser: Any, reports: dict[str, Path], name: str, width: int, scheme: str
) -> None:
    tab = Tab(browser, reports[name], width=width, scheme=scheme)
    tab.moving()
    assert grave_findings(tab.page) == []
    tab.close()


@pytest.mark.parametrize("name", DATA)
def test_numbers_are_within_reach_of_mouse_and_keys(
    browser: Any, reports: dict[str, Path], name: str
) -> None:
    tab = Tab(browser, reports[name])
    for figure in tab.page.locator("figure:has(svg.drawn)").all():
        drawn, tip = figure.locator("svg.drawn"), figure.locator(".plot .tip")
        drawn.focus()
        tab.page.keyboard.press("ArrowRight")
        assert re.search(r"\w", tip.inner_text())
        assert figure.locator("[aria-live]").inner_text()
        tab.page.keyboard.press("Escape")
        assert tip.is_hidden()
    curve = tab.page.locator("#frf svg.drawn")
    box = curve.bounding_box()
    curve.hover(position={"x": box["width"] / 2, "y": box["height"] / 2})
    shown = tab.page.locator("#frf .tip").inner_text()
    assert re.search(r"frequency \[Hz\] \d", shown) and re.search(r"fit: \d", shown)
    tab.close()


def test_a_point_of_the_shapes_says_where_it_is(browser: Any, reports: dict[str, Path]) -> None:
    tab = Tab(browser, reports["glider"])
    tab.moving()
    tab.page.locator("#play").click()
    canvas = tab.page.locator("canvas").first
    box = canvas.bounding_box()
    tip = tab.page.locator(".space .tip")
    places = [(i / 24, k / 24) for i in range(4, 21) for k in range(6, 19)]
    for x, y in places:
        canvas.hover(position={"x": x * box["width"], "y": y * box["height"]})
        if tip.is_visible():
            break
    assert re.match(r"point \d+ at [-\d.e]+, [-\d.e]+, [-\d.e]+ m: ", tip.inner_text())
    tab.close()


def test_a_structure_of_the_users_own_stands_in_space(browser: Any, reports: dict[str, Path]) -> None:
    tab = Tab(browser, reports["standing"])
    place = tab.page.locator("#place")
    place.scroll_into_view_if_needed()
    canvas = place.locator("canvas[data-fps], canvas")
    canvas.wait_for(timeout=60_000)
    tab.page.wait_for_timeout(500)
    box, tip = canvas.bounding_box(), place.locator(".tip")
    for x, y in [(i / 30, k / 30) for i in range(4, 27) for k in range(4, 27)]:
        canvas.hover(position={"x": x * box["width"], "y": y * box["height"]})
        if tip.is_visible():
            break
    assert re.match(r"point \d+ at ", tip.inner_text())
    tab.close()


def test_the_data_of_a_figure_are_its_numbers(browser: Any, reports: dict[str, Path], tmp_path: Path) -> None:
    tab = Tab(browser, reports["plate"])
    with tab.page.expect_download() as started:
        tab.page.locator("#frf").get_by_role("button", name="Data (CSV)").click()
    started.value.save_as(tmp_path / "frf.csv")
    rows = list(csv.reader((tmp_path / "frf.csv").read_text(encoding="utf-8").splitlines()))
    assert rows[0][:3] == ["series", "frequency [Hz]", "|H| [1/kg]"]
    processed = read([ROOT / "sample_data" / "plate_dry" / "plate_dry.uff"])
    frfs = processed.identify(band=(5.0, 1000.0)).frfs
    own = {float(f): float(v) for f, v in zip(frfs.frequency, abs(frfs.values[0]), strict=True)}
    name = re.compile(rf"{re.escape(f'{frfs.responses[0]} / {frfs.references[0]}, ')}.* left: measured")
    found = [(float(x), float(y)) for series, x, y, *_ in rows[1:] if name.fullmatch(series) and y]
    assert len(found) >= 300
    for x, y in found[:: len(found) // 20]:
        nearest = min(own, key=lambda f, x=x: abs(f - x))
        assert y == pytest.approx(own[nearest], rel=1e-4)
    tab.close()


def test_a_title_that_is_a_script_is_a_title(browser: Any, reports: dict[str, Path]) -> None:
    tab = Tab(browser, reports["glider"])
    assert tab.page.locator("h1").inner_text() == SCRIPT
    assert tab.page.evaluate("window.taken") is None
    tab.close()
