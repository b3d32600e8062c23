"""Raw hits by time integration of M, C, K: no modes, no residues, no frequency domain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from acquisition import Dof, HammerTest, Hits

FINE = 16  # steps per sample


@dataclass(frozen=True, eq=False)
class Structure:
    """A structure with general viscous damping; node n is row n - 1, in +z."""

    mass: NDArray[np.float64]
    damping: NDArray[np.float64]
    stiffness: NDArray[np.float64]

    @property
    def state(self) -> NDArray[np.float64]:
        n = len(self.mass)
        return np.block(
            [
                [np.zeros((n, n)), np.eye(n)],
                [-np.linalg.solve(self.mass, self.stiffness), -np.linalg.solve(self.mass, self.damping)],
            ]
        )

    def truth(self) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Poles with Im > 0, and modal constants 2 i Im(p) R of all pairs of rows, (n_modes, n, n)."""
        values, vectors = np.linalg.eig(self.state)
        up = np.flatnonzero(values.imag > 0)
        up = up[np.argsort(np.abs(values[up]))]
        poles, shapes = values[up], vectors[: len(self.mass), up].T
        modal = np.einsum("ri,rij,rj->r", shapes, 2 * poles[:, None, None] * self.mass + self.damping, shapes)
        scale = 2j * poles.imag / modal
        return poles, scale[:, None, None] * shapes[:, :, None] * shapes[:, None, :]

    def accelerations(self, push, inputs, outputs, step: float):
        """Integrate from rest: exact exponential steps for forces that are straight from step to step.

        push is (n_steps, n_columns) on rows ``inputs`` (n_columns,); returns (n_steps, n_outputs, n_columns).
        """
        n, columns = len(self.mass), np.arange(push.shape[1])
        wide = np.zeros((4 * n, 4 * n))
        wide[: 2 * n, : 2 * n] = self.state
        wide[n : 2 * n, 2 * n : 3 * n] = np.linalg.inv(self.mass)
        wide[2 * n : 3 * n, 3 * n :] = np.eye(n) / step
        moved = scipy.linalg.expm(wide * step)[: 2 * n]
        free, held, rising = moved[:, : 2 * n], moved[:, 2 * n : 3 * n], moved[:, 3 * n :]
        observe, feed = self.state[n:][outputs], np.linalg.inv(self.mass)[outputs]
        x = np.zeros((2 * n, len(columns)))
        force, following = np.zeros((n, len(columns))), np.zeros((n, len(columns)))
        result = np.empty((len(push), len(outputs), len(columns)))
        last = int(np.flatnonzero(np.abs(push).max(axis=1))[-1]) + 1
        for k in range(len(push)):
            if k > last:
                result[k] = observe @ x
                x = free @ x
                continue
            force[inputs, columns] = push[k]
            following[inputs, columns] = push[min(k + 1, len(push) - 1)]
            result[k] = observe @ x + feed @ force
            x = free @ x + held @ force + rising @ (following - force)
        return result


def chain(n: int = 6) -> Structure:
    """Masses between springs with two local dampers: damping that is not proportional."""
    mass = np.diag(np.linspace(1.0, 0.5, n))
    springs = 4.0e5 * np.linspace(1.3, 0.8, n + 1)
    stiffness = np.diag(springs[:-1] + springs[1:]) - np.diag(springs[1:-1], 1) - np.diag(springs[1:-1], -1)
    damping = 6e-6 * stiffness + 0.5 * mass
    damping[1, 1] += 4.0
    damping[-1, -1] += 2.0
    return Structure(mass, damping, stiffness)


@dataclass(frozen=True)
class Rig:
    """How the structure is hit: rows of sensors and points, hits at each, noise and window."""

    sensors: tuple[int, ...] = (1, 4)
    points: tuple[int, ...] = (0, 1, 3, 4)
    hits: int = 5
    rate: float = 1024.0
    samples: int = 2048
    peak: float = 100.0
    width: float = 3e-3
    noise: float = 0.3  # m/s^2
    force_noise: float = 0.02  # N
    decay: float = 3.0


def hammer_tests(structure: Structure, rig: Rig, rngs: list[np.random.Generator]) -> list[HammerTest]:
    """One test per generator: pulses scattered in level, width and start, all integrated side by side."""
    shape = (len(rngs), len(rig.points), rig.hits)
    scatter = np.array([rng.standard_normal((3, *shape[1:])) for rng in rngs])
    level = rig.peak * np.exp(0.2 * scatter[:, 0]).ravel()
    width = rig.width * np.exp(0.05 * scatter[:, 1]).ravel()
    start = 0.03 + 1e-3 * scatter[:, 2].ravel()
    step = 1 / (FINE * rig.rate)
    phase = (np.arange(FINE * rig.samples)[:, None] * step - start) / width
    push = np.where((phase > 0) & (phase < 1), level * np.sin(np.pi * np.clip(phase, 0, 1)) ** 2, 0.0)
    inputs = np.broadcast_to(np.array(rig.points)[:, None], shape).ravel()
    motion = structure.accelerations(push, inputs, list(rig.sensors), step)
    force, motion = sampled(push).T.reshape(*shape, -1), np.moveaxis(sampled(motion), 0, -1)
    motion = np.moveaxis(motion, 0, 1).reshape(*shape, len(rig.sensors), -1)
    return [_test(f, m, rig, rng) for f, m, rng in zip(force, motion, rngs, strict=True)]


def sampled(fine):
    """Pass the anti-aliasing filter (linear phase, delay taken out) and keep every 16th step."""
    taps = scipy.signal.firwin(32 * FINE + 1, 0.84 / FINE, window=("kaiser", 8.0))
    padded = np.concatenate([fine, np.zeros((16 * FINE, *fine.shape[1:]))])
    return scipy.signal.upfirdn(taps, padded, down=FINE, axis=0)[16 : 16 + len(fine) // FINE]


def _test(force, motion, rig: Rig, rng: np.random.Generator) -> HammerTest:
    window = np.exp(-rig.decay * np.arange(rig.samples) / rig.rate)
    force = (force + rig.force_noise * rng.standard_normal(force.shape)) * window
    motion = (motion + rig.noise * rng.standard_normal(motion.shape)) * window
    dofs = tuple(Dof(row + 1, 3) for row in rig.sensors)
    points = tuple(
        Hits(Dof(row + 1, 3), dofs, f, m) for row, f, m in zip(rig.points, force, motion, strict=True)
    )
    return HammerTest(rig.rate, points, "accelerance", decay=rig.decay, source="time integration")
