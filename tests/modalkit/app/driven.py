"""The app driven in a browser: a process that serves a study, and a tab on it.

Needs Debian's ``chromium`` (or one named by ``MODALKIT_CHROMIUM``); without it tests that use it are skipped.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"
CHROMIUM = os.environ.get("MODALKIT_CHROMIUM") or shutil.which("chromium")
IN_A_BROWSER = [
    pytest.mark.long,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium here: apt-get install chromium"),
]
"""Marks of tests that drive it."""

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


def rms(text: str) -> float:
    """Return the number of a line of the page of the model [%]."""
    return float(text.split(maxsplit=1)[0])


MOVING = "canvas[data-fps]:not([data-fps='0.0'])"
"""The picture of shapes once it has moved."""


NAMELESS = """[...document.querySelectorAll("main button, main input, main select, main textarea, header button")]
  .filter((e) => e.checkVisibility())
  .filter((e) => !(e.textContent.trim() && e.tagName === "BUTTON"))
  .filter((e) => !e.getAttribute("aria-label") && !e.labels?.length)
  .map((e) => e.outerHTML.slice(0, 80))"""
"""Controls that a screen reader could not name."""
