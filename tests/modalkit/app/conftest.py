"""A study that may be written beside, for every test of the app."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from driven import CHROMIUM, Served
from opening import FAINT

from acquisition import Dof, FrfSet, write_uff

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def samples(tmp_path: Path) -> Path:
    """Return a copy of the sample data that may be written to."""
    for name in ("beam_dry", "beam_joint"):
        shutil.copytree(ROOT / "sample_data" / name, tmp_path / "samples" / name)
    return tmp_path / "samples"


@pytest.fixture
def beam(samples: Path) -> Path:
    """Return the study of a beam with hits and a model."""
    return samples / "beam_dry" / "study.toml"


@pytest.fixture
def faint(tmp_path: Path, rng: np.random.Generator) -> Path:
    """Return a file of FRFs whose middle mode the noise all but hides."""
    lines = np.arange(1.0, 601.0)
    s, count = 2j * np.pi * lines, 6
    values = np.zeros((count, len(lines)), complex)
    for hertz, size in ((110.0, 1.0), (FAINT, 0.0006), (430.0, 1.0)):
        w, shape = 2 * np.pi * hertz, rng.standard_normal(count)
        values += size * np.outer(shape, s**2 / (s**2 + 0.01 * w * s + w**2))
    noise = 0.1 * rng.standard_normal((10, 2, *values.shape))
    each = values + noise[:, 0] + 1j * noise[:, 1]
    frfs = FrfSet(
        lines,
        each.mean(axis=0),
        tuple(Dof(i + 1, 3) for i in range(count)),
        tuple(Dof(1, 3) for _ in range(count)),
    )
    path = tmp_path / "faint.uff"
    write_uff(path, frfs=frfs)
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    sync = pytest.importorskip("playwright.sync_api", reason="no playwright here")
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
    shutil.copytree(ROOT / "sample_data" / "beam_dry", folder / "beam_dry")
    served = Served(folder / "beam_dry" / "study.toml")
    yield served
    served.kill()
