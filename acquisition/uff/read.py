"""Universal files in, everything that belongs to one test out."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from acquisition.arrays import AnyArray
from acquisition.errors import InputError
from acquisition.uff.content import DatasetInfo, UffContent
from acquisition.uff.datasets import Finds, read_file, without_copies
from acquisition.uff.functions.hits import assemble_tests
from acquisition.uff.functions.measurements import Measurement
from acquisition.uff.functions.responses import assemble_frfs
from acquisition.uff.functions.values58 import Function58, read_function
from acquisition.uff.geometry.nodes import merge_nodes, turned
from acquisition.uff.modes.read import describe, join_modes, solve_modes
from acquisition.uff.text.blocks import split_blocks
from acquisition.uff.text.source import opened
from acquisition.warned import Located

_SPOOL = 1 << 26  # bytes of numbers from text kept in memory before they go to a temporary file
_FIRST_PASS = 0.6  # of the progress


def read_uff(
    path: Path | str | Sequence[Path | str], *, progress: Callable[[float], None] | None = None
) -> UffContent:
    """Read one or more universal files as one test.

    Parameters
    ----------
    path : path or sequence of paths
        Files of data sets 15, 18, 55, 58/58b, 82, 151, 164, 2411, 2412, 2414 and 2420; others are listed.
    progress : callable, optional
        Called with the fraction that is done, from 0 to 1 [-].

    Returns
    -------
    UffContent
        In SI units; a broken data set is listed with what is wrong with it and costs no other, and a broken
        file costs none of the other files. Records keep the precision of the file.

    Raises
    ------
    InputError
        If no file can be opened or none holds a data set.
    """
    paths = [Path(path)] if isinstance(path, str | Path) else [Path(p) for p in path]
    if not paths:
        raise InputError("no file to read; name at least one")
    report = _Report(progress, sum(_size(p) for p in paths))
    finds = Finds(several=len(paths) > 1)
    with ExitStack() as stack:
        spool = stack.enter_context(tempfile.SpooledTemporaryFile(max_size=_SPOOL))
        for one in paths:
            _add_file(one, finds, stack, spool, report)
        if not finds.usable:
            raise InputError("; ".join(finds.warnings))
        content = _content(finds, _named(paths), report)
    report.done()
    return content


def read_functions(path: Path | str) -> tuple[Function58, ...]:
    """Return the functions of a file as they stand there, in the file's units; broken ones are left out."""
    functions = []
    with opened(Path(path)) as source, tempfile.SpooledTemporaryFile(max_size=_SPOOL) as spool:
        for block in split_blocks(source):
            if block.number == 58:
                try:
                    functions.append(read_function(source, block, spool))
                except InputError:
                    continue
    return tuple(functions)


@dataclass
class _Report:
    """How much has been done, in bytes; each byte is met twice, when it is checked and when it is kept."""

    report_progress: Callable[[float], None] | None
    total: int
    passed: int = 0
    kept: int = 0
    reported: float = -1.0

    def checked(self, count: int) -> None:
        """Take note of bytes that were found and checked."""
        self.passed += count
        self._say(min(_FIRST_PASS * self.passed / max(self.total, 1), _FIRST_PASS))

    def read(self, record: Measurement, out: AnyArray) -> None:
        """Read a record to its place."""
        record.into(out)
        self.kept += out.nbytes
        self._say(min(_FIRST_PASS + (1 - _FIRST_PASS) * self.kept / max(self.total, 1), 0.999))

    def done(self) -> None:
        """State that all is done."""
        self._say(1.0)

    def _say(self, fraction: float) -> None:
        """Report a fraction that is a thousandth more than the last one, and never less."""
        if self.report_progress is not None and (fraction >= self.reported + 1e-3 or fraction == 1):
            self.reported = fraction
            self.report_progress(fraction)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except (OSError, ValueError):
        return 0


def _add_file(
    path: Path, finds: Finds, stack: ExitStack, spool: tempfile.SpooledTemporaryFile[bytes], report: _Report
) -> None:
    """Read one file; what is not a universal file is reported, and does not affect the others."""
    try:
        source = stack.enter_context(opened(path))
        read_file(source, finds, spool, report.checked)
    except InputError as error:
        finds.warnings.append(f"{error}" + ("; the file is left out" if finds.several else ""))
        finds.infos.append(
            DatasetInfo(path.name, 0, "no universal file", 0, "", ok=False, message=str(error))
        )


def _named(paths: Sequence[Path]) -> str:
    shown = ", ".join(p.name for p in paths[:3])
    return shown if len(paths) <= 3 else f"{shown} and {len(paths) - 3} others"


def _content(finds: Finds, source: str, report: _Report) -> UffContent:
    nodes = merge_nodes(finds.nodes, finds.lines)
    records, copies = without_copies(finds.records)
    records = [
        replace(m, response=nodes.turn(m.response), reference=nodes.turn(m.reference)) for m in records
    ]
    note = turned(nodes, [d for m in finds.records for d in (m.response, m.reference)])
    times = [m for m in records if m.function_type == 1]
    has_force = any(m.quantity == "force" for m in times)
    tests, lost, broken = (
        assemble_tests(times, nodes.geometry, source, report.read) if has_force else ((), [], {})
    )
    if times and not has_force:
        count = f"{len(times)} time record" + ("s" if len(times) > 1 else "")
        lost = [f"{source}: {count} without a force: not used"]
    frfs, odd = assemble_frfs(records, nodes.geometry, source, report.read)
    solved, doubts = solve_modes(finds.modes, finds.sigmas)
    modal = join_modes(solved, nodes.geometry) if solved else None
    taken = {m.stated.place: describe(m) for m in solved}
    infos = tuple(
        replace(
            info,
            description=taken.get(info.place, info.description),
            warning=_stated(info, broken.get(info.place)) if info.message and info.line else "",
        )
        for info in finds.infos
    )
    reported = [info.warning for info in infos if info.warning]
    notes = [note] if note else []
    warnings = dict.fromkeys(
        [*reported, *finds.warnings, *copies, *nodes.notes, *notes, *lost, *odd, *doubts]
    )
    unused = (*lost, *odd)
    return UffContent(
        tests=tests,
        frfs=frfs,
        modal=modal,
        geometry=nodes.geometry,
        datasets=infos,
        warnings=tuple(warnings),
        title=finds.title,
        unused=unused,
    )


def _stated(info: DatasetInfo, hit: str | None) -> str:
    """State what is wrong with a data set, and which hit goes with it, in one line."""
    left_out = "it is left out" if hit is None else f"it is left out and {hit} with it"
    end = "" if info.ok else f"; {left_out}, export it again if it is needed"
    return Located(info.place, f"{info.message}{end}")
