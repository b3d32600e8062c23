"""Results in a notebook: the report's drawings in a frame, without anything of a notebook being there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from figure_cases import model_of
from glider import make_glider
from report_pages import Reader, complete, data_of
from test_localisation_figure import diagnosis_with

import modalkit
from acquisition import InputError, ModalData
from modalkit.notebook import Drawn

ROOT = Path(__file__).resolve().parents[2]
CHROMIUM = os.environ.get("MODALKIT_CHROMIUM") or shutil.which("chromium")


@pytest.mark.long
def test_a_diagnosis_shows_itself_with_and_without_its_study() -> None:
    made = complete(diagnosis_with("beam", "class"))
    drawn = made.show()
    assert isinstance(drawn, Drawn)
    assert [c["name"] for c in data_of(drawn.page)["charts"]] == ["gap", "causes", "closing"]
    session = modalkit.open_study(ROOT / "sample_data" / "beam_dry" / "study.toml")
    charts = [c["name"] for c in data_of(made.show(session).page)["charts"]]
    assert charts == ["gap", "place", "causes", "closing", "frfs"]


@pytest.mark.long
def test_modes_show_and_move() -> None:
    model = model_of(12)
    charts = {c["name"] for c in data_of(model.show().page)["charts"]}
    assert charts == {"damping", "frf", "poles", "cmif", "mvmif", "auto-mac"}
    moving = data_of(model.animate().page)["space"]["shapes"]["page"]
    assert len(moving["modes"]) == len(model)
    assert data_of(model.modal.animate().page)["space"]["shapes"]["page"] == moving
    bare = ModalData(frequency=np.array([10.0]), frequency_sigma=np.array([0.1]))
    with pytest.raises(InputError, match="no shapes to move"):
        bare.animate()


@pytest.mark.long
def test_an_update_shows_how_far_it_closed() -> None:
    result = modalkit.update_studies([ROOT / "sample_data" / "beam_dry" / "study.toml"])
    page = result.show().page
    assert [c["name"] for c in data_of(page)["charts"]][:2] == ["gap", "factors"]
    assert "converged" in Reader(page).text


@pytest.mark.long
def test_a_study_moves_beside_its_model() -> None:
    session = modalkit.open_study(ROOT / "sample_data" / "beam_dry" / "study.toml")
    page = data_of(session.animate().page)["space"]["shapes"]["page"]
    assert page["model"] is not None and len(page["modes"]) == 3


@pytest.mark.long
def test_nothing_of_a_notebook_is_loaded_and_the_rooms_below_say_who_draws() -> None:
    code = (
        "import sys, numpy as np\n"
        "from acquisition import InputError, ModalData\n"
        "modes = ModalData(np.array([10.0]), np.array([0.1]))\n"
        "try:\n    modes.animate()\nexcept InputError as error:\n    print(error)\n"
        "import modalkit.notebook\n"
        "print('IPython' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.splitlines() == ["results are drawn by modalkit; import modalkit first", "False"]


def test_a_drawing_is_saved_as_a_report_is(tmp_path: Path) -> None:
    drawn = model_of(1).show()
    drawn.save(tmp_path / "modes.html")
    assert (tmp_path / "modes.html").read_text(encoding="utf-8") == drawn.page
    (tmp_path / "other.html").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="not a report written by modalkit"):
        drawn.save(tmp_path / "other.html")


@pytest.mark.long
@pytest.mark.skipif(CHROMIUM is None, reason="no chromium here: apt-get install chromium")
def test_the_frame_of_a_notebook_draws(tmp_path: Path) -> None:
    sync = pytest.importorskip("playwright.sync_api", reason="no playwright here")
    study = make_glider(tmp_path / "glider")
    modes = modalkit.read(study.parent / "glider.uff").identify(band=(3.0, 60.0))
    assert isinstance(modes, modalkit.ModalModel)
    cells = "".join(drawn._repr_html_() for drawn in (modes.show(), modes.animate()))
    (tmp_path / "notebook.html").write_text(f"<!doctype html><body>{cells}</body>", encoding="utf-8")
    faults: list[Any] = []
    with sync.sync_playwright() as playwright:
        arguments = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        page = browser.new_page()
        page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
        page.goto((tmp_path / "notebook.html").as_uri())
        page.frame_locator("iframe").first.locator("#poles svg.drawn").wait_for(
            state="attached", timeout=60_000
        )
        page.locator("iframe").nth(1).scroll_into_view_if_needed()
        page.frame_locator("iframe").nth(1).locator("canvas[data-fps]").wait_for(timeout=60_000)
        browser.close()
    assert not faults
