"""What an update by FRFs hands back beside what every update does."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from acquisition.quantities import percent
from updating.models.state import State
from updating.update.result import Update


@dataclass(frozen=True, eq=False, kw_only=True)
class FrfUpdate(Update):
    """An update by FRFs.

    Parameters
    ----------
    frac : DataFrame
        One row per FRF: nodes of response and force; FRAC before, after each stage but the last, and after [-].
    stages : tuple of int
        Number of iterations of each stage; ``history`` holds them one behind the other.
    lines : tuple of tuple of float
        Frequencies compared in each stage [Hz].
    discrepancy : tuple of float
        What the model cannot follow in each stage, relative to the FRFs, r.m.s. [-].
    state : State
        The updated model, as a departure from the case's nominal one.

    Notes
    -----
    ``pairs`` also has the damping ratios measured, before and after [-].
    """

    frac: pd.DataFrame
    stages: tuple[int, ...]
    lines: tuple[tuple[float, ...], ...]
    discrepancy: tuple[float, ...]
    state: State

    def report(self) -> str:
        """Return the whole result as text, stage by stage."""
        together = len(self.discrepancy) == 1 and len(self.stages) > 1
        names = ["all together"] if together else [f"stage {i + 1}" for i in range(len(self.discrepancy))]
        rows = zip(names, self.lines, self.discrepancy, strict=True)
        stated = [
            f"    {name}: {len(lines)} lines from {lines[0]:.4g} to {lines[-1]:.4g} Hz, "
            f"model off by {percent(100 * size)}"
            for name, lines, size in rows
        ]
        steps = "    iterations, stage after stage: " + ", ".join(str(n) for n in self.stages)
        return "\n".join([super().report(), "[[Stages]]", *stated, steps])

    def damping_error_percent(self, which: str = "after") -> float:
        """Return the mean magnitude of the relative error of the damping ratios, ``before`` or ``after`` [%]."""
        used = self.pairs[self.pairs["used"]]
        return float(100 * (used[f"{which}_damping"] / used["test_damping"] - 1).abs().mean())
