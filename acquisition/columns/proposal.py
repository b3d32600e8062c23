"""A layout written for files that have none: every guess with its reason, for the user to correct."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.columns.blocks import Block, plain_blocks, read_text
from acquisition.columns.guesses import (
    Channel,
    Guess,
    direction_in,
    is_rate,
    lines_among,
    most_impulsive,
    node_pattern,
    number_in,
    part_of,
    quantity_of,
    quantity_of_unit,
    roundest_rate,
    seconds,
    text_of,
    time_among,
    unit_in,
)
from acquisition.columns.layout import Layout
from acquisition.columns.lvm import is_lvm, lvm_blocks
from acquisition.columns.mat_proposal import frf_array, of_mat
from acquisition.errors import InputError
from acquisition.recorders import ARRAYS, Channels, all_arrays, is_recorded, listed

BEGINS = "# Layout by modalkit"
"""How a layout that was written here begins."""

_ABOVE = 6
"""So many lines above the numbers may hold their headings and units."""


@dataclass(frozen=True, eq=False)
class Source:
    """The first record of the files, and how its channels are called in a layout.

    Parameters
    ----------
    record : Channels
        The record.
    channels : tuple of Channel
        Those of its channels that hold numbers.
    named : bool
        Whether a layout calls them by their headings; otherwise by their numbers.
    """

    record: Channels
    channels: tuple[Channel, ...]
    named: bool


def propose_layout(paths: Sequence[str | Path], *, text: Layout | None = None) -> str:
    """Return a layout for files as TOML, with comments that say what was guessed and why.

    Parameters
    ----------
    paths : sequence of str or Path
        Files of one test: column text, LabVIEW text, or files of recorders.
    text : Layout, optional
        Separator, decimal sign and lines to skip, where they are known already.

    Raises
    ------
    InputError
        If the first cannot be read, or holds fewer than two channels.
    """
    files = [Path(path) for path in paths]
    head = [
        f"{BEGINS} from {files[0].name}: guesses, to be corrected. Not in the files: where the nodes are,",
        "# and which way hammer and transducers point. A table [nodes] gives places, 1 = [0.0, 0.0, 0.0] in m.",
    ]
    found = frf_array(all_arrays(files[0])) if files[0].suffix.lower() == ".mat" else None
    if found is not None:
        return "\n".join([*head, *of_mat(found)]) + "\n"
    text = Layout(columns=()) if text is None else text
    source = source_of(files[0], text)
    if len(source.channels) < 2:
        raise InputError(
            f"{files[0]}: holds {len(source.channels)} channels; a hit has a force and a response"
        )
    lines = lines_among(source.channels)
    body = _of_hits(source, files) if lines is None else _of_frfs(source, lines, files)
    return "\n".join([*head, *_style(text), *body]) + "\n"


def _style(text: Layout) -> list[str]:
    """Return what is stated about how numbers are written, where it is not found out."""
    usual = Layout(columns=())
    stated = {key: getattr(text, key) for key in ("separator", "decimal", "skip")}
    return [
        f"{key} = {value if isinstance(value, int) else text_of(value)}"
        for key, value in stated.items()
        if value != getattr(usual, key)
    ]


def source_of(path: Path, text: Layout) -> Source:
    """Return the first record of a file with its channels.

    Parameters
    ----------
    path : Path
        The file.
    text : Layout
        What is stated about separator, decimal sign and lines to skip.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    if is_recorded(path):
        record = listed(path)[0]
        return Source(record, _channels(record, record.units), named=path.suffix.lower() in ARRAYS)
    rows = read_text(path)
    if is_lvm(rows):
        record = lvm_blocks(path, rows)[0]
        return Source(record, _channels(record, record.units), named=True)
    block = plain_blocks(path, rows, text, 2)[0]
    names, units = _headings(rows, block)
    unique = len(set(names)) == len(names) and all(names)
    channels = tuple(
        Channel(i, name, unit_in(name) or unit, False, _column(block, i))
        for i, (name, unit) in enumerate(zip(names, units, strict=True))
    )
    return Source(block, tuple(c for c in channels if len(c.values)), named=unique)


def _channels(record: Channels, units: object) -> tuple[Channel, ...]:
    assert isinstance(units, dict)
    found = (
        Channel(i, name, units.get(i, ""), bool(units.get(i)), _column(record, i))
        for i, name in enumerate(record.names)
        if name not in ("Comment", "")
    )
    return tuple(c for c in found if len(c.values) or c.name == "X_Value")


def _column(record: Channels, index: int) -> FloatArray:
    """Return the numbers of a channel; none where it holds other things or was not recorded."""
    try:
        return record.numbers([index])[:, 0]
    except InputError:
        return np.zeros(0)


def _headings(text: Sequence[str], block: Block) -> tuple[list[str], list[str]]:
    """Return headings and units of a text: the last line above the numbers that is not all units, and that which is."""
    above = [
        block.style.split(line.lstrip("#% "))
        for line in text[max(block.first - 1 - _ABOVE, 0) : block.first - 1]
    ]
    rows = [row for row in above if len(row) == block.width]
    units = next((row for row in reversed(rows) if all(_is_unit(entry) for entry in row) and any(row)), None)
    names = next((row for row in reversed(rows) if row is not units), [""] * block.width)
    return names, [entry.strip("[]() ") for entry in units] if units else [""] * block.width


def _is_unit(entry: str) -> bool:
    bare = entry.strip("[]() ")
    return bare.lower() in ("", "s", "ms", "hz", "v", "-") or quantity_of_unit(bare) is not None


