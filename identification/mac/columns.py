"""What every measure of the family does first: bring two sets into the same form."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import AnyArray, ComplexArray, FloatArray
from acquisition.errors import InputError

TINY = float(np.finfo(float).tiny)


def columns(a: AnyArray) -> ComplexArray:
    """Return shapes as (n_dofs, n_modes), a single shape as one column.

    Raises
    ------
    InputError
        If there are more than two dimensions or values are not finite.
    """
    shapes = np.asarray(a, dtype=complex)
    shapes = shapes[:, None] if shapes.ndim == 1 else shapes
    if shapes.ndim != 2:
        raise InputError(
            f"an array of shape {shapes.shape} is not a set of mode shapes; give (n_dofs, n_modes)"
        )
    bad = ~np.isfinite(shapes)
    if bad.any():
        row, column = np.argwhere(bad)[0]
        raise InputError(
            f"{int(bad.sum())} components are not finite, the first in row {row}, column {column}; leave those "
            "degrees of freedom out"
        )
    return shapes


def both(a: AnyArray, b: AnyArray) -> tuple[ComplexArray, ComplexArray]:
    """Return two sets at the same degrees of freedom.

    Raises
    ------
    InputError
        If their degrees of freedom disagree.
    """
    first, second = columns(a), columns(b)
    if first.shape[0] != second.shape[0]:
        raise InputError(
            f"arrays of shapes {first.shape} and {second.shape}: both must have one row for each degree of freedom "
            "in common"
        )
    return first, second


def paired(a: AnyArray, b: AnyArray) -> tuple[ComplexArray, ComplexArray]:
    """Return two sets whose columns belong together one by one.

    Raises
    ------
    InputError
        If the shapes of the arrays disagree.
    """
    first, second = both(a, b)
    if first.shape != second.shape:
        raise InputError(f"shapes of {first.shape} and {second.shape}: the modes must be paired one to one")
    return first, second


def unit(shapes: ComplexArray) -> ComplexArray:
    """Bring every column to unit length, whatever its unit; a zero column stays zero [-]."""
    size = np.abs(shapes).max(axis=0, initial=0.0)
    near_one = shapes / np.where(size > 0, size, 1.0)
    return np.asarray(near_one / np.maximum(np.linalg.norm(near_one, axis=0), TINY))


def ratio(over: FloatArray, under: FloatArray, *, empty: float = 0.0) -> FloatArray:
    """Return over / under, at most 1, and ``empty`` where there is nothing to divide by [-]."""
    safe = np.where(under > TINY, under, 1.0)
    return np.asarray(np.where(under > TINY, np.minimum(over / safe, 1.0), empty))


def undefined(values: FloatArray, count: int) -> FloatArray:
    """Return nan throughout if there are not two components to compare."""
    return values if count > 1 else np.full(values.shape, np.nan)
