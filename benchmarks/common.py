"""What the benchmarks of the pole estimators share: the structure, the clock, and the floors."""

from __future__ import annotations

import contextlib
import io
import time
import warnings
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import fft, linalg

from acquisition import Dof, FrfSet

HERTZ = np.array([62.0, 118, 187, 243, 310, 402, 405.5, 478, 566, 655, 763, 884])
DAMPING = np.array([2.0, 1.2, 0.9, 0.7, 0.6, 0.5, 0.4, 0.35, 0.3, 0.28, 0.24, 0.2]) / 100
_CIRCLE = 4096  # points on the circle in identification.poles.stable
_SHORT = 24  # order up to which identification.poles.nested takes companion matrices


def synthetic(outputs: int, lines: int, rng: np.random.Generator) -> FrfSet:
    """Accelerances of twelve modes on ``lines`` lines from 0 to 1000 Hz, with 1 % noise."""
    frequency = np.linspace(0.0, 1000.0, lines)
    s = 2j * np.pi * frequency
    omega = 2 * np.pi * HERTZ
    poles = omega * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2))
    shapes = rng.standard_normal((outputs, len(HERTZ)))
    terms = (1 / (s[:, None] - poles) - 1 / (s[:, None] - poles.conj())) / (2j * poles.imag)
    values = (shapes * shapes[0]) @ terms.T * s**2
    noise = rng.standard_normal((2, *values.shape)) * 0.01 * np.sqrt(np.mean(np.abs(values) ** 2) / 2)
    responses = tuple(Dof(i + 1, 3) for i in range(outputs))
    return FrfSet(frequency, values + noise[0] + 1j * noise[1], responses, (Dof(1, 3),) * outputs)


def seconds(run: Callable[[], object], repeats: int) -> float:
    """Best processor time of some runs: with one thread, what a clock would show on an idle machine [s]."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


def modes_found(poles: NDArray[np.complex128]) -> int:
    """Count the twelve modes that have a pole of their own within 0.1 % in frequency and 20 % in damping."""
    hertz, ratio = np.abs(poles) / (2 * np.pi), -poles.real / np.maximum(np.abs(poles), 1e-300)
    near = (np.abs(hertz[:, None] / HERTZ - 1) < 1e-3) & (np.abs(ratio[:, None] / DAMPING - 1) < 0.2)
    return int(near.any(axis=0).sum())


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep a peer's progress bars and warnings out of the output."""
    with (
        warnings.catch_warnings(),
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
    ):
        warnings.simplefilter("ignore")
        yield


def classic_floor(orders: Sequence[int], transforms: Callable[[], object]) -> float:
    """Time the transforms, one Cholesky factor, and one triangular solve and zgeev for every order [s]."""
    return (
        seconds(transforms, 7)
        + seconds(lambda: _solves(orders), 7)
        + seconds(lambda: _eigenvalues(orders), 3)
    )


def own_floor(orders: Sequence[int], transforms: Callable[[], object]) -> float:
    """The same with two transforms along the circle and zgeev of twelve in place of zgeev of a long order [s]."""
    short = [n if n <= _SHORT else len(HERTZ) for n in orders]
    circle = np.ones((2 * sum(n > _SHORT for n in orders), _CIRCLE), complex)
    total = seconds(transforms, 7) + seconds(lambda: _solves(orders), 7)
    return total + seconds(lambda: fft.ifft(circle, axis=1), 7) + seconds(lambda: _eigenvalues(short), 3)


def _solves(orders: Sequence[int]) -> None:
    n = max(orders)
    rng = np.random.default_rng(2)
    square = rng.standard_normal((2 * n, n)) + 1j * rng.standard_normal((2 * n, n))
    factor, _ = linalg.lapack.zpotrf(square.conj().T @ square, lower=1)
    right = np.ones((n, 1), complex)
    for order in orders:
        linalg.lapack.ztrtrs(factor[:order, :order], right[:order], lower=1)


def _eigenvalues(orders: Sequence[int]) -> None:
    rng = np.random.default_rng(3)
    for order in orders:
        companion = np.zeros((order, order), complex)
        companion[0] = 0.3 * (rng.standard_normal(order) + 1j * rng.standard_normal(order))
        companion[np.arange(1, order), np.arange(order - 1)] = 1.0
        linalg.lapack.zgeev(companion, compute_vl=0, compute_vr=0, overwrite_a=1)
