"""An exact beam by transfer matrices, which shares nothing with the finite elements, and honest tests of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from updating import Case, Damping, Material, Measured, Predictor, Spec, Tolerances
from updating.prediction.prediction import Prediction

STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec(
    "beam",
    length=0.376,
    width=0.0305,
    thickness=0.0047625,
    elements=(40,),
    clamped=("x0",),
    theory="timoshenko",
    material=STEEL,
    damping=Damping(2.0, 1e-6),
)
PLATE = Spec(
    "plate",
    length=0.376,
    width=0.2,
    thickness=0.003175,
    elements=(12, 8),
    clamped=("x0",),
    theory="kirchhoff",
    material=STEEL,
    damping=Damping(2.0, 1e-6),
)
POINTS = np.linspace(0.0752, 0.376, 5)
DOUBTS = {"E": 0.01, "density": 0.003, "thickness": 0.005, "length": 0.002, "width": 0.002}


@dataclass(frozen=True)
class ExactBeam:
    """A beam of uniform pieces: state (w, psi, M, Q) carried from x = 0 to x = L at one frequency."""

    length: float
    width: float
    thickness: float
    E: float = 210e9
    density: float = 7850.0
    poisson: float = 0.3
    shear: bool = True
    rotary: bool = True
    softness: float = 1.0
    clamped: bool = True
    rotation: float = np.inf
    translation: float = np.inf
    masses: tuple[tuple[float, float], ...] = ()
    soft: tuple[float, float, float] | None = None
    beds: tuple[tuple[float, float, float], ...] = ()
    heavy: tuple[float, float, float] | None = None

    @property
    def area(self) -> float:
        return self.width * self.thickness

    @property
    def inertia(self) -> float:
        return self.width * self.thickness**3 / 12

    def _stations(self, count: int) -> np.ndarray:
        extra = [x for x, _ in self.masses] + list(self.soft[:2] if self.soft else ())
        extra += list(self.heavy[:2] if self.heavy else ())
        extra += [x for bed in self.beds for x in bed[:2]]
        return np.unique(np.concatenate([np.linspace(0, self.length, count + 1), extra]))

    def _density(self, x: np.ndarray) -> np.ndarray:
        low, high, factor = self.heavy or (0.0, 0.0, 1.0)
        return self.density * np.where((x > low) & (x < high), factor, 1.0)

    def _steps(self, omega: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Transfer matrix of each interval at each frequency, the mass at its end included."""
        middle, size = (x[1:] + x[:-1]) / 2, np.diff(x)
        stiff = np.full(len(size), self.E)
        if self.soft is not None:
            low, high, loss = self.soft
            stiff = np.where((middle > low) & (middle < high), (1 - loss) * stiff, stiff)
        dense = self._density(middle)
        kappa = 10 * (1 + self.poisson) / (12 + 11 * self.poisson) / self.softness
        rate = np.zeros((len(omega), len(size), 4, 4))
        rate[..., 0, 1] = 1.0
        rate[..., 0, 3] = 2 * (1 + self.poisson) / (kappa * stiff * self.area) if self.shear else 0.0
        rate[..., 1, 2] = 1 / (stiff * self.inertia)
        rate[..., 2, 1] = -(omega[:, None] ** 2) * dense * self.inertia * self.rotary
        rate[..., 2, 3] = -1.0
        rate[..., 3, 0] = -(omega[:, None] ** 2) * dense * self.area
        for low, high, stiffness in self.beds:
            rate[..., 3, 0] += np.where((middle > low) & (middle < high), stiffness / (high - low), 0.0)
        steps = expm(rate * size[:, None, None])
        for place, mass in self.masses:
            jump = np.broadcast_to(np.eye(4), (len(omega), 4, 4)).copy()
            jump[:, 3, 0] = -mass * omega**2
            end = int(np.argmin(np.abs(x[1:] - place)))
            steps[:, end] = jump @ steps[:, end]
        return np.asarray(steps)

    def _start(self) -> np.ndarray:
        if not self.clamped:
            return np.eye(4)[:, :2]
        return np.array([[0, 1 / self.translation], [1 / self.rotation, 0], [1, 0], [0, 1.0]])

    def _ends(self, omega: np.ndarray) -> np.ndarray:
        """Moment and shear force at x = L for both free parameters at x = 0, (n, 2, 2)."""
        steps = self._steps(omega, self._stations(4))
        state = np.broadcast_to(self._start(), (len(omega), 4, 2))
        for i in range(steps.shape[1]):
            state = steps[:, i] @ state
        return np.asarray(state[:, 2:])

    def frequencies(self, count: int) -> np.ndarray:
        """Natural frequencies [Hz], rigid-body modes left out."""
        unit = np.sqrt(self.E * self.inertia / (self.density * self.area)) / self.length**2
        grid = unit * np.linspace(0.3, (count + 1.5) * np.pi, 60 * (count + 1)) ** 2
        values = np.linalg.det(self._ends(grid))
        found = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))[:count]

        def determinant(omega: float) -> float:
            return float(np.linalg.det(self._ends(np.array([omega])))[0])

        roots = [brentq(determinant, grid[i], grid[i + 1], xtol=1e-9, rtol=1e-13) for i in found]
        return np.array(roots) / (2 * np.pi)

    def shapes(self, frequency: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Mass-normalised displacement at points, (n_points, n_modes) [kg^-1/2]."""
        x = self._stations(1200)
        omega = 2 * np.pi * np.asarray(frequency)
        free = np.linalg.svd(self._ends(omega))[2][:, -1]
        steps = self._steps(omega, x)
        states = [np.einsum("ij,nj->ni", self._start(), free)]
        for i in range(len(x) - 1):
            states.append(np.einsum("nij,nj->ni", steps[:, i], states[-1]))
        w, psi = np.stack(states)[:, :, 0], np.stack(states)[:, :, 1]
        spread = self._density(x)[:, None] * (self.area * w**2 + self.rotary * self.inertia * psi**2)
        total = np.trapezoid(spread, x, axis=0)
        for place, mass in self.masses:
            total = total + mass * w[int(np.argmin(np.abs(x - place)))] ** 2
        return np.stack([np.interp(points, x, w[:, r]) for r in range(len(omega))], axis=1) / np.sqrt(total)


def exactly(predictor: Predictor, truth: Prediction, *, sigma: float = 1e-4, **changes: Any) -> Measured:
    """A test that found a prediction's modes to the last digit, and knows them to one in ten thousand."""
    found = truth.constants
    stated = {
        "frequency": truth.frequency,
        "frequency_sigma": sigma * truth.frequency,
        "damping": truth.damping,
        "damping_sigma": 0.03 * truth.damping,
        "constants": found,
        "constants_sigma": 0.01 * np.abs(found).max(axis=0) * np.ones_like(found),
    }
    return replace(predictor.measured, **{**stated, **changes})


def blank(
    points: np.ndarray, *, top: float = 1600.0, sensor: int = -1, shapes_only: bool = False
) -> Measured:
    """A test that only says where to look: all points hit, one sensor."""
    n = len(points)
    seen = np.arange(n) if shapes_only else np.full(n, sensor % max(n, 1))
    hit = np.full(n, -1) if shapes_only else np.arange(n)
    frequency = np.array([0.5 * top, top])
    constants = np.ones((n, 2))
    return Measured(
        frequency=frequency,
        frequency_sigma=1e-4 * frequency,
        damping=np.full(2, 0.01),
        damping_sigma=np.full(2, 0.001),
        points=np.asarray(points, dtype=float).reshape(n, 2 if np.ndim(points) == 2 else 1),
        nodes=tuple(range(1, n + 1)),
        seen=seen,
        hit=hit,
        constants=constants,
        constants_sigma=0.01 * constants,
        absolute=not shapes_only,
    )


def of_frequencies(frequency: np.ndarray, sigma: float) -> Measured:
    """A table of frequencies [Hz], each known to so much of itself [-], without damping and shapes."""
    unknown, none = np.full(len(frequency), np.nan), np.zeros((0, len(frequency)))
    return replace(
        blank(np.zeros(0), shapes_only=True),
        frequency=frequency,
        frequency_sigma=sigma * frequency,
        damping=unknown,
        damping_sigma=unknown,
        constants=none,
        constants_sigma=none,
    )


def observed(
    frequency: np.ndarray,
    damping: np.ndarray,
    constants: np.ndarray,
    points: np.ndarray,
    rng: np.random.Generator,
    *,
    sensor: int = -1,
) -> Measured:
    """A test with honest noise: 0.01 % and re-mounting on frequencies, 3 % on damping, 1 % on constants."""
    n = len(points)
    level = 0.01 * np.sqrt(np.mean(constants**2, axis=0)) * np.ones_like(constants)
    scatter = np.hypot(1e-4, 5e-4) * rng.standard_normal(len(frequency))
    return Measured(
        frequency=frequency * (1 + scatter),
        frequency_sigma=1e-4 * frequency,
        damping=damping * np.exp(0.03 * rng.standard_normal(len(damping))),
        damping_sigma=0.03 * damping,
        points=np.asarray(points, dtype=float).reshape(n, -1),
        nodes=tuple(range(1, n + 1)),
        seen=np.full(n, sensor % n),
        hit=np.arange(n),
        constants=constants + level * rng.standard_normal(constants.shape),
        constants_sigma=level,
        absolute=True,
    )


def specimen(rng: np.random.Generator, **changes: object) -> ExactBeam:
    """The beam as built: every property off by its tolerance, and what the test adds."""
    off = {name: float(np.exp(sigma * rng.standard_normal())) for name, sigma in DOUBTS.items()}
    made = {
        "length": BEAM.length * off["length"],
        "width": BEAM.width * off["width"],
        "thickness": BEAM.thickness * off["thickness"],
        "E": STEEL.E * off["E"],
        "density": STEEL.density * off["density"],
    }
    for name, value in changes.items():
        made[name] = made[name] * value if name in made else value  # type: ignore[operator, assignment]
    return ExactBeam(**made)  # type: ignore[arg-type]


def struck(
    beam: ExactBeam,
    rng: np.random.Generator,
    *,
    modes: int = 5,
    sensor: int = -1,
    gain: float = 1.0,
    decay: float = 0.0,
) -> Measured:
    """A hammer test of an exact beam: points keep their distance from the free end."""
    frequency = beam.frequencies(modes)
    shape = beam.shapes(frequency, POINTS + beam.length - BEAM.length)
    omega = 2 * np.pi * frequency
    damping = np.exp(0.2 * rng.standard_normal(modes)) * (1.0 / omega + 0.5e-6 * omega)
    poles = -damping * omega + 1j * omega * np.sqrt(1 - damping**2) - decay
    frequency, damping = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    level = gain * float(np.exp(0.02 * rng.standard_normal()))
    return observed(frequency, damping, level * shape * shape[sensor], POINTS, rng, sensor=sensor)


def case_of(measured: Measured, spec: Spec = BEAM, **options: object) -> Case:
    """The test beside the model, with the usual tolerances."""
    return Case("specimen", spec, measured, tolerances=Tolerances(DOUBTS), **options)  # type: ignore[arg-type]
