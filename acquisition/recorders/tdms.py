"""TDMS files of LabVIEW and of National Instruments' recorders."""

from __future__ import annotations

import logging
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.errors import InputError, in_one_line
from acquisition.libraries import library
from acquisition.recorders.recorded import Recorded

_LEAD, _BIG_ENDIAN, _VERSIONS = 28, 1 << 6, (4712, 4713)
"""Bytes before a segment [-], the bit in them for numbers with the high byte first, and versions of the format."""

_UNITS = ("unit_string", "NI_UnitDescription")
"""Properties of a channel that state its unit."""


def records(path: Path) -> list[Recorded]:
    """Return the records of a TDMS file.

    Groups whose channels have the same names are hits, one each. Otherwise all channels of the file are one record, and
    one whose name several groups have is ``group/channel``.

    Raises
    ------
    InputError
        If the file is damaged, or nptdms is not installed.
    """
    nptdms = library("nptdms", path, extra="recorders")
    _check_whole(path)
    try:
        with _strict():
            file = nptdms.TdmsFile.read(path)
            groups = [
                [_Channel(group.name, c) for c in group.channels() if len(c)] for group in file.groups()
            ]
    except Exception as error:  # the library raises what a damaged file happens to lead to
        reason = in_one_line(error)
        raise InputError(
            f"{path}: not a whole TDMS file ({type(error).__name__}: {reason}); record or export it again"
        ) from error
    groups = [group for group in groups if group]
    if not groups:
        raise InputError(f"{path}: no channel with samples in it; record or export it again")
    names = [[c.name for c in group] for group in groups]
    if len(groups) > 1 and all(sorted(n) == sorted(names[0]) for n in names):
        return [
            _record(path, group, n, k + 1) for k, (group, n) in enumerate(zip(groups, names, strict=True))
        ]
    every = [c for group in groups for c in group]
    plain = [c.name for c in every]
    return [_record(path, every, [c.name if plain.count(c.name) == 1 else c.full for c in every], None)]


class _Strict(logging.Handler):
    """Make an error of what the library only notes: that a segment is cut off, or words cannot be read."""

    def emit(self, record: logging.LogRecord) -> None:
        """Raise what would have been written to the log."""
        raise ValueError(record.getMessage())


@contextmanager
def _strict() -> Iterator[None]:
    """Refuse what the library reads as far as it can."""
    logs = [
        logging.getLogger(name) for name in list(logging.root.manager.loggerDict) if name.startswith("nptdms")
    ]
    handlers = [(log, log.handlers) for log in logs]
    for log in logs:
        log.handlers = [_Strict(logging.WARNING)]
    try:
        yield
    finally:
        for log, before in handlers:
            log.handlers = before


def _check_whole(path: Path) -> None:
    """Refuse a file whose segments do not follow each other to its end: samples would be missing.

    Raises
    ------
    InputError
        If they do not.
    """
    content, at = path.read_bytes(), 0
    while at + _LEAD <= len(content) and content[at : at + 4] == b"TDSm":
        order = ">" if struct.unpack_from("<I", content, at + 4)[0] & _BIG_ENDIAN else "<"
        version, following, raw = struct.unpack_from(f"{order}IQQ", content, at + 8)
        if version not in _VERSIONS or raw > following:
            break
        at += _LEAD + following
    if at != len(content) or not at:
        raise InputError(
            f"{path}: its segments do not end where the file ends; the recording was cut off or the file is damaged, "
            "record or export it again"
        )


class _Channel:
    """What is used of a channel."""

    def __init__(self, group: str, channel: Any) -> None:
        """Take samples, rate and unit, as the file states them."""
        self.name = str(channel.name)
        self.full = f"{group}/{channel.name}"
        self.values = np.asarray(channel[:])
        self.rate = _rate(channel.properties)
        self.unit = next((str(channel.properties[k]) for k in _UNITS if channel.properties.get(k)), "")


def _rate(properties: Mapping[str, Any]) -> float | None:
    """Return the sampling rate of a waveform [Hz]; None where a channel states no time between samples."""
    step = properties.get("wf_increment")
    if not isinstance(step, float | int | np.number) or not np.isfinite(step) or step <= 0:
        return None
    return 1.0 / float(step)


def _record(path: Path, channels: Sequence[_Channel], names: Sequence[str], record: int | None) -> Recorded:
    return Recorded(
        path=path,
        names=tuple(names),
        rates={i: c.rate for i, c in enumerate(channels) if c.rate is not None},
        units={i: c.unit for i, c in enumerate(channels) if c.unit},
        values=tuple(c.values for c in channels),
        record=record,
    )
