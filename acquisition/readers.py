"""One door for every kind of file: readers by file ending, the user's own among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from acquisition.columns import Layout, read_columns, read_frf_columns, read_layout
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.mat.read import read_mat
from acquisition.modal_data import ModalData
from acquisition.own_readers import Found, Reader, installed_readers, read_by, with_dot
from acquisition.recorders import ENDINGS, is_recorded
from acquisition.uff import UffContent, read_uff

UFF = frozenset({".uff", ".unv", ".uf", ".bunv"})
"""Endings of universal files."""
COLUMNS = frozenset({".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm"})
"""Endings of column text."""
WRITE_LAYOUT = "`modalkit inspect FILES --write-layout layout.toml` writes one to correct"


def read_test(
    paths: Path | str | Sequence[Path | str],
    *,
    layout: Layout | Path | str | None = None,
    readers: Mapping[str, Reader] | None = None,
) -> list[Found]:
    """Read files of any known kind.

    Parameters
    ----------
    paths : path or sequence of paths
        The files. UFF files are read together as one test, and so are files of column text.
    layout : Layout or path, optional
        Rate, units and points of column text; see docs/howto/column_text.md. It makes any file without a reader of its
        own column text.
    readers : mapping of str to function, optional
        Further readers by file ending (``{".abc": read_abc}``); they come before all others.

    Returns
    -------
    list of HammerTest, FrfSet or ModalData
        What the files hold, in the order own readers, UFF, column text; modes are read by own readers alone, all other
        files of modes by `read_modes`.

    Raises
    ------
    InputError
        If no reader is known for a file, it cannot be read, or nothing in the files can be used.
    """
    files = [Path(p) for p in ([paths] if isinstance(paths, str | Path) else paths)]
    own = {**installed_readers(), **{with_dot(k): v for k, v in (readers or {}).items()}}
    special = [f for f in files if f.suffix.lower() in own]
    rest = [f for f in files if f not in special]
    uff = [f for f in rest if f.suffix.lower() in UFF or written_as_uff(f)]
    text = [f for f in rest if f not in uff]
    unknown = [f for f in text if layout is None]
    if unknown:
        raise InputError(f"{unknown[0]}: {_advice(unknown[0], own)}")
    content = UffContent()
    found: list[Found] = [read_by(own[f.suffix.lower()], f) for f in special]
    if uff:
        content = read_uff(uff)
        found += [*content.tests, *([] if content.frfs is None else [content.frfs])]
    if text and layout is not None:
        plan = layout if isinstance(layout, Layout) else read_layout(layout)
        if plan.mat is not None:
            found += [_frfs_of_mat(f, plan) for f in text]
            text = []
    if text and layout is not None:
        found.append(
            read_frf_columns(text, plan) if plan.frequency_column is not None else read_columns(text, plan)
        )
    if not found:
        raise InputError(_nothing(files, content))
    return found


def _frfs_of_mat(path: Path, layout: Layout) -> FrfSet:
    found = read_mat(path, layout)
    if isinstance(found, ModalData):
        raise InputError(f"{path}: {layout.source} names modes; for FRFs give frfs in its [mat]")
    return found


def _nothing(files: Sequence[Path], content: UffContent) -> str:
    """State why universal files gave neither hits nor FRFs."""
    bad = [d.fault for d in content.datasets if not d.ok]
    why = bad[0] if bad else next(iter(content.warnings), "no time records with a force, and no FRFs, in it")
    return why if bad else f"{', '.join(map(str, files[:3]))}: {why}"


def written_as_uff(path: Path | str) -> bool:
    """Return whether a file is a universal file: by its ending, or because it starts as one does.

    A file that cannot be opened counts as one, so that it is refused with its name.
    """
    path = Path(path)
    if path.suffix.lower() in UFF:
        return True
    if path.suffix.lower() in installed_readers():
        return False
    try:
        with path.open("rb") as file:
            start = file.read(400)
    except OSError:
        return True
    return [line.strip() for line in start.strip().splitlines()[:1]] == [b"-1"]


def _advice(path: Path, own: Mapping[str, Reader]) -> str:
    if path.suffix.lower() == ".mat":
        return (
            "a MATLAB file needs a layout file: a table [mat] names FRFs or modes, [[column]] names time records; see "
            "docs/howto/matlab.md"
        )
    if path.suffix.lower() in COLUMNS:
        needed = "column text needs a layout file with rate, units and points"
        return f"{needed}; {WRITE_LAYOUT} (docs/howto/column_text.md)"
    if is_recorded(path):
        return f"needs a layout file with units and points of its channels; {WRITE_LAYOUT} (docs/howto/recorders.md)"
    known = ", ".join(sorted({*UFF, *COLUMNS, *ENDINGS, *own}))
    return f"no reader for {path.suffix or 'files without ending'}; known are {known}; see docs/howto/own_reader.md"
