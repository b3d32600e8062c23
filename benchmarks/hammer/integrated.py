"""Hammer tests by integration in time, without anything of the library's own synthetic test.

Modes, damping that is not proportional, pulses, filters, converters, windows, places of the hits and drift are drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from acquisition import Dof, HammerTest, Hits

Array = NDArray[np.float64]
FINE = 8
"""Steps of the integration per sample."""
ABOVE = 3
"""Modes above the band."""
OFF = 3
"""Shapes of hits that miss their point: there, and by their slopes along two axes."""


@dataclass(frozen=True, eq=False)
class Structure:
    """A structure in modal coordinates: unit mass, stiffness and a full damping matrix.

    Parameters
    ----------
    stiffness, damping : (n, n) arrays
        Of the undamped modes' coordinates [1/s^2], [1/s].
    sensors : (n_sensors, n) array
        Shapes at the sensors [1/sqrt(kg)].
    points : (3, n_points, n) array
        Shapes at the points hit, and their slopes along two axes [1/sqrt(kg)], [1/(m sqrt(kg))].
    top : float
        Upper end of the band [Hz].
    """

    stiffness: Array
    damping: Array
    sensors: Array
    points: Array
    top: float

    def modes(self, shift: float = 0.0) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Return all poles [rad/s] and right vectors of the first-order equations, frequencies higher by a part."""
        n = len(self.stiffness)
        state = np.block([[np.zeros((n, n)), np.eye(n)], [-self.stiffness, -self.damping]])
        values, vectors = np.linalg.eig(state)
        return values * (1.0 + shift), vectors

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles above the real axis, rising [rad/s]."""
        values = self.modes()[0]
        upper = values[values.imag > 0]
        return upper[np.argsort(np.abs(upper))]


@dataclass(frozen=True)
class Procedure:
    """How a structure is tested."""

    rate: float
    samples: int
    hits: int
    window: float
    filter: str
    bits: int
    noise: float
    force_noise: float
    misses: float
    drift: float
    width: float


def structure(rng: np.random.Generator) -> Structure:
    """Draw a structure: 4 to 9 modes in the band, now and then two of them 1 to 3 % apart."""
    count = int(rng.integers(4, 10)) + ABOVE
    hertz = rng.uniform(15.0, 60.0) * np.cumprod(np.append(1.0, rng.uniform(1.12, 1.7, count - 1)))
    if rng.random() < 0.4:
        k = int(rng.integers(0, count - ABOVE - 1))
        hertz[k + 1] = hertz[k] * rng.uniform(1.01, 1.03)
    omega, zeta = 2 * np.pi * hertz, 10 ** rng.uniform(-3.0, -1.9, count)
    points = int(rng.integers(6, 16))
    place = rng.uniform(size=(points, 2))
    wave, phase = rng.uniform(1.0, 4.0, (2, count)) * np.pi, rng.uniform(0, 2 * np.pi, (2, count))
    angle = [place[:, [a]] * wave[a] + phase[a] for a in (0, 1)]
    mass = rng.uniform(0.5, 8.0)
    shape = 2 * np.cos(angle[0]) * np.cos(angle[1]) / np.sqrt(mass)
    slopes = [-2 * wave[a] * np.sin(angle[a]) * np.cos(angle[1 - a]) / np.sqrt(mass) / 0.5 for a in (0, 1)]
    damping = np.diag(2 * zeta * omega)
    for _ in range(int(rng.integers(1, 3))):  # a dashpot at a point: damping that is not proportional
        at = shape[int(rng.integers(points))]
        strongest = int(np.argmax(at**2 / omega))
        damping += 2 * rng.uniform(0.001, 0.006) * omega[strongest] / at[strongest] ** 2 * np.outer(at, at)
    top = (
        hertz[-ABOVE] * rng.uniform(0.85, 0.97) if hertz[-ABOVE] > 1.1 * hertz[-ABOVE - 1] else hertz[-ABOVE]
    )
    sensors = rng.choice(points, int(rng.integers(1, 3)), replace=False)
    return Structure(np.diag(omega**2), damping, shape[sensors], np.stack([shape, *slopes]), float(top))


def procedure(made: Structure, rng: np.random.Generator) -> Procedure:
    """Draw how it is tested: with an exponential window, or without one to the end of the ringing or before."""
    inside = made.poles[np.abs(made.poles) < 2 * np.pi * made.top]
    slowest = float(np.min(-inside.real))
    rate = 2.56 * made.top
    windowed = rng.random() < 0.5
    duration = min(float(rng.uniform(1.0, 3.0) if windowed else rng.uniform(2.0, 8.0)) / slowest, 16.0)
    return Procedure(
        rate=rate, samples=int(2 ** np.ceil(np.log2(rate * duration))), hits=int(rng.integers(3, 7)),
        window=max(0.0, 4.6 / duration - slowest) if windowed else 0.0,
        filter=str(rng.choice(["linear phase", "butterworth", "elliptic"])), bits=int(rng.choice([16, 24])),
        noise=10 ** rng.uniform(-4.0, -2.3), force_noise=10 ** rng.uniform(-4.0, -2.7),
        misses=rng.uniform(0.0, 1e-3), drift=float(rng.choice([0.0, 1e-4])), width=rng.uniform(0.5, 1.3) / made.top,
    )  # fmt: skip


def recorded(made: Structure, plan: Procedure, rng: np.random.Generator) -> HammerTest:
    """Hit all points and record; the window is stated, and on force and responses alike."""
    window = np.exp(-plan.window * np.arange(plan.samples) / plan.rate)
    dofs = tuple(Dof(101 + k, 3) for k in range(len(made.sensors)))
    entries = []
    for j in range(made.points.shape[1]):
        shift = plan.drift * (j / made.points.shape[1] - 0.5 + 0.3 * rng.standard_normal())
        records = [_hit(made, plan, j, shift, rng) for _ in range(plan.hits)]
        force, motion = np.array([r[0] for r in records]), np.array([r[1] for r in records])
        entries.append(Hits(Dof(j + 1, 3), dofs, force * window, motion * window))
    return HammerTest(plan.rate, tuple(entries), "accelerance", decay=plan.window, source="integrated")


def _hit(
    made: Structure, plan: Procedure, j: int, shift: float, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Return the records of one hit: (n_samples,) and (n_sensors, n_samples)."""
    step, count = 1.0 / (FINE * plan.rate), FINE * plan.samples
    time = np.arange(count) * step - (0.01 + 2e-4 * rng.standard_normal()) - 2.0 / plan.rate
    width, level = (
        plan.width * np.exp(0.1 * rng.standard_normal()),
        80.0 * np.exp(0.3 * rng.standard_normal()),
    )
    phase = np.clip(time / width, 0.0, 1.0)
    push = level * np.sin(np.pi * phase ** rng.uniform(0.8, 1.0)) ** rng.uniform(1.2, 2.0)
    missed = np.array([1.0, *(plan.misses * rng.standard_normal(OFF - 1))])
    motion = _accelerations(made, push, missed @ made.points[:, j], shift, step)
    force, motion = _sampled(push, plan), np.array([_sampled(row, plan) for row in motion])
    force = force + plan.force_noise * level * rng.standard_normal(plan.samples)
    motion = motion + plan.noise * np.std(motion, axis=1, keepdims=True) * rng.standard_normal(motion.shape)
    return _converted(force, 300.0, plan), _converted(motion, 2.0 * np.abs(motion).max(), plan)