def _of_hits(source: Source, paths: Sequence[Path]) -> list[str]:
    time = time_among(source.channels)
    rates = [c for c in source.channels if len(c.values) == 1]
    data = [c for c in source.channels if c is not time and c.name != "X_Value" and len(c.values) > 1]
    guesses = {c.index: quantity_of(c) for c in data}
    forces = [c for c in data if (g := guesses[c.index]) is not None and g.value == "force"]
    if len(forces) != 1:
        chosen = most_impulsive(forces or [c for c in data if guesses[c.index] is None] or data)
        guesses |= {c.index: None for c in forces}
        guesses[chosen.index] = Guess("force", "it is the shortest pulse of all channels")
    kinds = [g.value for g in guesses.values() if g is not None and g.value != "force"]
    usual = max(dict.fromkeys(kinds), key=kinds.count) if kinds else "acceleration"
    pattern = node_pattern(paths)
    entries = [
        entry
        for c in data
        for entry in _hit_column(source, c, guesses[c.index], usual, roving=pattern is not None)
    ]
    return [*_rate(source, time, rates), *entries, *_rule(pattern, paths)]


def _rate(source: Source, time: Channel | None, scalars: Sequence[Channel]) -> list[str]:
    """Return where the sampling rate is from."""
    stated = source.record.rate_of([c.index for c in source.channels if c is not time][:1])
    if stated is not None:
        return [f"# rate: the files state it, {stated:g} Hz"]
    named = [c for c in scalars if is_rate(c.name)]
    if named:
        return [f"rate = {text_of(named[0].name)}  # {named[0].values[0]:g} Hz: by its name"]
    if time is None:
        return [
            "# rate = ...  # the sampling rate in Hz: neither the file nor a column of times states it; needed"
        ]
    unit, step = seconds(time), float(np.diff(time.values).mean())
    if unit == 1.0 and time.unit.lower() != "ms":
        return [f"time_column = {_key(source, time)}  # {1 / step:.6g} Hz: it rises in even steps"]
    scale = 1.0 if unit is None else unit
    rate, least, largest = roundest_rate(time.values, scale)
    return [
        f"rate = {rate:.12g}  # [Hz], from the column of times {time.name!r} in {time.unit}, whose last digit allows "
        f"{least:.12g} to {largest:.12g}"
    ]


def _hit_column(
    source: Source, channel: Channel, guess: Guess | None, usual: str, *, roving: bool
) -> list[str]:
    quantity = (
        Guess(usual, "as the other channels; correct it, or delete the entry") if guess is None else guess
    )
    force = quantity.value == "force"
    node = None if force else number_in(channel.name)
    direction = direction_in(channel.name)
    where = (
        "by the file's name, see [[file]]"
        if force and roving
        else "by its name"
        if node
        else "not in the file: correct it"
    )
    return [
        "",
        "[[column]]",
        *_called(source, channel),
        f'quantity = "{quantity.value}"  # {quantity.why}',
        *_unit(source, channel, quantity.value),
        f"node = {node or 1}  # {where}",
        f'direction = "{direction or "+z"}"  # {"by its name" if direction else "not in the file: correct it"}',
    ]


def _called(source: Source, channel: Channel) -> list[str]:
    if source.named:
        return [f"name = {text_of(channel.name)}"]
    return [
        f"index = {channel.index}"
        + (f"  # {channel.name}" if channel.name.isprintable() and channel.name else "")
    ]


def _key(source: Source, channel: Channel) -> str:
    return text_of(channel.name) if source.named else str(channel.index)


def _unit(source: Source, channel: Channel, quantity: str) -> list[str]:
    """Return the unit, and the scale where the numbers are parts of a full scale."""
    scale = [
        "# scale = ...  # needed: the value at full scale, from sensitivity and gain"
    ] * source.record.needs_scale
    known = channel.unit and quantity_of_unit(channel.unit) == quantity
    if known and channel.stated:
        return [f"# unit: the file states {channel.unit}", *scale]
    if known:
        return [f"unit = {text_of(channel.unit)}  # by its heading", *scale]
    si = {"force": "N", "acceleration": "m/s2", "velocity": "m/s", "displacement": "m"}[quantity]
    if channel.unit:
        return [
            f"unit = {text_of(channel.unit)}  # from the file, but not a unit of {quantity}: write {text_of(si)} and "
            f"scale = ... ({si} per {channel.unit}, one over the sensitivity)"
        ]
    return [f'unit = "{si}"  # not in the file: correct it, with scale = ... for a sensitivity', *scale]


def _of_frfs(source: Source, lines: Channel, paths: Sequence[Path]) -> list[str]:
    data = [c for c in source.channels if c is not lines and len(c.values) == len(lines.values)]
    data = [c for c in data if not (c.index < lines.index and time_among([c]) is c)]
    parts = [part_of(c) for c in data]
    known = all(parts)
    text = [
        f"frequency_column = {_key(source, lines)}  # it rises in even steps and is called {lines.name!r}"
    ]
    for k, (channel, part) in enumerate(zip(data, parts, strict=True)):
        why = "by its name" if known else "assumed: real and imaginary parts alternate; correct it"
        text += [
            "",
            "[[column]]",
            *_called(source, channel),
            'quantity = "accelerance"  # not in the file: correct it (mobility, receptance)',
            f'part = "{part if known else ("real", "imag")[k % 2]}"  # {why}',
            f"node = {k // 2 + 1}  # where it was measured, not in the file: correct it",
            "reference_node = 1  # where it was hit, not in the file: correct it",
        ]
    return [*text, *_rule(node_pattern(paths), paths)]


def _rule(pattern: Guess | None, paths: Sequence[Path]) -> list[str]:
    if pattern is None:
        several = ["", "# The names of the files state no nodes: all are taken as hits at one point."]
        return several if len(paths) > 1 else []
    return [
        "",
        "[[file]]",
        f"match = {text_of(pattern.value)}  # the number in the name is taken as the node that was hit: {pattern.why}",
    ]
