"""One record of channels that a library has read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from acquisition.errors import InputError
from acquisition.recorders.channels import Channels


@dataclass(frozen=True, eq=False, kw_only=True)
class Recorded(Channels):
    """Channels as arrays.

    Parameters
    ----------
    values : tuple of arrays
        The samples of each channel, one dimension each.
    record : int or None
        Number of the record in its file, from 1; None where there is one.
    relative : bool
        Whether the numbers are parts of the full scale, which only a layout can state.
    """

    values: tuple[AnyArray, ...]
    record: int | None = None
    relative: bool = False

    @property
    def width(self) -> int:
        """How many channels there are."""
        return len(self.values)

    @property
    def where(self) -> str:
        """The file and the number of the record."""
        return f"{self.path}" + ("" if self.record is None else f", record {self.record}")

    @property
    def needs_scale(self) -> bool:
        """Whether the layout has to state what the numbers are multiplied by."""
        return self.relative

    def numbers(self, index: Sequence[int]) -> FloatArray:
        """Return channels as numbers, shape (n_samples, len(index))."""
        counts = {i: len(self.values[i]) for i in index}
        if not min(counts.values()) or len(set(counts.values())) > 1:
            self.of_one_length(counts)
        columns = [self._checked(i) for i in index]
        return np.stack(columns, axis=1)

    def _checked(self, index: int) -> FloatArray:
        values = self.values[index]
        if values.dtype.kind not in "fiu":
            raise InputError(
                f"{self.where}: {self.label(index)} holds {values.dtype.name}, not real numbers; name "
                "another channel"
            )
        numbers = np.asarray(values, dtype=np.float64)
        bad = np.flatnonzero(~np.isfinite(numbers))
        if len(bad):
            raise InputError(
                f"{self.line(int(bad[0]))}: {self.label(index)} is not a finite number; record it again, or cut the "
                "record before it"
            )
        return numbers
