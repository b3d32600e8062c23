"""Files of any kind as one record of what they hold."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from acquisition import (
    FrfSet,
    Geometry,
    HammerTest,
    InputError,
    Layout,
    ModalData,
    UffContent,
    installed_readers,
    read_layout,
    read_mat,
    read_modes,
    read_test,
    read_uff,
    written_as_uff,
)
from acquisition.modes.read import TABLES
from acquisition.readers import WRITE_LAYOUT
from modalkit.workflow.joining import together

MODES = {False: (*TABLES, ".json"), True: (".json",)}
"""Endings of files of modes; with a layout, a table is column text."""

FEW, EVEN = 8, 0.01
"""So many steps of frequency or more that differ by less than this part are those of lines: modes never lie that even.
Doubled, tables of nine modes of a taut string would still be modes, whose steps differ by more than 1 % [-]."""

Progress = Callable[[float], None]


def read_files(
    paths: Path | str | Sequence[Path | str],
    *,
    layout: Path | str | None = None,
    progress: Progress | None = None,
) -> UffContent:
    """Read files of any known kind into one record of what they hold.

    Parameters
    ----------
    paths : path or sequence of paths
        The files.
    layout : path, optional
        Layout of column text.
    progress : function, optional
        Called with the part of UFF files that is read, from 0 to 1.
    """
    files = [Path(p) for p in ([paths] if isinstance(paths, str | Path) else paths)]
    uff = [p for p in files if written_as_uff(p)]
    plan = None if layout is None else read_layout(layout)
    modes = [p for p in files if p not in uff and _of_modes(p, plan)]
    others = [p for p in files if p not in uff and p not in modes]
    content = read_uff(uff, progress=progress) if uff or not files else UffContent()
    content = _with_modes(content, modes, plan)
    if not others:
        return content
    found = read_test(others, layout=plan)
    geometry = next(
        (g for g in (content.geometry, *(f.geometry for f in found)) if g.nodes), content.geometry
    )
    tests = [*content.tests, *(t for t in found if isinstance(t, HammerTest))]
    sets = [s for s in (content.frfs, *found) if isinstance(s, FrfSet)]
    modal = [m for m in (content.modal, *found) if isinstance(m, ModalData)]
    if len(modal) > 1:
        raise InputError(f"{others[-1]}: {_SEVERAL}")
    return replace(
        content,
        modal=modal[0] if modal else None,
        tests=tuple(t if t.geometry.nodes else replace(t, geometry=geometry) for t in tests),
        frfs=_placed(together(sets), geometry) if sets else None,
        geometry=geometry,
    )


_SEVERAL = (
    "these files were read as tables of modes, of which a test has one; for hits or FRFs add --layout "
    f"({WRITE_LAYOUT}), and to compare two tables use `modalkit correlate`"
)


def _of_modes(path: Path, layout: Layout | None) -> bool:
    ending = path.suffix.lower()
    if layout is not None and layout.mat is not None and not layout.mat.frfs and ending == ".mat":
        return True
    return ending in MODES[layout is not None] and ending not in installed_readers()


def _with_modes(content: UffContent, paths: Sequence[Path], layout: Layout | None) -> UffContent:
    """Add the modes of a table or a JSON file.

    Raises
    ------
    InputError
        If it cannot be read, or there are modes already.
    """
    if not paths:
        return content
    if len(paths) > 1 or content.modal is not None:
        raise InputError(f"{paths[-1]}: {_SEVERAL}")
    modal = _modes(paths[0], layout)
    return replace(
        content, modal=modal, geometry=content.geometry if content.geometry.nodes else modal.geometry
    )


def _modes(path: Path, layout: Layout | None) -> ModalData:
    """Read a file of modes that was not named as one.

    Raises
    ------
    InputError
        If it cannot be read, or is a table of FRFs: evenly spaced frequencies are lines.
    """
    if layout is not None and path.suffix.lower() == ".mat":
        found = read_mat(path, layout)
        assert isinstance(found, ModalData)
        return found
    try:
        modal = read_modes(path)
        steps = np.diff(modal.frequency)
        if len(steps) >= FEW and np.ptp(steps) < EVEN * np.abs(steps).max():
            raise InputError(f"{path}: {len(modal)} evenly spaced frequencies are spectral lines, not modes")
        return modal
    except InputError as error:
        if path.suffix.lower() not in TABLES or not path.is_file():
            raise
        raise InputError(
            f"{error}; if it is column text of hits or FRFs, give its layout file with rate, units and points: "
            f"{WRITE_LAYOUT} (docs/howto/column_text.md)"
        ) from error


def _placed(frfs: FrfSet, geometry: Geometry) -> FrfSet:
    return frfs if frfs.geometry.nodes else replace(frfs, geometry=geometry)
