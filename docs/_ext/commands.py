"""Run what stands on the pages, and compare it with what is written there.

``python docs/_ext/commands.py`` compares all pages and README; ``--refresh`` puts in what is printed now; ``--slow``
runs the long ones too; paths name single pages. Each page runs in a folder of its own, ``docs/made/PAGE``, with copies
of ``sample_data`` and ``examples``: figures that its commands make are shown from there.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from blocks import Block, blocks, page_name, renewed, same
from made import renewed as renewed_made

ROOT = Path(__file__).resolve().parents[2]
MADE = ROOT / "docs" / "made"
LONGEST = 900.0
"""A command that runs longer hangs [s]."""

FIGURES = ("five_minutes/figures/diagnosis.png", "tutorials/app/figures/app.png")
"""Figures made by a build that are kept for those who read without one: README's, and what needs a browser."""

FRONT_DIFFERS = (
    "README.md: docs/figures/diagnosis.png shows something else now; docs/_ext/commands.py --refresh"
)

UNLIKE = 5.0
"""Mean difference, of 255, from which on the pixels of two figures are another result. Digits on another processor that
move the words of the title make 3, a blank page 11; what the figure states in words is compared on the page."""


@dataclass(frozen=True)
class Outcome:
    """What a block prints now.

    Parameters
    ----------
    page : Path
    block : Block
    printed : str
        The whole body as it would be written now.
    agrees : bool
        Whether that is what stands there.
    seconds : float
    """

    page: Path
    block: Block
    printed: str
    agrees: bool
    seconds: float

    def message(self) -> str:
        """Return where the page is wrong, and what is printed."""
        return f"{self.page}:{self.block.line}: prints something else now:\n{self.printed}"


def pages(root: Path = ROOT) -> list[Path]:
    """Return all pages whose blocks are run."""
    found = sorted(path for path in (root / "docs").rglob("*.md") if "made" not in path.parts)
    return [root / "README.md", *found]


def run_pages(chosen: Iterable[Path], *, slow: bool = False, workers: int = 2) -> list[Outcome]:
    """Run pages, each in a process of its own."""
    os.environ.pop(
        "PYTHONDONTWRITEBYTECODE", None
    )  # a command takes seconds longer where it must compile anew
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn"), max_tasks_per_child=1) as pool:
        jobs = [pool.submit(run_page, page, slow=slow) for page in chosen]
        return [outcome for job in jobs for outcome in job.result()]


def run_page(page: Path, *, slow: bool = False) -> list[Outcome]:
    """Run the blocks of a page in their order, in a folder of its own."""
    found = list(blocks(page.read_text(encoding="utf-8")))
    if not any(block.kind in ("console", "python") and block.runs(slow=slow) for block in found):
        return []
    folder = MADE / page_name(page, ROOT)
    _prepare(folder)
    os.chdir(folder)
    os.environ.update(_environment(folder))
    sys.dont_write_bytecode = False
    sys.path.insert(0, str(folder))
    names: dict[str, object] = {"__name__": "page"}
    return [outcome for block in _with_printed(found) for outcome in _run(page, block, names, slow=slow)]


