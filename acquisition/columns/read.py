"""Hammer tests from column text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.columns.blocks import plain_blocks, read_text
from acquisition.columns.layout import Column, Layout, dof_of, read_layout
from acquisition.columns.lvm import is_lvm, lvm_blocks
from acquisition.columns.rules import FileRule, check_rules, rules_for
from acquisition.columns.units import QUANTITIES, factor_to_si
from acquisition.display import named_files
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.form import Form
from acquisition.geometry import Geometry
from acquisition.hits.hammer import HammerTest, Hits
from acquisition.recorders import SAME_RATE, Channels, is_recorded, recorded

UNEVEN = 0.5  # of the usual step: times that miss their place by more are uneven


@dataclass(frozen=True, eq=False)
class _Record:
    """One hit as read: force, motion, from which file and where in it, and at which rate."""

    reference: Dof
    responses: tuple[Dof, ...]
    force: FloatArray
    motion: FloatArray
    rate: float
    path: Path
    where: str


def read_columns(
    paths: Path | str | Sequence[Path | str], layout: Layout | Path | str, *, geometry: Geometry | None = None
) -> HammerTest:
    """Read column text files as one hammer test.

    Every file, and every block or segment in it, is one hit (or one long record: see
    `acquisition.hits.splitting.split_hits`); hits at the same point are put together.

    Parameters
    ----------
    paths : path or sequence of paths
        CSV files, tab- or blank-separated text, LabVIEW ``.lvm``.
    layout : Layout or path
        Which column is what; see docs/howto/column_text.md.
    geometry : Geometry, optional
        Nodes of the test; left out: those of the layout.

    Returns
    -------
    HammerTest
        In SI units.

    Raises
    ------
    InputError
        If a file, line or column cannot be used; the message states which and what to do.
    """
    plan, files = layout_and_files(layout, paths)
    if not files:
        raise InputError(f"{plan.source}: no files to read")
    check_rules(plan.files, files, plan.source)
    form = _form(plan)
    records = [record for path in files for record in _records(path, plan)]
    rates = np.array([r.rate for r in records])
    if np.ptp(rates) > SAME_RATE * rates.max():
        other = int(np.abs(rates - rates[0]).argmax())
        raise InputError(
            f"{records[other].where}: sampled at {rates[other]:g} Hz, but {records[0].where} at {rates[0]:g} Hz; "
            "read them as separate tests"
        )
    return HammerTest(
        rate=float(np.median(rates)),
        points=_points(records, plan),
        form=form,
        decay=plan.decay,
        geometry=plan.nodes if geometry is None else geometry,
        source=named_files(files),
    )


def layout_and_files(
    layout: Layout | Path | str, paths: Path | str | Sequence[Path | str]
) -> tuple[Layout, list[Path]]:
    """Return a layout, read where its file is given, and files, one or several, as a list."""
    plan = layout if isinstance(layout, Layout) else read_layout(layout)
    files = [Path(p) for p in ([paths] if isinstance(paths, str | Path) else paths)]
    return plan, files


def blocks_of(path: Path, layout: Layout) -> Sequence[Channels]:
    """Return the records of a file, or the blocks of numbers of a text.

    Raises
    ------
    InputError
        If there are none.
    """
    axes = [c for c in (layout.time_column, layout.frequency_column) if c is not None]
    named = (c.index if c.name is None else c.name for c in layout.columns)
    keys = [key for key in (*named, *axes) if key is not None]
    if is_recorded(path):
        return recorded(path, keys, rate=layout.rate_array)
    if layout.rate_array is not None:
        raise InputError(
            f"{path}: rate = {layout.rate!r} in {layout.source} names an array, but text has no arrays; give the rate "
            "in Hz, or time_column"
        )
    lines = read_text(path)
    if is_lvm(lines):
        return lvm_blocks(path, lines)
    numbers = [k for k in keys if isinstance(k, int)]
    least = max(len(set(keys)), max(numbers, default=0) + 1 if not layout.skip else 1)
    return plain_blocks(path, lines, layout, least, [k for k in keys if isinstance(k, str)])


def indices(block: Channels, columns: Sequence[Column]) -> list[int]:
    """Return where the columns of a layout are in a block.

    Raises
    ------
    InputError
        If one is not there.
    """
    return [block.index_of(c.index if c.name is None else c.name, c.label) for c in columns]


def scaled(block: Channels, columns: Sequence[Column], more: Sequence[int] = ()) -> FloatArray:
    """Return columns of a block in SI units, shape (n_columns + n_more, n_lines); ``more`` are left as they are.

    Raises
    ------
    InputError
        If a column or unit is not there.
    """
    index = indices(block, columns)
    factors = []
    for place, c in zip(index, columns, strict=True):
        unit = c.unit or block.units.get(place, "")
        if block.needs_scale and c.scale is None:
            raise InputError(
                f"{block.path}: {c.label} holds fractions of full scale; give scale = ..., the value at full scale in "
                "the unit of the column"
            )
        scale = 1.0 if c.scale is None else c.scale
        factors.append(scale * factor_to_si(unit, c.quantity, f"{block.path}: {c.label}"))
    values = block.numbers([*index, *more]).T
    with np.errstate(over="ignore"):
        values[: len(index)] *= np.array(factors)[:, None]
    if not np.isfinite(values).all():
        label = columns[int(np.argmin(np.isfinite(values).all(axis=1)))].label
        raise InputError(
            f"{block.where}: {label} holds numbers that are too large in any unit; check its unit, or record it again"
        )
    return values


def _form(layout: Layout) -> Form:
    forces = [c for c in layout.columns if c.quantity == "force"]
    responses = [c for c in layout.columns if c.quantity != "force"]
    kinds = sorted({c.quantity for c in responses})
    if len(forces) != 1 or not responses:
        raise InputError(
            f"{layout.source}: {len(forces)} columns of force and {len(responses)} of response; "
            "a hammer test needs one force and at least one response"
        )
    form = QUANTITIES[kinds[0]]
    if len(kinds) > 1 or form is None or kinds[0] in ("accelerance", "mobility", "receptance"):
        raise InputError(
            f"{layout.source}: responses of {', '.join(kinds)}; all responses of a test are "
            "accelerations, velocities or displacements: read the others as a separate test"
        )
    return form


def _records(path: Path, layout: Layout) -> list[_Record]:
    columns = [_in_file(c, path, layout) for c in layout.columns]
    force = next(c for c in columns if c.quantity == "force")
    responses = [c for c in columns if c.quantity != "force"]
    records = []
    for block in blocks_of(path, layout):
        timed = layout.rate is None and layout.time_column is not None
        more = [block.index_of(layout.time_column, f"time_column {layout.time_column!r}")] if timed else []
        values = scaled(block, [force, *responses], more)
        index = indices(block, columns)
        rate = _even_rate(values[-1], block) if timed else _stated_rate(block, index, layout)
        where = block.where
        if layout.samples is not None and values.shape[1] < layout.samples:
            raise InputError(f"{where}: {values.shape[1]} samples; the layout asks for {layout.samples}")
        values = values[:, : layout.samples]
        records.append(
            _Record(
                force.dof,
                tuple(c.dof for c in responses),
                values[0],
                values[1 : len(columns)],
                rate,
                path,
                where,
            )
        )
    return records


def _in_file(column: Column, path: Path, layout: Layout) -> Column:
    """Return the column as it is in this file: of point, unit and scale, what the first rule states."""
    for rule in reversed(rules_for(layout.files, path)):
        if column.quantity == "force" if rule.column == "" else rule.column in (column.name, column.index):
            column = with_unit(column, rule)
            direction = rule.direction or column.direction
            column = replace(
                column, node=column.node if rule.node is None else rule.node, direction=direction
            )
    dof_of(column.node, column.direction)
    return column


def with_unit(column: Column, rule: FileRule) -> Column:
    """Return a column with the unit and scale that a rule states."""
    scale = column.scale if rule.scale is None else rule.scale
    return replace(column, unit=rule.unit or column.unit, scale=scale)


def _stated_rate(block: Channels, index: Sequence[int], layout: Layout) -> float:
    stated, given = block.rate_of(index), layout.rate_stated
    if stated is None and given is None:
        raise InputError(
            f"{block.path}: no sampling rate; add rate = ... [Hz] or time_column = ... to {layout.source}"
        )
    if stated is not None and given is not None and abs(stated - given) > SAME_RATE * given:
        raise InputError(
            f"{block.path}: sampled at {stated:g} Hz by its header, at {given:g} Hz by {layout.source}; "
            "remove the wrong one"
        )
    return float(stated if given is None else given)  # type: ignore[arg-type]


def _even_rate(time: FloatArray, block: Channels) -> float:
    """Return the rate of times that are even, as far as they are written out [Hz]."""
    steps = np.diff(time)
    usual = float(np.median(steps)) if len(steps) else 0.0
    if usual <= 0:
        raise InputError(f"{block.where}: the times do not increase; check time_column")
    odd = np.flatnonzero(np.abs(steps - usual) > UNEVEN * usual)
    if len(odd):
        raise InputError(
            f"{block.line(int(odd[0]) + 1)}: uneven time, a step of {steps[odd[0]]:g} s where "
            f"{usual:g} s is usual; samples are missing: resample the record or cut it before the gap"
        )
    return float((len(time) - 1) / (time[-1] - time[0]))


def _points(records: Sequence[_Record], layout: Layout) -> tuple[Hits, ...]:
    lengths = {len(r.force): r.where for r in records}
    if len(lengths) > 1:
        known = "; ".join(f"{where}: {n} samples" for n, where in sorted(lengths.items())[:3])
        raise InputError(
            f"records of different lengths ({known}); add samples = {min(lengths)} to {layout.source}"
        )
    keys = dict.fromkeys((r.reference, r.responses) for r in records)
    groups = {key: [r for r in records if (r.reference, r.responses) == key] for key in keys}
    for rs in groups.values():
        _check_once(rs)
    return tuple(
        Hits(reference, responses, np.stack([r.force for r in rs]), np.stack([r.motion for r in rs]))
        for (reference, responses), rs in groups.items()
    )


def _check_once(records: Sequence[_Record]) -> None:
    """Check that no record of a point is given twice: noise makes any two hits differ.

    Equal hits of a simulation without noise are refused, too: no rule distinguishes them from copies on a quiet
    recorder of few bits, and one of them holds the information of all.
    """
    seen: dict[bytes, _Record] = {}
    for record in records:
        numbers = sha256(record.force.tobytes() + record.motion.tobytes()).digest()
        first = seen.setdefault(numbers, record)
        if first is not record:
            remedy = (
                "take one of the two out of the file"
                if record.path == first.path
                else f"give the command without {record.path} (in a study: take it out of files)"
            )
            raise InputError(
                f"{record.where}: the same numbers, sample by sample, as {first.where}; one hit counted "
                f"twice makes the noise look smaller: {remedy}. Of identical simulated hits, keep one"
            )
