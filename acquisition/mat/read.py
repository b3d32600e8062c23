"""FRFs and modes from a MATLAB file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from acquisition.columns.layout import Layout, dof_of, read_layout
from acquisition.columns.mat_layout import AXES, MatLayout
from acquisition.columns.rules import rules_for
from acquisition.columns.units import QUANTITIES, factor_to_si
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.geometry import Geometry
from acquisition.modal_data import ModalData
from acquisition.modes.checks import check_frequencies, checked
from acquisition.recorders.arrays import rate_of
from acquisition.recorders.matlab.file import variables


def read_mat(path: Path | str, layout: Layout | Path | str) -> FrfSet | ModalData:
    """Read what a layout names of a MATLAB file: FRFs, or modes.

    Parameters
    ----------
    path : path
        The file, of version 5 to 7.2.
    layout : Layout or path
        Its ``[mat]`` states the meaning of each variable; ``[nodes]`` and ``decay`` count too, and of FRFs
        ``[[file]]``, which places their one reference. See docs/howto/matlab.md.

    Raises
    ------
    InputError
        If the file is of another version, damaged, or does not hold what the layout states.
    """
    plan = layout if isinstance(layout, Layout) else read_layout(layout)
    if plan.mat is None:
        raise InputError(
            f"{path}: {plan.source} has no table [mat] that names the variables; see docs/howto/matlab.md"
        )
    if plan.mat.frfs:
        placed = _placed(plan, Path(path))
        return read_mat_frfs(path, placed, plan)
    if plan.files:
        raise InputError(
            f"{plan.source}: [[file]] gives the points of FRFs, but [mat] names modes, whose points are in dofs; leave "
            "[[file]] out"
        )
    return read_mat_modes(path, plan.mat, geometry=plan.nodes)


def _placed(plan: Layout, path: Path) -> MatLayout:
    """Return the layout with the reference that a ``[[file]]`` rule gives this file.

    Raises
    ------
    InputError
        If rules are given and none is for this file, or there are several references to place.
    """
    assert plan.mat is not None
    if not plan.files:
        return plan.mat
    rule = next(iter(rules_for(plan.files, path)), None)
    if rule is None or rule.node is None or len(plan.mat.references) != 1:
        why = (
            f"no [[file]] rule of {plan.source} matches it"
            if rule is None
            else f"a [[file]] rule of {plan.source} gives no node; unit and scale of FRFs are stated in [mat]"
            if rule.node is None
            else f"a [[file]] rule of {plan.source} gives one reference, but [mat] has {len(plan.mat.references)}"
        )
        raise InputError(f"{path}: {why}; correct the rules, or leave them out")
    usual = replace(Dof.of(plan.mat.references[0]), node=rule.node)
    return replace(
        plan.mat, references=(str(dof_of(rule.node, rule.direction) if rule.direction else usual),)
    )


def read_mat_frfs(path: Path | str, layout: MatLayout, plan: Layout) -> FrfSet:
    """Read FRFs; see `read_mat`. Lines that are not in the file follow from ``rate`` and ``samples`` of the layout."""
    axis = layout.frequency or plan.rate_array
    held = variables(Path(path), [*([axis] if axis else []), layout.frfs])
    if layout.frequency:
        lines = _vector(held[layout.frequency], layout.frequency, path)
    else:
        rate = rate_of(held[axis], axis, Path(path)) if axis else plan.rate_stated
        assert rate is not None
        held[layout.frfs], lines = _one_sided(held[layout.frfs], rate, layout, plan.samples, path)
    responses, references = ([Dof.of(d) for d in dofs] for dofs in (layout.responses, layout.references))
    sizes = {"line": len(lines), "response": len(responses), "reference": len(references)}
    values = held[layout.frfs]
    if values.ndim < len(layout.axes):
        values = values.reshape(values.shape + (1,) * (len(layout.axes) - values.ndim))
    expected = tuple(sizes[axis] for axis in layout.axes)
    lacking = [axis for axis in AXES if axis not in layout.axes and sizes[axis] != 1]
    if values.shape != expected or lacking:
        wanted = " x ".join(f"{sizes[a]} {a}s" for a in layout.axes)
        raise InputError(
            f"{path}: {layout.frfs!r} has shape {values.shape}, but the layout states {wanted}"
            + (f" and several {lacking[0]}s without an axis" if lacking else "")
            + "; correct axes, responses or references of [mat]"
        )
    order = [layout.axes.index(axis) for axis in ("response", "reference", "line") if axis in layout.axes]
    form = QUANTITIES[layout.quantity]
    assert form is not None
    factor = factor_to_si(layout.unit, layout.quantity, f"{path}: {layout.frfs}")
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused by the set
        values = np.asarray(factor * values.transpose(order).reshape(-1, len(lines)), dtype=np.complex128)
    return FrfSet(
        frequency=lines,
        values=values,
        responses=tuple(a for a in responses for _ in references),
        references=tuple(references) * len(responses),
        form=form,
        decay=plan.decay,
        geometry=plan.nodes,
        source=str(path),
    )


def _one_sided(
    values: AnyArray, rate: float, layout: MatLayout, samples: int | None, path: Path | str
) -> tuple[AnyArray, FloatArray]:
    """Return FRFs up to half the sampling rate, and their lines [Hz], which the transformed samples make.

    Raises
    ------
    InputError
        If samples are not stated, or do not belong to so many lines.
    """
    axis = layout.axes.index("line")
    count = values.shape[axis] if axis < values.ndim else 1
    half = None if samples is None else samples // 2 + 1
    if half is None or count not in (half, samples):
        stated = "is not stated" if half is None else f"= {samples} has {half} lines up to half the rate"
        raise InputError(
            f"{path}: {layout.frfs!r} has {count} lines and no frequency, and samples {stated}; name a frequency, or "
            f"give the number of transformed samples in the layout: {2 * count - 2} or {2 * count - 1} if the lines "
            f"end at half the rate, {count} if they go on to the rate"
        )
    assert samples is not None
    return np.take(values, np.arange(half), axis=axis), np.arange(half) * rate / samples


def read_mat_modes(path: Path | str, layout: MatLayout, *, geometry: Geometry) -> ModalData:
    """Read modes; see `read_mat`."""
    names = [name for name in (layout.frequency, layout.damping, layout.shapes) if name]
    held = variables(Path(path), names)
    frequency = _vector(held[layout.frequency], layout.frequency, path)
    check_frequencies(frequency, Path(path))
    damping = _vector(held[layout.damping], layout.damping, path) if layout.damping else None
    dofs = [Dof.of(d) for d in layout.dofs]
    shapes = held[layout.shapes] if layout.shapes else None
    if shapes is not None and (shapes.shape != (len(dofs), len(frequency)) or not np.isfinite(shapes).all()):
        raise InputError(
            f"{path}: {layout.shapes!r} has shape {shapes.shape} for {len(dofs)} dofs and {len(frequency)} modes, or "
            "has gaps; give one row per entry of dofs and one column per mode"
        )
    if damping is not None and len(damping) != len(frequency):
        raise InputError(
            f"{path}: {len(frequency)} frequencies but {len(damping)} values of {layout.damping!r}; correct the names"
        )
    sign = np.array([dof.sign for dof in dofs], dtype=np.float64)
    modal = ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan),
        damping=damping if damping is None else damping * (0.01 if layout.damping_unit == "percent" else 1.0),
        dofs=tuple(Dof(dof.node, abs(dof.direction)) for dof in dofs),
        shapes=None if shapes is None else np.asarray(sign[:, None] * shapes, dtype=np.complex128),
        scaled=layout.scaled,
        geometry=geometry,
    )
    return checked(modal, Path(path), percent='damping_unit = "percent" in [mat]')


def _vector(values: AnyArray, name: str, path: Path | str) -> FloatArray:
    """Return a row or a column as a vector."""
    if np.iscomplexobj(values) or values.size != max(values.shape) or not values.size:
        raise InputError(
            f"{path}: {name!r} of shape {values.shape} is not a row or column of real numbers; name another"
        )
    if not np.isfinite(values).all():
        raise InputError(f"{path}: {name!r} has gaps; fill them or leave them out")
    return np.asarray(values, dtype=np.float64).ravel()