def _prepare(folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in ("sample_data", "examples"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", ".modalkit"))
    shutil.copytree(ROOT / "docs" / "_ext" / "drawings", folder / "drawings")


def _environment(folder: Path) -> dict[str, str]:
    """Return what is set for all commands alike: ours come first, one BLAS thread, a cache of the page's own."""
    return {
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
        "MODALKIT_CACHE": str(folder / ".cache"),
        "MPLBACKEND": "agg",
        "MODALKIT_PROGRESS": "off",
        "COLUMNS": "120",
        "NO_COLOR": "1",
    }


def _with_printed(found: list[Block]) -> list[tuple[Block, Block | None]]:
    """Pair each block with the one that holds what it prints."""
    after = [*found[1:], None]
    return [(b, n if n and n.mark == "printed" else None) for b, n in zip(found, after, strict=True)]


def _run(
    page: Path, pair: tuple[Block, Block | None], names: dict[str, object], *, slow: bool
) -> list[Outcome]:
    block, printed = pair
    begun = time.perf_counter()
    if block.file:
        Path(block.file).write_text(block.body, encoding="utf-8")
    elif block.kind == "console" and block.runs(slow=slow):
        now, agrees = _console(block)
        return [Outcome(page, block, now, agrees, time.perf_counter() - begun)]
    elif block.kind == "python" and block.runs(slow=slow):
        text = _python(page, block, names)
        if printed is not None or text.startswith("Traceback"):
            target = printed or block
            agrees = printed is not None and same(printed.body, text)
            now = text if printed is None else renewed(printed.body, text)
            return [Outcome(page, target, now, agrees, time.perf_counter() - begun)]
    return []


def _console(block: Block) -> tuple[str, bool]:
    now, agrees = "", True
    for command, written in block.commands():
        done = subprocess.run(
            ["bash", "-c", command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=LONGEST,
            check=False,
        )
        agrees = agrees and same(written, done.stdout)
        now += f"$ {command}\n" + (renewed(written, done.stdout) if done.stdout.strip() else "")
    return now, agrees


def _python(page: Path, block: Block, names: dict[str, object]) -> str:
    """Execute a block and return what it prints; an error is what it prints, too."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            exec(compile(block.body, f"{page.name}:{block.line}", "exec"), names)
        except Exception as error:  # noqa: BLE001 - whatever it is, the page is wrong
            return f"Traceback: {type(error).__name__}: {error}"
    return out.getvalue()


def refresh(outcomes: Iterable[Outcome]) -> None:
    """Put what is printed now into the pages."""
    last_first = sorted(outcomes, key=lambda o: (str(o.page), -o.block.span[0]))
    for outcome in last_first:
        if not outcome.agrees and outcome.block.kind != "python":
            text = outcome.page.read_text(encoding="utf-8")
            start, end = outcome.block.span
            if text[start:end] != outcome.block.body:  # somebody wrote on the page meanwhile
                continue
            outcome.page.write_text(text[:start] + outcome.printed + text[end:], encoding="utf-8")


def renew_made(chosen: Iterable[Path]) -> None:
    """Make the kept parts of pages of reference anew."""
    from reference import MAKERS

    for page in chosen:
        text = page.read_text(encoding="utf-8")
        if (now := renewed_made(text, MAKERS)) != text:
            page.write_text(now, encoding="utf-8")


def keep_figures() -> None:
    """Lay the figures of README and of the app where they are looked for without a build."""
    for page in FIGURES:
        made = MADE / page
        if made.exists():
            shutil.copy(made, ROOT / "docs" / "figures" / made.name)


def front_figure_differs() -> bool:
    """Tell whether the figure of README shows something else than the one just made."""
    made = MADE / FIGURES[0]
    now, before = (255.0 * plt.imread(path) for path in (made, ROOT / "docs" / "figures" / made.name))
    return now.shape != before.shape or float(np.abs(now - before).mean()) > UNLIKE


def main() -> int:
    """Compare or refresh; return 1 where a page is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pages", nargs="*", type=Path)
    parser.add_argument("--refresh", action="store_true")
    parser.add_argument("--slow", action="store_true")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    chosen = [page.resolve() for page in given.pages] or pages()
    outcomes = run_pages(chosen, slow=given.slow, workers=given.workers)
    wrong = [outcome for outcome in outcomes if not outcome.agrees]
    for outcome in outcomes:
        sys.stdout.write(f"{outcome.seconds:6.1f} s  {outcome.page.name}:{outcome.block.line}\n")
    for outcome in wrong:
        sys.stdout.write(outcome.message() + "\n")
    if given.refresh:
        refresh(wrong)
        renew_made(chosen)
        keep_figures()
        return 0
    if not given.pages and front_figure_differs():
        sys.stdout.write(f"{FRONT_DIFFERS}\n")
        return 1
    return min(1, len(wrong))


if __name__ == "__main__":
    sys.exit(main())
