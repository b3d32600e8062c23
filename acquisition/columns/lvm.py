"""LabVIEW measurement files (.lvm): a header for the file, and one for each segment."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from acquisition.columns.blocks import Block, Style
from acquisition.errors import InputError

END = "***End_of_Header***"
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
    if len(ends) < 2:
        raise InputError(f"{path}: the headers do not end; the file was cut off, export it again")
    separator = "\t" if "\t" in lines[1] else next((s for s in ",;" if s in lines[1]), "\t")
    header = _fields(lines[: ends[0]], separator)
    separator = _SEPARATORS.get(header.get("Separator", ["tab"])[0].lower(), separator)
    style = Style(separator, header.get("Decimal_Separator", ["."])[0] or ".")
    blocks = []
    starts = [*ends[1:], len(lines)]
    for k, end in enumerate(ends[1:]):
        begin = max(i for i in range(ends[k] + 1, end) if lines[i].startswith("Channels"))
        body = _body(lines, end + 2, starts[k + 1])
        blocks.append(_block(path, lines, (begin, end), body, style))
    return blocks


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


def _block(path: Path, lines: Sequence[str], span: tuple[int, int], body: list[str], style: Style) -> Block:
    begin, end = span
    header = _fields(lines[begin:end], style.separator or "\t")
    names = tuple(style.split(lines[end + 1])) if end + 1 < len(lines) else ()
    samples = [int(float(s)) for s in header.get("Samples", []) if s]
    if not body or (samples and len(body) < max(samples)):
        raise InputError(
            f"{path}, line {end + 3}: {max(samples, default=0)} samples announced and {len(body)} there; "
            "the file was cut off, export it again"
        )
    channels = [i for i, name in enumerate(names) if name not in ("X_Value", "Comment", "")]
    units = dict(zip(channels, header.get("Y_Unit_Label", []), strict=False))
    steps = [style.number(s) for s in header.get("Delta_X", []) if s]
    if len({f"{s:.9g}" for s in steps}) > 1:
        raise InputError(f"{path}, line {begin + 1}: channels sampled at different rates; export them apart")
    timed = header.get("X_Dimension", ["Time"])[0] in ("Time", "")
    rate = 1 / steps[0] if steps and steps[0] > 0 and timed else None
    return Block(path, names, tuple(body), end + 3, style, rate, units, strict=False)
