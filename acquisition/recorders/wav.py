"""WAV files of two-channel interfaces and sound recorders."""

from __future__ import annotations

import struct
import warnings
from pathlib import Path

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.errors import InputError, in_one_line
from acquisition.recorders.recorded import Recorded


def records(path: Path) -> list[Recorded]:
    """Return the record of a WAV file, its channels ``Channel 1``, ``Channel 2``, ...

    Whole numbers become parts of the full scale, from -1 to 1; scipy puts those of 24 bits into the upper bytes of 32,
    whose full scale is the same. Floating-point numbers stay as they are.

    Raises
    ------
    InputError
        If the file is damaged, cut off, or not one of plain numbers.
    """
    from scipy.io import wavfile

    _check_whole(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", wavfile.WavFileWarning)  # chunks of notes, which are passed over
            rate, samples = wavfile.read(path)
    except (ValueError, TypeError, ArithmeticError, struct.error, EOFError, NameError, MemoryError) as error:
        reason = in_one_line(error)
        raise InputError(f"{path}: not a whole WAV file ({reason}); record or export it again") from error
    if not rate or not samples.size:
        raise InputError(f"{path}: no samples in it, or a rate of 0 Hz; record or export it again")
    columns = _relative(samples.reshape(len(samples), -1)).T
    return [
        Recorded(
            path=path,
            names=tuple(f"Channel {k + 1}" for k in range(len(columns))),
            rates=dict.fromkeys(range(len(columns)), float(rate)),
            values=tuple(columns),
            relative=samples.dtype.kind in "iu",
        )
    ]


def _relative(samples: AnyArray) -> AnyArray:
    """Return whole numbers as parts of the full scale; bytes are centred at 128."""
    if samples.dtype.kind == "f":
        return samples
    if samples.dtype == np.uint8:
        return (samples.astype(np.float64) - 128) / 128
    return np.asarray(samples / -float(np.iinfo(samples.dtype).min))


def _check_whole(path: Path) -> None:
    """Refuse a file that is not as long as its parts state: the end of a record would be missing.

    Raises
    ------
    InputError
        If it is not.
    """
    content = path.read_bytes()
    order = {b"RIFF": "<", b"RIFX": ">"}.get(content[:4])
    if order is None or content[8:12] != b"WAVE":
        raise InputError(f"{path}: does not begin as a WAV file; export it as WAV (RIFF)")
    at, data = 12, 0
    while at + 8 <= len(content):
        size = int(struct.unpack_from(f"{order}I", content, at + 4)[0])
        data += content[at : at + 4] == b"data"
        if content[at : at + 4] == b"fmt " and at + 24 <= len(content):
            channels, together, bits = struct.unpack_from(f"{order}2xH8xHH", content, at + 8)
            _check_sizes(path, channels, together, bits)
        at += 8 + size + size % 2
    stated = 8 + int(struct.unpack_from(f"{order}I", content, 4)[0])
    if at not in (len(content), len(content) + 1) or stated not in (at, at - 1) or data != 1:
        raise InputError(
            f"{path}: {len(content)} bytes where its header states {max(at, stated)}, or not one part with samples; "
            "the file was cut off or damaged, record or export it again"
        )


def _check_sizes(path: Path, channels: int, together: int, bits: int) -> None:
    """Refuse a header whose bytes a sample, channels and bits do not belong together: samples would be cut."""
    if not channels or not bits or together != channels * ((bits + 7) // 8):
        raise InputError(
            f"{path}: its header states {channels} channels of {bits} bits in {together} bytes; the file is damaged, "
            "record or export it again"
        )
