"""Universal files in, everything that belongs to one test out."""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from acquisition.errors import InputError
from acquisition.uff.blocks import Block, header_end, split_blocks
from acquisition.uff.content import DatasetInfo, UffContent
from acquisition.uff.header58 import parse_header
from acquisition.uff.hits import assemble_tests
from acquisition.uff.measurements import FUNCTION_TYPES, Measurement, measure, quantity_of
from acquisition.uff.modes_in import Mode, join_modes, read_mode
from acquisition.uff.nodes import merge_nodes
from acquisition.uff.responses import assemble_frfs
from acquisition.uff.text_sets import read_nodes, read_units
from acquisition.uff.units import Units
from acquisition.uff.values58 import Function58, read_function

KINDS = {
    15: "nodes",
    18: "coordinate systems",
    55: "modes",
    58: "function",
    82: "trace lines",
    151: "header",
    164: "units",
    2411: "nodes",
    2412: "elements",
    2414: "analysis data",
    2420: "coordinate systems",
}
USED = (1, 4, 6)


@dataclass
class _Finds:
    """What is collected while files are read, data set by data set."""

    infos: list[DatasetInfo] = field(default_factory=list)
    records: list[Measurement] = field(default_factory=list)
    nodes: list[tuple[list[int], list[list[float]]]] = field(default_factory=list)
    modes: list[Mode] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    title: str = ""


def read_uff(path: Path | str | Sequence[Path | str]) -> UffContent:
    """Read one or more universal files as one test.

    Parameters
    ----------
    path : path or sequence of paths
        Files of data sets 15, 2411, 151, 164 and 58/58b; others are listed.

    Returns
    -------
    UffContent
        In SI units; a broken data set is listed with what is wrong with it and costs no other.

    Raises
    ------
    InputError
        If a file cannot be opened or holds no data set.
    """
    paths = [Path(path)] if isinstance(path, str | Path) else [Path(p) for p in path]
    finds = _Finds()
    for one in paths:
        with _mapped(one) as data:
            _read_file(data, one.name, finds)
    geometry, remarks = merge_nodes(finds.nodes)
    source = ", ".join(p.name for p in paths)
    times = [m for m in finds.records if m.function_type == 1]
    has_force = any(m.quantity == "force" for m in times)
    tests, lost = assemble_tests(times, geometry, source) if has_force else ((), [])
    if times and not has_force:
        lost = [f"{source}: {len(times)} time records and no force among them; they are not used"]
    frfs, odd = assemble_frfs(finds.records, geometry, source)
    told = [f"{i.file}, data set {i.number} at line {i.line}: {i.message}" for i in finds.infos if i.message]
    warnings = tuple(dict.fromkeys([*told, *finds.warnings, *remarks, *lost, *odd]))
    modal = join_modes(finds.modes, geometry) if finds.modes else None
    return UffContent(tests, frfs, modal, geometry, tuple(finds.infos), warnings, finds.title)


def read_functions(path: Path | str) -> tuple[Function58, ...]:
    """Return the functions of a file as they stand there, in the file's units; broken ones are left out."""
    functions = []
    with _mapped(Path(path)) as data:
        for block in split_blocks(data):
            if block.number == 58:
                try:
                    functions.append(read_function(data, block))
                except InputError:
                    continue
    return tuple(functions)


def _mapped(path: Path) -> mmap.mmap:
    """Return the bytes of a file without reading them yet."""
    try:
        with path.open("rb") as file:
            return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except ValueError:
        raise InputError(f"{path}: the file is empty; export it again") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check the path") from None


