"""The data sets of one file, one after the other; a broken one costs no other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import IO

from acquisition.arrays import IntArray
from acquisition.errors import InputError
from acquisition.uff.content import DatasetInfo
from acquisition.uff.functions.header58 import parse_header
from acquisition.uff.functions.measurements import FUNCTION_TYPES, Measurement, described, measure
from acquisition.uff.functions.units import Units
from acquisition.uff.functions.values58 import locate
from acquisition.uff.geometry.lines import read_lines
from acquisition.uff.geometry.nodes import NodeSet
from acquisition.uff.geometry.systems import System, read_systems
from acquisition.uff.geometry.text_sets import read_nodes, read_units
from acquisition.uff.modes.data_sets import ModeSet, SigmaSet, read_mode, read_sigma, same_shape
from acquisition.uff.text.blocks import Block, header_end, split_blocks
from acquisition.uff.text.source import Source

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
USED = (1, 2, 3, 4, 6, 9)
LARGEST_TEXT = 1 << 30


@dataclass
class Finds:
    """What is collected while files are read, data set by data set."""

    several: bool = False
    infos: list[DatasetInfo] = field(default_factory=list)
    records: list[Measurement] = field(default_factory=list)
    nodes: list[NodeSet] = field(default_factory=list)
    lines: list[IntArray] = field(default_factory=list)
    modes: list[ModeSet] = field(default_factory=list)
    sigmas: dict[int, list[SigmaSet]] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    systems: dict[int, System] = field(default_factory=dict)
    seen_modes: dict[tuple[float, ...], list[ModeSet]] = field(default_factory=dict)
    title: str = ""
    files: int = 0

    @property
    def usable(self) -> bool:
        """Whether any file held a data set."""
        return any(info.number for info in self.infos)


@dataclass(frozen=True)
class _Here:
    """Where reading is: the file, the data set, the units in force, the temporary file for numbers."""

    source: Source
    block: Block
    units: Units
    spool: IO[bytes]

    @property
    def place(self) -> str:
        return f"{self.source.name}, data set {self.block.number} at line {self.block.line}"

    @property
    def body(self) -> bytes:
        if self.block.stop - self.block.start > LARGEST_TEXT:
            raise InputError("a text data set of over a gigabyte: split it")
        return self.source.data[self.block.start : self.block.stop]


def read_file(source: Source, finds: Finds, spool: IO[bytes], checked: Callable[[int], None]) -> None:
    """Read the data sets of a file.

    Parameters
    ----------
    source : Source
        The file.
    finds : Finds
        What is added to.
    spool : binary file
        Takes the numbers of text data sets.
    checked : callable
        Called with the number of bytes that were read since [byte].

    Raises
    ------
    InputError
        If the file holds no data set.
    """
    blocks = list(split_blocks(source))
    if not any(block.number for block in blocks):
        raise InputError(
            f"{source.name}: no data set found; a universal file has '    -1' lines around each data set, "
            "export the test as one"
        )
    if source.note:
        finds.warnings.append(f"{source.name}: {source.note}")
    finds.systems, finds.files = {}, finds.files + 1
    units = _units(source, blocks, finds)
    if not any(u.known for u in units) and any(b.number in (15, 55, 58, 2411, 2414) for b in blocks):
        finds.warnings.append(
            f"{source.name}: no data set 164; SI units are assumed where labels do not state otherwise"
        )
    done = 0
    for block, unit in zip(blocks, units, strict=True):
        here = _Here(source, block, unit, spool)
        kind = "unreadable" if block.fault else KINDS.get(block.number, "not used")
        info = DatasetInfo(source.name, block.number, kind, block.line, "")
        try:
            finds.infos.append(_read_block(here, info, finds))
        except InputError as error:
            finds.infos.append(_broken(here, replace(info, ok=False, message=str(error)), finds))
        source.passed(done, block.stop)
        checked(block.stop - done)
        done = block.stop
    finds.warnings += _unused(source.name, [i.unused for i in finds.infos[-len(blocks) :] if i.unused])


def _unused(name: str, kinds: Sequence[str]) -> list[str]:
    """State in one line what a file holds that is not used."""
    listed = "; ".join(f"{count} {kind}" for kind, count in Counter(kinds).items())
    return [f"{name}: not used: {listed}"] if listed else []


def without_copies(records: Sequence[Measurement]) -> tuple[list[Measurement], list[str]]:
    """Return records without those that stand, header and values, in an earlier file too."""
    first: dict[bytes, Measurement] = {}
    kept: list[Measurement] = []
    copies: dict[tuple[str, str], int] = {}
    for record in records:
        known = first.setdefault(record.key, record) if record.key else record
        if known.file == record.file:
            kept.append(record)
        else:
            pair = (record.place.rpartition(", data set ")[0], known.place.rpartition(", data set ")[0])
            copies[pair] = copies.get(pair, 0) + 1
    return kept, [
        f"{one}: {count} records are the same, number for number, as in {other}; they count once"
        for (one, other), count in copies.items()
    ]


def _units(source: Source, blocks: Sequence[Block], finds: Finds) -> list[Units]:
    """Return the units in force at each data set: those stated last before it, else the first in the file."""
    stated: list[Units | None] = []
    for block in blocks:
        try:
            text = (
                source.data[block.start : min(block.stop, block.start + 1000)] if block.number == 164 else b""
            )
            found = read_units(text)[0] if text else None
        except InputError:
            found = None
        stated.append(found)
    return list(_running(stated, next((u for u in stated if u is not None), Units())))


def _running(stated: Sequence[Units | None], current: Units) -> Iterator[Units]:
    for units in stated:
        current = current if units is None else units
        yield current


def _read_block(here: _Here, info: DatasetInfo, finds: Finds) -> DatasetInfo:
    number = here.block.number
    if here.block.fault:
        raise InputError(here.block.fault)
    if number == 58:
        return _read_58(here, info, finds)
    if number == 164:
        found, note = read_units(here.body)
        note = note if here.block.closed else "its closing delimiter -1 is missing"
        plain = found.length == 1 and found.force == 1
        text = "SI" if plain else f"1 m = {found.length:g}, 1 N = {found.force:g} in the file's units"
        return replace(info, description=text, message=note)
    if not here.block.closed:
        raise InputError("its closing delimiter -1 is missing: the file is cut off here")
    if number in (15, 2411):
        return _read_nodes(here, info, finds)
    if number in (18, 2420):
        systems = read_systems(number, here.body, here.units)
        finds.systems.update(systems)
        return replace(info, description=f"{len(systems)} coordinate systems")
    if number in (82, 2412):
        lines, note = read_lines(number, here.body)
        finds.lines.append(lines)
        return replace(info, description=f"{len(lines)} lines", message=note)
    if number in (55, 2414):
        return _read_mode(here, info, finds)
    if number == 151:
        title = here.body.decode("latin-1").partition("\n")[0].strip()
        title = "" if title.upper() == "NONE" else title
        finds.title = finds.title or title
        return replace(info, description=title)
    return replace(info, description="present, not used", unused=f"data sets {number}")


def _read_nodes(here: _Here, info: DatasetInfo, finds: Finds) -> DatasetInfo:
    labels, coordinates = read_nodes(here.block.number, here.body)
    nodes, given, moving = labels.T
    finds.nodes.append(
        NodeSet(
            number=here.block.number,
            place=here.place,
            nodes=nodes,
            coordinates=coordinates,
            given=given,
            moving=moving,
            systems=finds.systems,
            units=here.units,
        )
    )
    return replace(info, description=f"{len(nodes)} nodes")


def _read_mode(here: _Here, info: DatasetInfo, finds: Finds) -> DatasetInfo:
    sigma = read_sigma(here.body) if here.block.number == 55 else None
    if sigma is not None:
        finds.sigmas.setdefault(finds.files, []).append(sigma)
        return replace(
            info, kind="shape sigma", description=f"of mode {sigma.mode}, {len(sigma.nodes)} nodes"
        )
    mode = read_mode(here.block.number, here.body, here.units, here.place, finds.files)
    if mode is None:
        return replace(
            info,
            description="no mode at nodes, present, not used",
            unused=f"data sets {here.block.number} that hold no mode at nodes",
        )
    text = (
        f"complex mode, {mode.eigenvalue:.6g}" if mode.is_complex else f"normal mode, {mode.frequency:.6g} Hz"
    )
    info = replace(info, kind="modes", description=f"{text}, {len(mode.nodes)} nodes")
    known = finds.seen_modes.setdefault(mode.key, [])
    twin = next((one for one in known if same_shape(mode, one)), None)
    if twin is not None:
        return replace(info, message=f"the same mode stands in {twin.place}; it counts once")
    known.append(mode)
    finds.modes.append(mode)
    if len(known) == 1:
        return info
    where = known[0].place
    return replace(
        info,
        message=f"frequency and damping are exactly those of {where}, with another shape: a damaged copy, or an exact "
        "pair; both are kept; remove the wrong one",
    )


def _read_58(here: _Here, info: DatasetInfo, finds: Finds) -> DatasetInfo:
    located = locate(here.source, here.block, here.spool)
    header = located.header
    kind = FUNCTION_TYPES.get(header.function_type, f"function of type {header.function_type}")
    text = f"{header.response} / {header.reference}, {header.points} points"
    info = replace(info, kind=kind, description=text, message="; ".join(located.notes))
    if header.function_type not in USED:
        return replace(info, description=text + ", present, not used", unused=f"functions 58 of type {kind}")
    order = len(finds.records)
    record, notes = measure(
        located, here.units, here.place, file=finds.files, order=order, digest=finds.several
    )
    finds.records.append(record)
    return replace(info, message="; ".join([*located.notes, *notes]))


def _broken(here: _Here, info: DatasetInfo, finds: Finds) -> DatasetInfo:
    """Keep the place of a broken time record in the count of hits, if its header can be read."""
    if here.block.number not in (0, 58):
        return info
    start = here.block.start
    try:
        header = parse_header(
            here.source.data[start : min(here.block.stop, header_end(here.source.data, start))]
        )
    except InputError:
        return info
    order = len(finds.records)
    record, _ = described(header, here.units, here.place, file=finds.files, order=order)
    finds.records.append(record)
    kind = FUNCTION_TYPES.get(header.function_type, f"function of type {header.function_type}")
    return replace(info, kind=kind, description=f"{header.response} / {header.reference}")
