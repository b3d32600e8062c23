"""Universal files out: whole or not at all, in time linear in the number of sets."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path

from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.geometry import Geometry
from acquisition.hits.hammer import HammerTest
from acquisition.modal_data import ModalData
from acquisition.uff.modes.write import mode_sets
from acquisition.uff.writing.data_sets import (
    FORCE,
    FREQUENCY,
    MOTIONS,
    NOTHING,
    TIME,
    UNITY,
    Format,
    Precision,
    Record58,
    function_set,
    header_set,
    nodes_sets,
    units_set,
)


def write_uff(
    path: Path | str,
    *,
    tests: HammerTest | Sequence[HammerTest] = (),
    frfs: FrfSet | Sequence[FrfSet] | None = None,
    modal: ModalData | None = None,
    geometry: Geometry | None = None,
    title: str = "",
    form: Format = "binary",
    precision: Precision = "double",
) -> None:
    """Write a universal file.

    Parameters
    ----------
    path : path
        Where to; an existing file is replaced at the very end, by a complete one.
    tests : HammerTest or sequence, optional
        Raw time records, as functions of type 1: the force of each hit, then its responses.
    frfs : FrfSet or sequence, optional
        FRFs as functions of type 4, their coherence as type 6.
    modal : ModalData, optional
        Modes as data sets 55.
    geometry : Geometry, optional
        Nodes as data set 2411 [m], its lines as data sets 82; by default those of what is written. Axes of
        nodes that are turned go with them as data set 2420.
    title : str
        Title of data set 151.
    form : {"binary", "ascii"}
        Data set 58b or 58.
    precision : {"double", "single"}
        Double keeps every bit in binary; single halves the size.

    Raises
    ------
    InputError
        If there is nothing to write or the file cannot be written.
    """
    target = Path(path)
    tests = (tests,) if isinstance(tests, HammerTest) else tuple(tests)
    sets = (frfs,) if isinstance(frfs, FrfSet) else tuple(frfs or ())
    owners = (*tests, *sets, *(() if modal is None else (modal,)))
    if not owners and geometry is None:
        raise InputError(f"{target}: nothing to write; give tests, frfs, modal or geometry")
    nodes = geometry or next((o.geometry for o in owners if o.geometry.nodes), Geometry.empty())
    parts = [
        header_set(title),
        units_set(),
        *(nodes_sets(nodes) if nodes.nodes else ()),
    ]
    functions = chain.from_iterable(
        function_set(r, form=form, precision=precision) for r in _records(tests, sets)
    )
    modes = mode_sets(modal) if modal is not None else iter(())
    _write_whole(target, parts, functions, modes)


def _write_whole(target: Path, *chunks: Iterable[bytes | memoryview]) -> None:
    """Write beside the target and move into place; leave nothing behind if that fails."""
    partial = ""
    try:
        handle, partial = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        with os.fdopen(handle, "wb") as file:
            for parts in chunks:
                file.writelines(parts)
            file.flush()
            os.fsync(file.fileno())  # or a power cut leaves an empty file under the name
        Path(partial).chmod(0o644)
        Path(partial).replace(target)
    except OSError as error:
        raise InputError(f"{target}: cannot be written ({error.strerror}); check folder and space") from error
    finally:
        if partial:
            Path(partial).unlink(missing_ok=True)


def _records(tests: Sequence[HammerTest], sets: Sequence[FrfSet]) -> Iterator[Record58]:
    for test in tests:
        yield from _hits(test)
    for frfs in sets:
        yield from _frfs(frfs)


def _window(decay: float) -> str:
    return f"exponential window decay {float(decay)!r} 1/s" if decay else "NONE"


def _hits(test: HammerTest) -> Iterator[Record58]:
    """Yield the force of each hit, then its responses."""
    step, note = 1 / test.rate, _window(test.decay)
    for point in test.points:
        at = point.reference
        for hit in range(point.count):
            title = (f"hit {hit + 1} at {at}: force", "NONE", "NONE", note)
            yield Record58(
                title=title,
                function_type=1,
                response=at,
                reference=at,
                minimum=0.0,
                increment=step,
                values=point.force[hit],
                axes=(TIME, FORCE, NOTHING),
            )
            for dof, wave in zip(point.responses, point.motion[hit], strict=True):
                title = (f"hit {hit + 1} at {at}: response {dof}", "NONE", "NONE", note)
                yield Record58(
                    title=title,
                    function_type=1,
                    response=dof,
                    reference=at,
                    minimum=0.0,
                    increment=step,
                    values=wave,
                    axes=(TIME, MOTIONS[test.form], NOTHING),
                )


def _frfs(frfs: FrfSet) -> Iterator[Record58]:
    """Yield each FRF, followed by its coherence."""
    low, step = float(frfs.frequency[0]), frfs.df
    for row, (dof, at) in enumerate(zip(frfs.responses, frfs.references, strict=True)):
        averages = "NONE" if frfs.averages is None else f"averages {int(frfs.averages[row])}"
        title = (f"FRF {dof} / {at}", "NONE", "NONE", _window(frfs.decay), averages)
        axes = (FREQUENCY, MOTIONS[frfs.form], FORCE)
        yield Record58(
            title=title,
            function_type=4,
            response=dof,
            reference=at,
            minimum=low,
            increment=step,
            values=frfs.values[row],
            axes=axes,
        )
        if frfs.coherence is not None:
            title = (f"coherence {dof} / {at}", *title[1:])
            yield Record58(
                title=title,
                function_type=6,
                response=dof,
                reference=at,
                minimum=low,
                increment=step,
                values=frfs.coherence[row],
                axes=(FREQUENCY, UNITY, NOTHING),
            )
