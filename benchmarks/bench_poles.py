"""Poles, chart and residues: modalkit beside sdypy-EMA on the same synthetic FRFs, as ratios of one run."""

from __future__ import annotations

import contextlib
import io
import time
import warnings
from collections.abc import Callable

import numpy as np
from sdypy import EMA

from acquisition import Dof, FrfSet
from identification import fit_residues, lscf, stabilise

HERTZ = np.array([62.0, 118, 187, 243, 310, 402, 405.5, 478, 566, 655, 763, 884])
DAMPING = np.array([2.0, 1.2, 0.9, 0.7, 0.6, 0.5, 0.4, 0.35, 0.3, 0.28, 0.24, 0.2]) / 100


def synthetic(outputs: int, rng: np.random.Generator) -> FrfSet:
    """Accelerances of twelve modes, 0-1000 Hz in steps of 1 Hz, with 1 % noise."""
    frequency = np.arange(1.0, 1001.0)
    s = 2j * np.pi * frequency
    omega = 2 * np.pi * HERTZ
    poles = omega * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2))
    shapes = rng.standard_normal((outputs, len(HERTZ)))
    terms = (1 / (s[:, None] - poles) - 1 / (s[:, None] - poles.conj())) / (2j * poles.imag)
    values = (shapes * shapes[0]) @ terms.T * s**2
    noise = rng.standard_normal((2, *values.shape)) * 0.01 * np.sqrt(np.mean(np.abs(values) ** 2) / 2)
    responses = tuple(Dof(i + 1, 3) for i in range(outputs))
    return FrfSet(frequency, values + noise[0] + 1j * noise[1], responses, (Dof(1, 3),) * outputs)


def ours(frfs: FrfSet) -> None:
    """Poles at 49 orders up to 100, the chart, and residues of the twelve modes nearest the truth."""
    sets = lscf(frfs, orders=list(range(4, 101, 2)))
    stabilise(sets, band=(float(frfs.frequency[0]), float(frfs.frequency[-1])))
    omega = 2 * np.pi * HERTZ
    fit_residues(frfs, omega * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2)))


def theirs(frfs: FrfSet, order: int) -> None:
    """The same with sdypy-EMA."""
    with (
        warnings.catch_warnings(),
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
    ):
        warnings.simplefilter("ignore")
        model = EMA.Model(
            frf=frfs.values,
            freq=frfs.frequency,
            lower=10,
            upper=1000,
            pol_order_high=order,
            frf_form="accelerance",
        )
        model.get_poles(method="lscf", show_progress=False)
        model.select_closest_poles(list(HERTZ))
        model.get_constants(method="lsfd")


def seconds(run: Callable[[], None], repeats: int) -> float:
    """Best of some runs [s]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    """Print the ratios; sdypy-EMA's order counts pairs of poles, so that its 50 compares with our 100 as well."""
    rng = np.random.default_rng(1)
    for outputs in (25, 250):
        frfs = synthetic(outputs, rng)
        own = seconds(lambda f=frfs: ours(f), 5)
        for order in (50, 100):
            peer = seconds(lambda f=frfs, n=order: theirs(f, n), 2)
            label = f"{outputs} outputs, pol_order_high {order}"
            print(f"{label}: {own:.3f} s, sdypy-EMA {peer:.3f} s, ratio {peer / own:.1f}")


if __name__ == "__main__":
    main()
