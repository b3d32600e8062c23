"""Names for the array types that cross module borders."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
AnyArray = NDArray[Any]

_SINGLE = {np.dtype(np.float64): np.dtype(np.float32), np.dtype(np.complex128): np.dtype(np.complex64)}


_CACHED = 131072
"""Values of an array that stay in cache through a chain of operations [-]. Four times as many take a fourth
longer, and so do a fourth as many."""


def row_blocks(shape: tuple[int, ...]) -> Iterator[slice]:
    """Yield blocks of rows of a large array that stay in cache, so that what is made of them is not memory either."""
    step = max(1, _CACHED // max(1, shape[1]))
    for first in range(0, shape[0], step):
        yield slice(first, first + step)


def squared(values: ComplexArray) -> FloatArray:
    """Return |values|^2, without the square root that the magnitude takes."""
    return np.asarray(values.real**2 + values.imag**2)


def frozen_array(values: Any, dtype: Any = np.float64, *, keep_single: bool = False) -> NDArray[Any]:
    """Return ``values`` read-only, so that a frozen dataclass is frozen to the last number.

    Parameters
    ----------
    values : array_like
        Copied, unless it is an array that can no longer be written to.
    dtype : dtype
        Wanted type.
    keep_single : bool
        Whether an array in the single precision of ``dtype`` stays as it is.
    """
    wanted = np.dtype(dtype)
    given = getattr(values, "dtype", None)
    if keep_single and given is not None and given == _SINGLE.get(wanted):
        wanted = given
    if given == wanted and _is_frozen(values):
        return np.asarray(values)
    array = np.array(values, dtype=wanted)
    array.setflags(write=False)
    return array


def _is_frozen(values: Any) -> bool:
    """Return whether an array and whatever it is a view of are read-only and numpy's own."""
    if type(values) is not np.ndarray:
        return False
    array: Any = values
    while type(array) is np.ndarray:
        if array.flags.writeable:
            return False
        array = array.base
    return array is None
