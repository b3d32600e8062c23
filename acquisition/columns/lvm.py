"""LabVIEW measurement files (.lvm): a header for the file, and one for each segment."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

from acquisition.columns.blocks import Block, Style
from acquisition.errors import InputError

END = "***End_of_Header***"
_OF_SEGMENTS = ("Channels", "Samples", "Y_Unit_Label", "Delta_X")
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}
_FREE = ("Notes", "Test_", "UUT_", "Model_Number", "Serial_Number", "Operator", "Project", "Description")
"""What the keys of a header begin with that describe the test: they may stand in one segment and not in another."""

_NO_CHANNEL = ("X_Value", "Comment", "")
"""Headings of columns that hold no channel; with ``X_Columns Multi`` each channel has an ``X_Value`` of its own."""


def is_lvm(lines: Sequence[str]) -> bool:
    """Return whether the lines are those of a LabVIEW measurement file."""
    return bool(lines) and lines[0].startswith("LabVIEW Measurement")


def lvm_blocks(path: Path, lines: Sequence[str]) -> list[Block]:
    """Return the segments of a LabVIEW measurement file, each a block.

    Raises
    ------
    InputError
        If headers or samples are missing.
    """
    ends = [i for i, line in enumerate(lines) if line.startswith(END)]
    starts = [i for i, line in enumerate(lines) if line.startswith("Channels")]
    early = [line for line in lines[: ends[0] if ends else 0] if line.startswith(_OF_SEGMENTS)]
    each = [sum(a < i < b for i in starts) for a, b in itertools.pairwise(ends)]
    if early or not each or each != [1] * len(starts):
        raise InputError(
            f"{path}: {len(starts)} headers begin with Channels, but {max(len(ends) - 1, 0)} headers end; "
            "the file was cut off or damaged, export it again"
        )
    try:
        return _segments(path, lines, ends, starts)
    except (ValueError, OverflowError) as error:
        raise InputError(f"{path}: a header cannot be read ({error}); export the file again") from error


def _segments(path: Path, lines: Sequence[str], ends: Sequence[int], starts: Sequence[int]) -> list[Block]:
    """Return the segments, whose headers all state the same."""
    separator = "\t" if "\t" in lines[1] else next((s for s in ",;" if s in lines[1]), "\t")
    header = _fields(lines[: ends[0]], separator)
    separator = _SEPARATORS.get(header.get("Separator", ["tab"])[0].lower(), separator)
    style = Style(separator, header.get("Decimal_Separator", ["."])[0] or ".")
    _check_between(path, lines, (ends[0] + 1, starts[0]), "before the first segment", style)
    blocks, stated = [], set[str]()
    for begin, end, stop in zip(starts, ends[1:], [*starts[1:], len(lines)], strict=True):
        _check_no_samples(path, lines, (begin, end), style)
        header = _fields(lines[begin:end], separator)
        keys = {key for key in header if not key.startswith(_FREE)}
        keys.add(f"Y_Unit_Label {header.get('Y_Unit_Label', [])}")
        if odd := sorted(keys ^ (stated or keys)):
            raise InputError(
                f"{path}, line {begin + 1}: {odd[0]!r} is missing from the headers of some segments; export it again"
            )
        stated = keys
        body = _body(lines, end + 2, stop)
        _check_between(path, lines, (end + 2 + len(body), stop), "behind the end of a segment", style)
        blocks.append(_block(path, lines, (begin, end), body, style))
    return blocks


def _blank(line: str) -> bool:
    """Return whether a line holds separators at most."""
    return not line.strip(" \t;,\r")


def _check_between(path: Path, lines: Sequence[str], span: tuple[int, int], where: str, style: Style) -> None:
    """Refuse what stands between segments, but for marks and descriptions of the test; notes may take several lines."""
    noted = False
    for number in range(*span):
        first = style.split(lines[number])[0]
        noted = first == "Notes" or (noted and not first.startswith((*_OF_SEGMENTS, "X_Value")))
        described = lines[number].startswith(("***", *_FREE)) or noted
        if not _blank(lines[number]) and (not described or style.is_number(first)):
            raise InputError(f"{path}, line {number + 1}: {lines[number][:40]!r} {where}; export it again")


def _check_no_samples(path: Path, lines: Sequence[str], span: tuple[int, int], style: Style) -> None:
    """Refuse a header with samples in it: it has lost its end, and would take those of its segment for words."""
    for number in range(*span):
        if style.is_number(style.split(lines[number])[0]):
            raise InputError(
                f"{path}, line {number + 1}: {lines[number].strip()[:40]!r} stands in the header that begins at line "
                f"{span[0] + 1}; the file is damaged, export it again"
            )


def _fields(lines: Sequence[str], separator: str) -> dict[str, list[str]]:
    rows = (line.rstrip("\r\n").split(separator) for line in lines)
    return {row[0].strip(): [field.strip() for field in row[1:]] for row in rows if len(row) > 1}


def _body(lines: Sequence[str], start: int, stop: int) -> list[str]:
    """Return the lines of numbers from a place on: to a blank line, the next segment, or the end."""
    body = []
    for line in lines[start:stop]:
        if _blank(line) or line.startswith(("Channels", *_FREE)):
            break
        body.append(line)
    return body


def _check_comments(path: Path, body: Sequence[str], first: int, width: int, style: Style) -> None:
    """Refuse a line with a number where a comment may stand: its fields are shifted."""
    for number, line in enumerate(body, start=first):
        beyond = [field for field in style.split(line)[width:] if field and style.is_number(field)]
        if beyond:
            raise InputError(
                f"{path}, line {number}: {beyond[0][:40]!r} is outside the {width} columns; export the file again"
            )


def _block(path: Path, lines: Sequence[str], span: tuple[int, int], body: list[str], style: Style) -> Block:
    begin, end = span
    header = _fields(lines[begin:end], style.separator or "\t")
    names = tuple(style.split(lines[end + 1])) if end + 1 < len(lines) else ()
    if not (count := header.get("Channels", ["0"])[0]).isdecimal():
        raise InputError(
            f"{path}, line {begin + 1}: {count[:40]!r} is not a number of channels; export it again"
        )
    channels = [i for i, name in enumerate(names) if name not in _NO_CHANNEL]
    units = dict(zip(channels, _each(header, "Y_Unit_Label", len(channels)), strict=False))
    samples = _numbers(header, "Samples", channels, style)
    longest = int(max(samples.values(), default=len(body)))
    if not body or len(body) != longest:
        raise InputError(
            f"{path}, line {end + 3}: {longest} samples announced and {len(body)} there; "
            "the file was cut off or damaged, export it again"
        )
    _check_comments(path, body, end + 3, len(channels) + names.count("X_Value"), style)
    steps = _numbers(header, "Delta_X", channels, style)
    timed = header.get("X_Dimension", ["Time"])[0] in ("Time", "")
    rates = {i: 1 / step for i, step in steps.items() if step > 0 and timed}
    counts = {i: int(count) for i, count in samples.items()}
    return Block(
        path=path, names=names, rates=rates, units=units, counts=counts, lines=tuple(body), first=end + 3,
        style=style, strict=False,
    )  # fmt: skip


def _each(header: dict[str, list[str]], key: str, count: int) -> list[str]:
    """Return a key's entry for each channel; where each has two columns, the entries may have gaps between them."""
    entries = header.get(key, [])
    gaps = len(entries) >= 2 * count - 1 > 1 and any(entries[2::2]) and not any(entries[1 : 2 * count : 2])
    return entries[: 2 * count : 2] if gaps else entries[:count]


def _numbers(
    header: dict[str, list[str]], key: str, channels: Sequence[int], style: Style
) -> dict[int, float]:
    """Return a key's number for each channel, by column, where there is one."""
    entries = zip(channels, _each(header, key, len(channels)), strict=False)
    return {i: style.number(entry) for i, entry in entries if entry}
