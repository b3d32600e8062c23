"""Structures with known modes and their analytic FRFs, for the tests of identification."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acquisition.dof import Dof
from acquisition.form import FORMS, Form
from acquisition.frfs.frf import FrfSet

BENCH_HZ = (62.0, 118.0, 187.0, 243.0, 310.0, 402.0, 405.5, 478.0, 566.0, 655.0, 763.0, 884.0)
BENCH_DAMPING = (0.02, 0.012, 0.009, 0.007, 0.006, 0.005, 0.004, 0.0035, 0.003, 0.0028, 0.0024, 0.002)
ABOVE_HZ, ABOVE_DAMPING = (1080.0, 1250.0), (0.002, 0.003)


@dataclass(frozen=True)
class Structure:
    """Modes of a structure: mass-normalised shapes of nodes 1 ... n in +z."""

    poles: NDArray[np.complex128]
    shapes: NDArray[np.float64]

    @property
    def hertz(self) -> NDArray[np.float64]:
        return np.abs(self.poles) / (2 * np.pi)

    @property
    def damping(self) -> NDArray[np.float64]:
        return np.asarray(-self.poles.real / np.abs(self.poles))

    def within(self, low: float, high: float) -> NDArray[np.bool_]:
        return np.asarray((self.hertz >= low) & (self.hertz <= high))

    def receptance(self, laplace, response: int, reference: int):
        """Sum of modes between two nodes."""
        constants = self.shapes[response - 1] * self.shapes[reference - 1] / (2j * self.poles.imag)
        terms = 1 / (laplace[:, None] - self.poles) - 1 / (laplace[:, None] - self.poles.conj())
        return terms @ constants

    def frfs(
        self,
        frequency,
        pairs,
        *,
        form: Form = "accelerance",
        decay: float = 0.0,
        noise: float = 0.0,
        rng: np.random.Generator | None = None,
        colour=None,
    ) -> FrfSet:
        """FRFs of (response, reference) nodes; noise relative to each FRF's r.m.s."""
        laplace = 2j * np.pi * frequency + decay
        values = np.array([self.receptance(laplace, i, j) for i, j in pairs]) * laplace ** FORMS.index(form)
        if rng is not None:
            dirt = rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)
            level = noise * np.sqrt(np.mean(np.abs(values) ** 2, axis=1, keepdims=True) / 2)
            values = values + level * dirt * (1.0 if colour is None else colour)
        return FrfSet(
            frequency,
            values,
            tuple(Dof(i, 3) for i, _ in pairs),
            tuple(Dof(j, 3) for _, j in pairs),
            form=form,
            decay=decay,
        )


def structure(hertz, damping, n_points: int, seed: int) -> Structure:
    """Draw shapes; node 4 moves in every mode, so it serves as the reference."""
    circular, ratio = 2 * np.pi * np.array(hertz), np.array(damping)
    shapes = np.random.default_rng(seed).standard_normal((n_points, len(circular)))
    shapes[3] = np.sign(shapes[3]) * np.maximum(np.abs(shapes[3]), 0.3)
    return Structure(circular * (-ratio + 1j * np.sqrt(1 - ratio**2)), shapes)


def bench(*, seed: int = 0, above: bool = True, n_points: int = 25) -> Structure:
    """Twelve modes with a pair 0.9 % apart, and two above 1000 Hz on request."""
    if above:
        return structure(BENCH_HZ + ABOVE_HZ, BENCH_DAMPING + ABOVE_DAMPING, n_points, seed)
    return structure(BENCH_HZ, BENCH_DAMPING, n_points, seed)


def column(n_points: int = 25, reference: int = 4) -> list[tuple[int, int]]:
    """All points against one reference."""
    return [(i, reference) for i in range(1, n_points + 1)]


def lines(df: float = 0.5, low: float = 0.0, high: float = 1000.0):
    """Frequency lines [Hz]."""
    return np.arange(round(low / df), round(high / df) + 1) * df
