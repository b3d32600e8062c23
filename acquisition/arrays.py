"""Names for the array types that cross module borders."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
AnyArray = NDArray[Any]


def frozen_array(values: Any, dtype: Any = np.float64) -> NDArray[Any]:
    """Return a read-only copy of ``values``, so that a frozen dataclass is frozen to the last number."""
    array = np.array(values, dtype=dtype)
    array.setflags(write=False)
    return array
