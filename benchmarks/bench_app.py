"""Latency of the app: from a pick to its picture and to its last digits, of a drop, an undo, and of sliders.

25 outputs of one reference, order 100. Beside each stands the identification from the beginning that it replaces, in
one run. What the server does is measured, its document as JSON included; drawing adds what the browser takes.
"""

from __future__ import annotations

import json
import resource
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from common import synthetic
from threadpoolctl import threadpool_limits

from acquisition import write_uff
from acquisition.errors import ModalkitError
from identification import identify
from modalkit import read
from modalkit.app.controller import Controller
from modalkit.app.model_page import Moved
from modalkit.app.opened import open_path
from modalkit.app.store import Store
from modalkit.output.whole import plain

OUTPUTS, LINES, ORDER, PICKS = 25, 1025, 100, 100
ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "modalkit" / "report"))
from glider import make_glider  # noqa: E402


def timed(work: Callable[[], Any]) -> tuple[float, float]:
    """Return how long a piece of work takes, its document included: by the clock and of the processor [ms]."""
    clock, processor = time.perf_counter(), time.process_time()
    json.dumps(plain(work()))
    return 1e3 * (time.perf_counter() - clock), 1e3 * (time.process_time() - processor)


def row(name: str, times: list[tuple[float, float]]) -> None:
    clock, processor = zip(*times, strict=True)
    print(
        f"{name:42} clock {statistics.median(clock):6.0f} (worst {max(clock):6.0f}) ms, processor "
        f"{statistics.median(processor):6.0f} (worst {max(processor):6.0f}) ms, {len(times)} times"
    )


def opened(path: Path) -> Controller:
    return Controller(open_path(path), Store.beside(path))


def picks(folder: Path, rng: np.random.Generator) -> None:
    """Pick anywhere, drop and take back every mode."""
    path = folder / "test.uff"
    write_uff(path, frfs=synthetic(OUTPUTS, LINES, rng))
    controller, frfs = opened(path), read(path).frfs
    controller.act("order", {"order": ORDER})
    modes = [mode["frequency_hz"] for mode in plain(controller.modes())["table"]]
    row("identify, from the beginning", [timed(lambda: len(identify(frfs, order=ORDER))) for _ in range(5)])
    row(
        "pick, to its picture",
        [timed(lambda h=h: controller.provisional(h, 0)) for h in rng.uniform(30, 980, PICKS)],
    )
    dropped, undone, picked = [], [], []
    for hertz in modes:
        dropped.append(timed(lambda h=hertz: [controller.act("drop", {"hertz": h}), controller.modes()]))
        undone.append(timed(lambda: [controller.step(back=True), controller.modes()]))
    for hertz in rng.uniform(30, 980, PICKS):
        try:
            picked.append(timed(lambda h=hertz: [controller.act("pick", {"hertz": h}), controller.modes()]))
        except ModalkitError:  # no mode can be kept there
            continue
        controller.step(back=True)
    row("pick, to its last digits", picked)
    row("drop, to its last digits", dropped)
    row("undo", undone)


def sliders(folder: Path) -> None:
    """Move the modulus of a beam, and that of a region of a structure whose shapes disagree with its test's."""
    shutil.copytree(ROOT / "sample_data" / "beam_dry", folder / "beam")
    for name, study, factor in (
        ("a beam", folder / "beam" / "study.toml", "E"),
        ("a glider of 65 points", make_glider(folder / "glider"), "wing_left_outer.E"),
    ):
        controller = opened(study)
        controller.model()
        sizes = np.linspace(0.8, 1.2, 100)
        moved = [timed(lambda e=e, c=controller, f=factor: c.moved(Moved((), {f: e}), 0)) for e in sizes]
        row(f"slider of {name}", moved)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder, threadpool_limits(1, user_api="blas"):  # as the command
        picks(Path(folder), np.random.default_rng(0))
        sliders(Path(folder))
    print(f"largest memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
