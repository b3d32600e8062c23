"""The page of modes of the app, as a browser shows it; without a browser the picture of the last time."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

KEPT = Path(__file__).resolve().parents[4] / "figures" / "app.png"
MADE = Path("figures") / "app.png"
CHROMIUM = os.environ.get("MODALKIT_CHROMIUM") or shutil.which("chromium")
FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader"]


def photographed(address: str) -> None:
    """Open the page and wait for its charts."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        tab = browser.new_page(viewport={"width": 1100, "height": 980})
        tab.set_default_timeout(120000)
        tab.goto(f"{address}#modes")
        tab.locator(".page-modes tbody tr").first.wait_for()
        tab.locator("#notice.busy").wait_for(state="detached")
        tab.locator(".js-plotly-plot").nth(1).wait_for()
        tab.wait_for_timeout(1000)
        tab.screenshot(path=MADE)
        browser.close()


MADE.parent.mkdir(exist_ok=True)
if CHROMIUM and importlib.util.find_spec("playwright"):
    command = [sys.executable, "-m", "modalkit", "app", "sample_data/beam_dry/study.toml", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            photographed(server.stdout.readline().strip())
        finally:
            server.kill()
else:
    shutil.copy(KEPT, MADE)
