"""FRFs from column text: a column of frequencies beside real and imaginary parts, or magnitude and phase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.columns.layout import Column, Layout
from acquisition.columns.read import blocks_of, layout_and_files, scaled, with_unit
from acquisition.columns.rules import FileRule, check_rules, rules_for
from acquisition.columns.units import QUANTITIES
from acquisition.display import named_files
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.recorders import Channels

SAME_AXIS = 1e-6  # of the highest frequency


def read_frf_columns(paths: Path | str | Sequence[Path | str], layout: Layout | Path | str) -> FrfSet:
    """Read FRFs from column text.

    Parameters
    ----------
    paths : path or sequence of paths
        The files; all on one frequency axis.
    layout : Layout or path
        Which column is what: ``frequency_column``, and for every FRF two columns, "real" and "imag" or
        "magnitude" and "phase" [degrees]; see docs/howto/column_text.md.

    Raises
    ------
    InputError
        If a file, line or column cannot be used.
    """
    plan, files = layout_and_files(layout, paths)
    forms = {QUANTITIES[c.quantity] for c in plan.columns}
    form = next(iter(forms))
    if len(forms) != 1 or form is None or plan.frequency_column is None or not files:
        raise InputError(
            f"{plan.source}: FRFs need frequency_column, and columns of one quantity: accelerance, mobility or "
            "receptance"
        )
    check_rules(plan.files, files, plan.source)
    axes, rows = [], []
    found: dict[tuple[Dof, Dof], str] = {}
    for block in (block for path in files for block in blocks_of(path, plan)):
        pairs = [_in_file(pair, block.path, plan) for pair in _pairs(plan)]
        _note(found, pairs, block, plan)
        axis = block.index_of(plan.frequency_column, f"frequency_column {plan.frequency_column!r}")
        values = scaled(block, [c for pair in pairs for c in pair], [axis])
        axes.append(values[-1])
        rows += [_complex(pair[0], values[2 * k], values[2 * k + 1]) for k, pair in enumerate(pairs)]
        same = len(axes[0]) == len(axes[-1]) and np.allclose(
            axes[0], axes[-1], rtol=0, atol=SAME_AXIS * axes[0].max()
        )
        if not same:
            raise InputError(f"{block.where}: its frequency axis differs from that of {files[0]}")
    return FrfSet(
        frequency=axes[0],
        values=np.stack(rows),
        responses=tuple(response for response, _ in found),
        references=tuple(reference for _, reference in found),
        form=form,
        decay=plan.decay,
        geometry=plan.nodes,
        source=named_files(files),
    )


def _pairs(layout: Layout) -> list[tuple[Column, Column]]:
    """Return the two columns of every FRF: real and imaginary part, or magnitude and phase."""
    groups: dict[object, dict[str, Column]] = {}
    for c in layout.columns:
        group = groups.setdefault((c.dof, c.reference), {})
        if c.part in group:
            raise InputError(f"{layout.source}: FRF {c.dof}/{c.reference} has two columns of part {c.part!r}")
        group[c.part] = c
    pairs = []
    for group in groups.values():
        for one, two in (("real", "imag"), ("magnitude", "phase")):
            if set(group) == {one, two}:
                pairs.append((group[one], group[two]))
                break
        else:
            c = next(iter(group.values()))
            raise InputError(
                f"{layout.source}: FRF {c.dof}/{c.reference} has the parts {', '.join(group)}; "
                'give "real" and "imag", or "magnitude" and "phase"'
            )
    return pairs


def _in_file(pair: tuple[Column, Column], path: Path, layout: Layout) -> tuple[Column, Column]:
    """Return the columns of an FRF as they are in this file: points of force and response, units of what has one."""
    for rule in reversed(rules_for(layout.files, path)):  # the first wins
        if rule.column == "" or any(rule.column in (c.name, c.index) for c in pair):
            first, second = (c if c.part == "phase" else with_unit(c, rule) for c in pair)
            pair = _placed(first, rule), second
    return pair


def _placed(column: Column, rule: FileRule) -> Column:
    """Return a column with the point that a rule gives the response, or the force where it names no column."""
    if rule.column == "":
        node = column.reference_node if rule.node is None else rule.node
        return replace(
            column, reference_node=node, reference_direction=rule.direction or column.reference_direction
        )
    node = column.node if rule.node is None else rule.node
    return replace(column, node=node, direction=rule.direction or column.direction)


def _note(
    found: dict[tuple[Dof, Dof], str], pairs: Sequence[tuple[Column, Column]], block: Channels, layout: Layout
) -> None:
    """Note which FRFs a block holds.

    Raises
    ------
    InputError
        If another block holds one of them.
    """
    where = block.where
    for key in ((pair[0].dof, pair[0].reference) for pair in pairs):
        if key in found:
            raise InputError(
                f"{where}: FRF {key[0]}/{key[1]} is in {found[key]} already; give each file a [[file]] rule in "
                f"{layout.source} that states the node hit (or measured: column = ...)"
            )
        found[key] = where


def _complex(column: Column, one: FloatArray, two: FloatArray) -> ComplexArray:
    if column.part == "real":
        return np.asarray(one + 1j * two, dtype=np.complex128)
    return np.asarray(one * np.exp(1j * np.deg2rad(two)), dtype=np.complex128)
