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


def is_lvm(lines: Sequence[str]) -> bool:
    """Tell whether the lines are those of a LabVIEW measurement file."""
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
            f"{path}: the headers do not end as they begin, {len(starts)} of Channels and {max(len(ends) - 1, 0)} "
            "ends; the file was cut off or damaged, export it again"
        )
    try:
        return _segments(path, lines, ends, starts)
    except (ValueError, OverflowError) as error:
        raise InputError(f"{path}: a header cannot be read ({error}); export the file again") from error


def _segments(path: Path, lines: Sequence[str], ends: Sequence[int], starts: Sequence[int]) -> list[Block]:
    """Return the segments, whose headers all state the same."""
    separator = "\t" if "\t" in lines[1] else next((s for s in ",;" if s in lines[1]), "\t")
    _check_blank(path, lines, ends[0] + 1, starts[0], "before the first segment")
    header = _fields(lines[: ends[0]], separator)
    separator = _SEPARATORS.get(header.get("Separator", ["tab"])[0].lower(), separator)
    style = Style(separator, header.get("Decimal_Separator", ["."])[0] or ".")
    blocks, stated = [], set[str]()
    for begin, end, stop in zip(starts, ends[1:], [*starts[1:], len(lines)], strict=True):
        _check_no_samples(path, lines, (begin, end), style)
        header = _fields(lines[begin:end], separator)
        keys = {*header, f"Y_Unit_Label {header.get('Y_Unit_Label', [])}"}
        if odd := sorted(keys ^ (stated or keys)):
            raise InputError(
                f"{path}, line {begin + 1}: {odd[0]!r} stands not in the headers of all segments; export again"
            )
        stated = keys
        body = _body(lines, end + 2, stop)
        _check_blank(path, lines, end + 2 + len(body), stop, "behind the end of a segment")
        blocks.append(_block(path, lines, (begin, end), body, style))
    return blocks


def _check_blank(path: Path, lines: Sequence[str], start: int, stop: int, where: str) -> None:
    """Refuse what stands between segments, but for marks."""
    for number in range(start, stop):
        if lines[number].strip() and not lines[number].startswith("***"):
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
        if not line.strip() or line.startswith("Channels"):
            break
        body.append(line)
    return body


def _check_comments(path: Path, body: Sequence[str], first: int, width: int, style: Style) -> None:
    """Refuse a line with a number where a comment may stand: its fields are shifted."""
    for number, line in enumerate(body, start=first):
        beyond = [field for field in style.split(line)[width:] if field and style.is_number(field)]
        if beyond:
            raise InputError(
                f"{path}, line {number}: {beyond[0][:40]!r} stands beyond the {width} columns; export the file again"
            )


def _block(path: Path, lines: Sequence[str], span: tuple[int, int], body: list[str], style: Style) -> Block:
    begin, end = span
    header = _fields(lines[begin:end], style.separator or "\t")
    names = tuple(style.split(lines[end + 1])) if end + 1 < len(lines) else ()
    if not (count := header.get("Channels", ["0"])[0]).isdecimal():
        raise InputError(
            f"{path}, line {begin + 1}: {count[:40]!r} is no number of channels; export it again"
        )
    samples = [int(float(s)) for s in header.get("Samples", []) if s]
    if not body or (samples and len(body) != max(samples)):
        raise InputError(
            f"{path}, line {end + 3}: {max(samples, default=0)} samples announced and {len(body)} there; "
            "the file was cut off or damaged, export it again"
        )
    channels = [i for i, name in enumerate(names) if name not in ("X_Value", "Comment", "")]
    units = dict(zip(channels, header.get("Y_Unit_Label", []), strict=False))
    _check_comments(path, body, end + 3, len(channels) + ("X_Value" in names), style)
    steps = [style.number(s) for s in header.get("Delta_X", []) if s]
    if len({f"{s:.9g}" for s in steps}) > 1:
        raise InputError(f"{path}, line {begin + 1}: channels sampled at different rates; export them apart")
    timed = header.get("X_Dimension", ["Time"])[0] in ("Time", "")
    rate = 1 / steps[0] if steps and steps[0] > 0 and timed else None
    return Block(path, names, tuple(body), end + 3, style, rate, units, strict=False)
