"""From single FRFs and coherences to a set."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np

from acquisition.arrays import AnyArray, FloatArray, IntArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.geometry import Geometry
from acquisition.uff.functions.auto_cross import combine_spectra
from acquisition.uff.functions.measurements import Measurement
from acquisition.uff.functions.quantities import MOTIONS

Read = Callable[[Measurement, AnyArray], None]


def assemble_frfs(
    records: Sequence[Measurement], geometry: Geometry, source: str, read: Read
) -> tuple[FrfSet | None, list[str]]:
    """Return the FRFs on one frequency axis with their coherence, and what had to be left out.

    Where FRFs differ in axis, form or window, the largest group that agrees is taken. FRFs made of spectra
    (H1) stand in for pairs of response and reference that have none.
    """
    made, warnings = combine_spectra(records)
    there = {(m.response, m.reference) for m in records if m.function_type == 4 and m.values is not None}
    known = {(m.response, m.reference) for m in records if m.function_type == 6 and m.values is not None}
    records = [
        *records,
        *(m for m in made if (m.response, m.reference) not in (there if m.function_type == 4 else known)),
    ]
    groups: dict[tuple[object, ...], list[Measurement]] = defaultdict(list)
    for record in records:
        if record.function_type == 4 and record.values is not None:
            groups[(*record.axis, record.quantity, record.decay)].append(record)
    refused = [key for key in groups if key[3] not in MOTIONS]
    for key in refused:
        warnings.append(f"{groups.pop(key)[0].place}: a ratio that is not a motion per force; left out")
    if not groups:
        return None, warnings
    chosen = max(groups.values(), key=len)
    for other in groups.values():
        if other is not chosen:
            warnings.append(
                f"{other[0].place}: {len(other)} FRFs differ from {len(chosen)} others in axis, form or "
                "window and are left out; put them in a separate file"
            )
    pairs = [(m.response, m.reference) for m in chosen]
    if len(set(pairs)) < len(pairs):
        warnings.append(f"{source}: some FRFs have the same response and reference; all are kept")
    try:
        return _set(chosen, records, geometry, (source, read), warnings), warnings
    except InputError as error:
        return None, [*warnings, f"{error}: no FRFs are used"]


def _set(
    chosen: Sequence[Measurement],
    records: Sequence[Measurement],
    geometry: Geometry,
    origin: tuple[str, Read],
    warnings: list[str],
) -> FrfSet:
    source, read = origin
    single = all(m.dtype.itemsize == (8 if m.dtype.kind == "c" else 4) for m in chosen)
    values = np.empty((len(chosen), chosen[0].points), np.complex64 if single else np.complex128)
    for row, record in zip(values, chosen, strict=True):
        read(record, row)
    coherence = _coherence(chosen, records, source, warnings)
    frequency = chosen[0].minimum + chosen[0].step * np.arange(values.shape[1])
    first = 0
    values.setflags(write=False)
    if not np.isfinite(values[:, 0]).all():
        warnings.append(
            f"{source}: values at {frequency[0]:g} Hz are not finite; this line is left out of all FRFs"
        )
        first = 1
    form = chosen[0].quantity
    averages = np.array([m.averages for m in chosen])
    assert form in ("receptance", "mobility", "accelerance")
    return FrfSet(
        frequency=np.asarray(frequency[first:], dtype=np.float64),
        values=values[:, first:],
        responses=tuple(m.response for m in chosen),
        references=tuple(m.reference for m in chosen),
        form=form,
        coherence=None if coherence is None else coherence[:, first:],
        variance=_variance(values[:, first:], None if coherence is None else coherence[:, first:], averages),
        averages=averages if averages.all() else None,
        decay=chosen[0].decay,
        geometry=geometry,
        source=source,
    )


def _coherence(
    chosen: Sequence[Measurement], records: Sequence[Measurement], source: str, warnings: list[str]
) -> FloatArray | None:
    """Return the coherences in the order of the FRFs, if there is one for each."""
    found: dict[tuple[Dof, Dof], list[FloatArray]] = defaultdict(list)
    for record in records:
        if record.function_type == 6 and record.values is not None and record.axis == chosen[0].axis:
            found[record.response, record.reference].append(np.asarray(record.read().real, dtype=np.float64))
    if not found:
        return None
    rows = []
    for frf in chosen:
        column = found[frf.response, frf.reference]
        if not column:
            warnings.append(
                f"{source}: not every FRF has a coherence on the same axis; coherences are left out"
            )
            return None
        rows.append(column.pop(0) if len(column) > 1 else column[0])
    return np.nan_to_num(np.stack(rows), nan=0.0)


def _variance(values: AnyArray, coherence: FloatArray | None, averages: IntArray) -> FloatArray | None:
    """Return E|dH|^2 = |H|^2 (1 - coherence) / (coherence (n - 1)) where n averages were taken."""
    if coherence is None or averages.min() < 2:
        return None
    safe = np.clip(coherence, 1e-12, 1.0)
    spread = (1 - safe) / (safe * (averages[:, None] - 1))
    return np.asarray(np.square(np.abs(values), dtype=np.float64) * spread, dtype=np.float64)
