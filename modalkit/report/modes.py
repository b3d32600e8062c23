"""The modes of a test as a table: what was found, with its standard deviations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from acquisition import ModalData
from acquisition.arrays import FloatArray
from acquisition.quantities import decimals
from identification import mpc
from modalkit.report.html import Cell, Column, Raw, table


def modes_table(modal: ModalData) -> Raw:
    """Return one row per mode; values have the digits that the best known of them determines.

    Parameters
    ----------
    modal : ModalData
        Modes, identified or read.
    """
    damped = modal.damping is not None and modal.damping_sigma is not None
    purity = None if modal.shapes is None else mpc(modal.shapes)
    sigma = np.asarray(modal.frequency_sigma, dtype=float)
    columns = [
        Column("mode", lambda v: f"{v:.0f}"),
        Column("frequency [Hz]", _written(sigma)),
        Column("± sigma [Hz]", _short),
    ]
    rows: list[list[Cell | Raw]] = [
        [r + 1, float(modal.frequency[r]), float(sigma[r])] for r in range(len(modal))
    ]
    if damped:
        assert modal.damping is not None
        assert modal.damping_sigma is not None
        scatter = 100 * np.asarray(modal.damping_sigma, dtype=float)
        columns += [Column("damping [%]", _written(scatter)), Column("± sigma [%]", _short)]
        rows = [[*row, 100 * float(modal.damping[r]), float(scatter[r])] for r, row in enumerate(rows)]
    if purity is not None:
        columns.append(Column("MPC", lambda v: f"{v:.3f}"))
        rows = [[*row, float(purity[r])] for r, row in enumerate(rows)]
    real = "; MPC is 1 for a real mode" if purity is not None else ""
    what = "Frequencies and damping ratios" if damped else "Frequencies"
    return table(f"{what} of the test with one standard deviation{real}.", columns, rows)


def _written(sigma: FloatArray) -> Callable[[float], str]:
    known = [d for s in sigma if (d := decimals(float(s))) is not None]
    # decimals of a value whose standard deviation is not known
    return f"{{:.{max(known, default=4)}f}}".format


def _short(value: float) -> str:
    return f"{value:.2g}"
