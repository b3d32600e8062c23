"""From files to FRFs to modes: the part of the chain that knows no model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from acquisition import (
    FrfSet,
    HammerTest,
    HitScatter,
    HitVerdict,
    InputError,
    UffContent,
    Windows,
    decide,
    estimate_frfs,
    hits_table,
    judge_hits,
    looks_long,
    read_test,
    read_uff,
    split_hits,
    state_window,
    written_as_uff,
)
from identification import ModalModel, identify
from modalkit.handling import Handling

MAX_UNCOMMON = 1e-6
"""Frequency axes that differ by more than this, relative to their end, do not go together."""

Progress = Callable[[float], None]
AS_READ = Handling()


@dataclass(frozen=True, eq=False)
class Judged:
    """A test with what is thought of its hits.

    Parameters
    ----------
    test : HammerTest
        Records, one a hit.
    verdicts : tuple of HitVerdict
        On each hit, the user's decisions included.
    """

    test: HammerTest
    verdicts: tuple[HitVerdict, ...]


@dataclass(frozen=True, eq=False)
class Processed:
    """A test, turned into FRFs.

    Parameters
    ----------
    content : UffContent
        What the files held.
    frfs : FrfSet
        FRFs, estimated from the hits or read.
    judged : tuple of Judged
        The hits they were estimated from; empty where the files held FRFs.
    handling : Handling
        What the user said.
    warnings : tuple of str
        What the user ought to know.
    """

    content: UffContent
    frfs: FrfSet
    judged: tuple[Judged, ...]
    handling: Handling
    warnings: tuple[str, ...]

    @property
    def hits(self) -> tuple[HitVerdict, ...]:
        """What is thought of every hit."""
        return tuple(v for judged in self.judged for v in judged.verdicts)

    def hits_table(self) -> pd.DataFrame:
        """Return one row per hit, with its verdict."""
        return hits_table(self.hits)

    def identify(
        self,
        *,
        band: tuple[float, float] | None = None,
        order: int | None = None,
        add: Sequence[float] = (),
        drop: Sequence[float] = (),
    ) -> ModalModel:
        """Identify the modes of a band; see :func:`identification.identify`."""
        return identify(self.frfs, band=band, order=order, add=add, drop=drop)


def read(
    path: Path | str | Sequence[Path | str],
    *,
    decay: float = 0.0,
    handling: Handling = AS_READ,
    progress: Progress | None = None,
) -> Processed:
    """Read files as one test and turn hits into FRFs.

    Parameters
    ----------
    path : path or sequence of paths
        The files: UFF, column text with a layout, or what an installed reader knows.
    decay : float
        Decay rate of an exponential window applied before the files were written, where they do not say it
        themselves; short for ``Handling(decay=...)`` [1/s].
    handling : Handling
        All that may be said of how records are treated.
    progress : function, optional
        Called with the part of the files that is read, from 0 to 1.

    Returns
    -------
    Processed

    Raises
    ------
    InputError
        If the files hold neither raw hits nor FRFs.
    """
    handling = replace(handling, decay=decay) if decay else handling
    paths = [Path(p) for p in ([path] if isinstance(path, str | Path) else path)]
    content = read_files(paths, layout=handling.layout, progress=progress)
    warnings = list(content.warnings)
    judged = _judged(content.tests, handling, warnings)
    if judged:
        frfs = _estimated(judged, handling)
        if content.frfs is not None:
            warnings.append("the files hold raw hits and FRFs; the FRFs were made afresh from the hits")
    elif content.frfs is not None:
        frfs = content.frfs
        if handling.decay and not frfs.decay:
            frfs = replace(frfs, decay=handling.decay)
    else:
        names = ", ".join(str(p) for p in paths)
        raise InputError(f"{names}: neither raw hits nor FRFs in it; `modalkit inspect` lists what is")
    return Processed(content, frfs, judged, handling, tuple(dict.fromkeys(warnings)))


def read_files(
    paths: Sequence[Path], *, layout: Path | None = None, progress: Progress | None = None
) -> UffContent:
    """Read files of any known kind into one record of what they hold.

    Parameters
    ----------
    paths : sequence of paths
        The files.
    layout : path, optional
        Layout of column text.
    progress : function, optional
        Called with the part of UFF files that is read, from 0 to 1.
    """
    if all(written_as_uff(p) for p in paths):
        return read_uff(paths, progress=progress)
    found = read_test(paths, layout=layout)
    tests = tuple(t for t in found if isinstance(t, HammerTest))
    sets = [f for f in found if isinstance(f, FrfSet)]
    geometry = next(t.geometry for t in found)
    return UffContent(tests=tests, frfs=together(sets) if sets else None, geometry=geometry)


def _judged(tests: Sequence[HammerTest], handling: Handling, warnings: list[str]) -> tuple[Judged, ...]:
    """Split long records, state the window and judge the hits; decisions go to the test that has the hit."""
    split = []
    for test in tests:
        one = test
        if looks_long(one):
            one, said = split_hits(one)
            warnings += said
        if handling.decay and not one.decay:
            one, said = state_window(one, decay=handling.decay, on=handling.window_on)
            warnings += said
        split.append(one)
    proposals = [judge_hits(test) for test in split]
    every = tuple(v for verdicts in proposals for v in verdicts)
    decided = iter(decide(every, use=handling.use, leave=handling.leave))
    return tuple(
        Judged(test, tuple(next(decided) for _ in verdicts))
        for test, verdicts in zip(split, proposals, strict=True)
    )


def _estimated(judged: Sequence[Judged], handling: Handling) -> FrfSet:
    windows = Windows(decay=handling.window) if handling.window else None
    return together(
        [
            estimate_frfs(j.test, estimator=handling.estimator, verdicts=j.verdicts, windows=windows)
            for j in judged
        ]
    )


def together(sets: Sequence[FrfSet]) -> FrfSet:
    """Join FRF sets on one frequency axis.

    Raises
    ------
    InputError
        If their axes, forms or windows differ.
    """
    first = sets[0]
    for other in sets[1:]:
        same = len(other.frequency) == len(first.frequency) and np.allclose(
            other.frequency, first.frequency, rtol=MAX_UNCOMMON, atol=0
        )
        if not same or other.form != first.form or other.decay != first.decay:
            raise InputError(
                f"{first.source}: the hits were recorded with different rates, lengths or quantities; "
                "process them as separate tests"
            )
    if len(sets) == 1:
        return first
    joined = {
        name: None
        if any(getattr(s, name) is None for s in sets)
        else np.concatenate([getattr(s, name) for s in sets])
        for name in ("values", "coherence", "variance", "averages")
    }
    return replace(
        first,
        responses=tuple(d for s in sets for d in s.responses),
        references=tuple(d for s in sets for d in s.references),
        scatter=HitScatter.joined([s.scatter for s in sets], [len(s.responses) for s in sets]),
        **joined,  # type: ignore[arg-type]
    )
