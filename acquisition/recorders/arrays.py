"""Records from files of named arrays: HDF5, ``.npz``, MATLAB.

An array of one dimension is a channel. Of one with two dimensions, the longer are the samples; the shorter are hits, or
channels where the name states which, ``data[1]``. Complex numbers are named by their parts, ``H real`` and ``H imag``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.errors import InputError
from acquisition.recorders.recorded import Recorded

_NAME = re.compile(r"(?P<base>.*?)(?:\[(?P<channel>\d{1,6})\])?(?: (?P<part>real|imag))?", re.DOTALL)


@dataclass(frozen=True, eq=False)
class Named:
    """Arrays of a file by name.

    Parameters
    ----------
    values : mapping of str to array
        The arrays.
    units : mapping of str to str
        Units that the file states.
    """

    values: Mapping[str, AnyArray]
    units: Mapping[str, str] = field(default_factory=dict)


Loader = Callable[[Path, Sequence[str]], Named]


def records_of(path: Path, load: Loader, names: Sequence[str], rate: str | None) -> list[Recorded]:
    """Return the records that the arrays of these names hold.

    Parameters
    ----------
    path : Path
        The file.
    load : callable
        Returns arrays of the file by name.
    names : sequence of str
        Channels, as a layout names them.
    rate : str or None
        Which array is the sampling rate [Hz].

    Raises
    ------
    InputError
        If an array is not there, or its shape is not that of a channel.
    """
    wanted = list(dict.fromkeys(names))
    bases = [_base(name) for name in wanted] + ([rate] if rate else [])
    held = load(path, list(dict.fromkeys(bases)))
    rows = {name: _rows(held.values[_base(name)], name, path) for name in wanted}
    hertz = None if rate is None else rate_of(held.values[rate], rate, path)
    counts = {len(r) for r in rows.values()} - {1}
    if len(counts) > 1:
        stated = ", ".join(f"{name!r} {len(r)}" for name, r in rows.items())
        raise InputError(
            f"{path}: the arrays hold different numbers of hits ({stated}); name a channel of an array by its number, "
            "as 'data[0]'"
        )
    hits = counts.pop() if counts else 1
    return [
        Recorded(
            path=path,
            names=tuple(wanted),
            rates={} if hertz is None else dict.fromkeys(range(len(wanted)), hertz),
            units={
                i: held.units[base] for i, name in enumerate(wanted) if (base := _base(name)) in held.units
            },
            values=tuple(r[k % len(r)] for r in rows.values()),
            record=None if hits == 1 else k + 1,
        )
        for k in range(hits)
    ]


def all_records(path: Path, load: Loader, names: Sequence[str]) -> list[Recorded]:
    """Return every array of numbers of a file as a channel of one record.

    Of several arrays of one shape with two dimensions, each is a channel and its shorter dimension are hits; of one
    alone, the shorter dimension are channels.
    """
    held = load(path, list(names))
    flat = {name: np.squeeze(values) for name, values in held.values.items()}
    shapes = [values.shape for values in flat.values()]
    channels: dict[str, AnyArray] = {}
    for name, values in flat.items():
        if values.ndim == 2:
            rows = values if values.shape[0] < values.shape[1] else values.T
            hits = shapes.count(values.shape) > 1
            channels |= {name: rows[0]} if hits else {f"{name}[{k}]": row for k, row in enumerate(rows)}
        elif values.ndim < 2:
            channels[name] = np.atleast_1d(values)
    units = {i: unit for i, n in enumerate(channels) if (unit := held.units.get(n, ""))}
    return [Recorded(path=path, names=tuple(channels), units=units, values=tuple(channels.values()))]


def _base(name: str) -> str:
    """Return the name of the array that a channel is in."""
    return _parts(name)["base"] or name


def _parts(name: str) -> dict[str, str | None]:
    found = _NAME.fullmatch(name)
    return {"base": name} if found is None else found.groupdict()


def _rows(values: AnyArray, name: str, path: Path) -> AnyArray:
    """Return an array as hits in rows, shape (n_hits, n_samples), one row for a channel that is named."""
    parts, flat = _parts(name), np.squeeze(values)
    flat = _part(np.atleast_1d(flat), parts.get("part"), name, path)
    if flat.ndim > 2 or (flat.ndim == 2 and flat.shape[0] == flat.shape[1]):
        raise InputError(
            f"{path}: {name!r} has shape {values.shape}, in which hits or channels cannot be distinguished "
            "from samples; save each channel as its own array"
        )
    if flat.ndim == 2 and flat.shape[0] > flat.shape[1]:
        flat = flat.T
    channel = parts.get("channel")
    if channel is None:
        return np.atleast_2d(flat)
    if flat.ndim != 2 or int(channel) >= len(flat):
        raise InputError(
            f"{path}: there is no {name!r}: the array has shape {values.shape}, and indices count from 0"
        )
    return np.atleast_2d(flat[int(channel)])


def _part(values: AnyArray, part: str | None, name: str, path: Path) -> AnyArray:
    """Return real numbers, or the part of complex ones that is named."""
    if np.iscomplexobj(values) is (part is not None):
        return values if part is None else np.real(values) if part == "real" else np.imag(values)
    if part is None:
        raise InputError(
            f"{path}: {name!r} holds complex numbers; name its parts, '{name} real' and '{name} imag'"
        )
    raise InputError(
        f"{path}: there is no {name!r}: the array holds real numbers; leave {part!r} out of the name"
    )


def rate_of(values: AnyArray, name: str, path: Path) -> float:
    """Return the sampling rate that an array of one number states [Hz].

    Raises
    ------
    InputError
        If it is no positive number.
    """
    if values.size != 1 or values.dtype.kind not in "fiu" or not 0 < float(values.ravel()[0]) < np.inf:
        raise InputError(
            f"{path}: rate = {name!r} of shape {values.shape} is not one positive number; name the array with the "
            "sampling rate in Hz, or give the number"
        )
    return float(values.ravel()[0])
