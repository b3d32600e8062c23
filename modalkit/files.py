"""Files of any kind as one record of what they hold."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from acquisition import (
    FrfSet,
    Geometry,
    HammerTest,
    UffContent,
    read_test,
    read_uff,
    written_as_uff,
)
from modalkit.joining import together

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
    others = [p for p in files if p not in uff]
    content = read_uff(uff, progress=progress) if uff or not others else UffContent()
    if not others:
        return content
    found = read_test(others, layout=layout)
    geometry = next(
        (g for g in (content.geometry, *(f.geometry for f in found)) if g.nodes), content.geometry
    )
    tests = [*content.tests, *(t for t in found if isinstance(t, HammerTest))]
    sets = [s for s in (content.frfs, *found) if isinstance(s, FrfSet)]
    return replace(
        content,
        tests=tuple(t if t.geometry.nodes else replace(t, geometry=geometry) for t in tests),
        frfs=_placed(together(sets), geometry) if sets else None,
        geometry=geometry,
    )


def _placed(frfs: FrfSet, geometry: Geometry) -> FrfSet:
    return frfs if frfs.geometry.nodes else replace(frfs, geometry=geometry)
