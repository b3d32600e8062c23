"""Fixtures that every room's tests share."""

from __future__ import annotations

import importlib
import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

os.environ.setdefault(
    "OPENBLAS_NUM_THREADS", "1"
)  # before numpy: two threads are slower on small eigenproblems
# a process that a test starts takes seconds longer where it must compile every module anew
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

import numpy as np
import pytest
from hypothesis import settings

settings.register_profile("untimed", deadline=None)  # how long an example takes depends on what else runs
settings.load_profile("untimed")

SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--long", action="store_true", help="also run the tests marked long")
    parser.addoption("--slow", action="store_true", help="also run the tests marked long or slow")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    slow = config.getoption("--slow")
    asked = {"slow": slow, "long": slow or config.getoption("--long")}
    for item in items:
        for mark, wanted in asked.items():
            if mark in item.keywords and not wanted:
                item.add_marker(pytest.mark.skip(reason=f"{mark}: run with --{mark}"))


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep what CalculiX makes in a folder of the tests' own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MODALKIT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def example_of() -> Callable[[Path, str], ModuleType]:
    """Return a function that imports a script of a folder; folders may have scripts of the same name."""
    known: dict[Path, dict[str, ModuleType]] = {}

    def load(folder: Path, name: str) -> ModuleType:
        own = known.setdefault(folder, {})
        names = [path.stem for path in folder.glob("*.py")]
        others = {n: sys.modules.pop(n) for n in names if n in sys.modules}
        sys.modules.update(own)
        with pytest.MonkeyPatch.context() as patch:
            patch.syspath_prepend(str(folder))
            try:
                return importlib.import_module(name)
            finally:
                own.update({n: sys.modules.pop(n) for n in names if n in sys.modules})
                sys.modules.update(others)

    return load


@pytest.fixture
def shared_data() -> Callable[[str], Path]:
    """Return a function that finds a file of real measurements, or skips the test."""

    def find(relative: str) -> Path:
        path = SHARED / relative
        if not path.exists():
            pytest.skip(f"the real measurements are not here: {relative}")
        return path

    return find


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20260101)


@pytest.fixture
def run(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Return a function that runs a command and returns its exit code, what it prints, and its messages."""
    from modalkit.cli import main

    def call(*arguments: str | Path) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["modalkit", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        text = capfd.readouterr()
        return int(ended.value.code or 0), text.out, text.err

    return call


HANG = 60.0
"""CPU time after which what takes milliseconds hangs [s]: work that grows as the square of the input takes minutes."""


@pytest.fixture
def no_hang() -> Iterator[None]:
    """End a test that hangs; it is no measure of speed."""

    def stop(_signal: int, _frame: object) -> None:
        raise AssertionError(f"it still runs after {HANG:g} s of CPU time")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, HANG)
    yield
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    signal.signal(signal.SIGVTALRM, before)
