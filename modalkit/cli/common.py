"""What every command shares: printing, progress, tables."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from acquisition.display import formats
from acquisition.errors import InputError
from acquisition.warned import in_order
from modalkit.cli.progress import working
from modalkit.workflow.stages import DRAWING

if TYPE_CHECKING:
    import pandas as pd

_LONGEST_NAME = 1000  # characters of a path; a longer text of a study is none
_MOST_WORKERS = 1000
_PIPE_WIDTH = 160  # characters a table may take where no terminal states its width

out = Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else _PIPE_WIDTH)


def is_study(path: Path) -> bool:
    """Tell a study file from a data file, by its ending."""
    return path.suffix.lower() == ".toml"


def names_of(text: str) -> tuple[str, ...]:
    """Return the names in a list with commas between them."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def read_by(files: Sequence[Path], *more: Path | None) -> Iterator[Path]:
    """Yield every file that a command reads: those given, and of a study all that it names.

    Parameters
    ----------
    files : sequence of Path
        Data files and studies.
    *more : Path or None
        Further ones.

    Raises
    ------
    StudyError
        If a study cannot be read.
    """
    yield from (path for path in (*files, *more) if path is not None)
    for path in filter(is_study, files):
        from modalkit.study.read import read_study

        study = read_study(path)
        yield from study.inputs()
        yield from (study.file(name) for name in _texts(study.model_dump(mode="json")))


def _texts(value: Any) -> Iterator[str]:
    """Yield the short texts in the tables of a study, some of which are names of files."""
    if isinstance(value, str) and len(value) < _LONGEST_NAME and "\0" not in value:
        yield value
    elif isinstance(value, dict):
        yield from (text for one in value.values() for text in _texts(one))
    elif isinstance(value, list):
        yield from (text for one in value for text in _texts(one))


def check_once(studies: Sequence[Path]) -> None:
    """Refuse a study that is given twice.

    Raises
    ------
    InputError
        If one is.
    """
    seen: set[Path] = set()
    for path in studies:
        if path.resolve() in seen:
            raise InputError(f"{path}: given twice; the same test adds no information")
        seen.add(path.resolve())


def check_workers(workers: int) -> None:
    """Refuse a number of processes that no machine should have to bear.

    Raises
    ------
    InputError
        If there are none, or more than 1000.
    """
    if workers < 1:
        raise InputError(f"--workers {workers}: at least 1 is needed")
    if workers > _MOST_WORKERS:
        raise InputError(f"--workers {workers}: at most {_MOST_WORKERS}, each is a process of 200 MB")


def show_table(frame: pd.DataFrame, title: str = "", *, digits: dict[str, int] | None = None) -> None:
    """Print a table; columns of numbers to the right, with the given number of decimals.

    A column with a standard deviation behind it has the decimals that this determines, whatever is given.
    """
    known = formats(frame)
    table = Table(
        title=escape(title) or None, title_justify="left", box=None, pad_edge=False, header_style="bold"
    )
    named = frame.index.name is not None
    if named:
        table.add_column(escape(str(frame.index.name)), justify="right")
    for column in frame.columns:
        numeric = frame[column].dtype.kind in "biufc"
        table.add_column(escape(str(column)), justify="right" if numeric else "left")
    for index, row in zip(frame.index, frame.itertuples(index=False), strict=True):
        cells = [
            _cell(value, (digits or {}).get(str(c)), known.get(str(c)))
            for c, value in zip(frame.columns, row, strict=True)
        ]
        table.add_row(*map(escape, [str(index)] if named else []), *map(escape, cells))
    out.print(table)
    out.print()


def _cell(value: Any, digits: int | None, known: Callable[[float], str] | None = None) -> str:
    if isinstance(value, float):
        if math.isnan(value):
            return "-"
        if known is not None:
            return known(value)
        return f"{value:.{digits}f}" if digits is not None else f"{value:.4g}"
    return str(value)


def show_warnings(warnings: Sequence[str]) -> None:
    """Print warnings, each on a line of its own, those that change a number first."""
    for warning in in_order(warnings):
        out.print(f"warning: {warning}", style="yellow", markup=False)


def check_folder(path: Path | None) -> None:
    """See that a folder could be made or written to, before work begins whose result would be lost; None is none.

    Raises
    ------
    InputError
        If a file stands there, or where its folder should be, or it cannot be written to.
    """
    if path is None:
        return
    there = next(p for p in (path, *path.absolute().parents) if p.exists())
    if not there.is_dir():
        raise InputError(f"{path}: {'is a file' if there == path else f'{there} is a file'}; name a folder")
    if not os.access(there, os.W_OK):
        raise InputError(f"{path}: cannot be written (read-only); name another folder")


def show_figures(folder: Path | None, build: Callable[[], dict[str, Any]]) -> None:
    """Draw and save figures if a folder is given, and say where they are."""
    if folder is None:
        return
    from modalkit.figures import save_figures

    with drawing():
        for path in save_figures(build(), folder):
            out.print(f"figure: {path}", markup=False)


@contextmanager
def drawing(stage: str = DRAWING) -> Iterator[None]:
    """Show that figures are drawn, as on every machine: a ``matplotlibrc`` in the current folder is not followed.

    Parameters
    ----------
    stage : str
        What is shown.
    """
    from matplotlib import style

    with working(stage), style.context("default", after_reset=True):
        yield