def _read_file(data: mmap.mmap, name: str, finds: _Finds) -> None:
    blocks = list(split_blocks(data))
    if not blocks:
        raise InputError(
            f"{name}: no data set found; a universal file has '    -1' lines around each data set"
        )
    units = _units(data, blocks, name, finds)
    if not any(u.known for u in units) and any(b.number in (15, 55, 58, 2411) for b in blocks):
        finds.warnings.append(f"{name}: no data set 164; SI units are assumed where labels say nothing else")
    for block, unit in zip(blocks, units, strict=True):
        info = DatasetInfo(name, block.number, KINDS.get(block.number, "not used"), block.line, "")
        try:
            finds.infos.append(_read_block(data, block, unit, info, finds))
        except InputError as error:
            finds.infos.append(_broken(data, block, unit, replace(info, ok=False, message=str(error)), finds))


def _units(data: mmap.mmap, blocks: Sequence[Block], name: str, finds: _Finds) -> list[Units]:
    """Return the units in force at each data set: those stated last before it, else the first in the file."""
    stated: list[Units | None] = []
    for block in blocks:
        try:
            found, remark = read_units(data[block.start : block.stop]) if block.number == 164 else (None, "")
        except InputError:
            found, remark = None, ""
        if remark:
            finds.warnings.append(f"{name}, data set 164 at line {block.line}: {remark}")
        stated.append(found)
    current = next((u for u in stated if u is not None), Units())
    return list(_running(stated, current))


def _running(stated: Sequence[Units | None], current: Units) -> Iterator[Units]:
    for units in stated:
        current = current if units is None else units
        yield current


def _read_block(data: mmap.mmap, block: Block, units: Units, info: DatasetInfo, finds: _Finds) -> DatasetInfo:
    if block.number == 58:
        return _read_58(data, block, units, info, finds)
    body = data[block.start : block.stop]
    if block.number == 164:
        found, remark = read_units(body)
        text = f"1 m = {found.length:g}, 1 N = {found.force:g} in the file's units"
        return replace(info, description=text, message=remark)
    if not block.closed:
        raise InputError("its closing delimiter -1 is missing: the file is cut off here")
    if block.number in (15, 2411):
        nodes, coordinates = read_nodes(block.number, body, units)
        finds.nodes.append((nodes.tolist(), coordinates.tolist()))
        return replace(info, description=f"{len(nodes)} nodes")
    if block.number == 55:
        mode = read_mode(body, units)
        finds.modes.append(mode)
        text = f"{abs(mode.pole) / 6.283185307179586:.6g} Hz, {len(mode.nodes)} nodes"
        return replace(info, description=text, message=mode.note)
    if block.number == 151:
        title = body.decode("latin-1").partition("\n")[0].strip()
        finds.title = finds.title or title
        return replace(info, description=title)
    return replace(info, description="present, not used")


def _read_58(data: mmap.mmap, block: Block, units: Units, info: DatasetInfo, finds: _Finds) -> DatasetInfo:
    function = read_function(data, block)
    header = function.header
    kind = FUNCTION_TYPES.get(header.function_type, f"function of type {header.function_type}")
    text = f"{header.response} / {header.reference}, {header.points} points"
    info = replace(info, kind=kind, description=text, message="; ".join(function.notes))
    if header.function_type not in USED:
        return replace(info, description=text + ", present, not used")
    place = f"{info.file}, data set 58 at line {info.line}"
    record, notes = measure(function, units, place)
    finds.records.append(record)
    return replace(info, message="; ".join([*function.notes, *notes]))


def _broken(data: mmap.mmap, block: Block, units: Units, info: DatasetInfo, finds: _Finds) -> DatasetInfo:
    """Keep the place of a broken time record in the count of hits, if its header can be read."""
    if block.number != 58:
        return info
    try:
        header = parse_header(data[block.start : min(block.stop, header_end(data, block.start))])
    except InputError:
        return info
    quantity = quantity_of(header, units)[0]
    place = f"{info.file}, data set 58 at line {info.line}"
    finds.records.append(
        Measurement(
            header.function_type,
            quantity,
            header.response,
            header.reference,
            0.0,
            1.0,
            None,
            header.decay,
            place,
        )
    )
    kind = FUNCTION_TYPES.get(header.function_type, f"function of type {header.function_type}")
    return replace(info, kind=kind, description=f"{header.response} / {header.reference}")