def _accelerations(made: Structure, push: Array, at: Array, shift: float, step: float) -> Array:
    """Integrate the first-order modes, exactly for a force that is straight from step to step."""
    n = len(made.stiffness)
    poles, vectors = made.modes(shift)
    upper = poles.imag > 0
    entry = np.linalg.solve(vectors, np.append(np.zeros(n), at).astype(complex))[upper]
    poles, vectors = poles[upper], vectors[:, upper]
    total = np.zeros((len(made.sensors), len(push)))
    grown = np.exp(poles * step)
    for r, p in enumerate(poles):
        one = (grown[r] - 1.0) / p
        two = (one - step) / (p * step)
        # q(k+1) = e^(p h) q(k) + (one - two) f(k) + two f(k+1)
        q = signal.lfilter([two, one - two], [1.0, -grown[r]], entry[r] * push)
        rate = vectors[n:, r] * p
        total += 2 * np.real((made.sensors @ rate)[:, None] * q[None, :])
    direct = made.sensors @ at
    return total + direct[:, None] * push[None, :]


def _sampled(fine: Array, plan: Procedure) -> Array:
    """Pass the filter before the converter and keep every eighth step."""
    edge = 0.88 / FINE
    if plan.filter == "linear phase":
        taps = signal.firwin(32 * FINE + 1, edge, window=("kaiser", 8.0))
        padded = np.concatenate([fine, np.zeros(16 * FINE)])
        return signal.upfirdn(taps, padded, down=FINE)[16 : 16 + plan.samples]
    made = (
        signal.butter(8, edge, output="sos")
        if plan.filter == "butterworth"
        else signal.ellip(8, 0.05, 80.0, edge, output="sos")
    )
    return np.asarray(signal.sosfilt(made, fine)[::FINE])


def _converted(values: Array, full: float, plan: Procedure) -> Array:
    unit = full / 2 ** (plan.bits - 1)
    return np.asarray(np.clip(np.round(values / unit), -(2 ** (plan.bits - 1)), 2 ** (plan.bits - 1)) * unit)
