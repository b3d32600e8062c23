"""Several specimens with shared parameters as one weighted least-squares problem, paper A Eqs. 18-25."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.errors import StudyError
from updating.update.knobs import Knob
from updating.update.specimen import Look, Specimen

Weights = Literal["covariance", "relative", "eigenvalue"] | Sequence[float]
Quantity = Literal["frequency", "eigenvalue"]


@dataclass(frozen=True, eq=False)
class Linear:
    """The problem at one setting: residuals, weights and sensitivities, Eq. 19.

    Parameters
    ----------
    residual : (n,) array
        Measured minus computed: 1 - f / f_e, or eigenvalues [- or rad^2/s^2].
    sensitivity : (n, p) array
        Derivatives of the computed quantity by the coordinates.
    weight : (n,) array
        Diagonal of W_s.
    looks : tuple of Look
        The specimens.
    """

    residual: FloatArray
    sensitivity: FloatArray
    weight: FloatArray
    looks: tuple[Look, ...]


@dataclass(frozen=True, eq=False)
class System:
    """What is to be solved.

    Parameters
    ----------
    specimens : tuple of Specimen
        The specimens.
    index : tuple of int arrays
        For every specimen, which unknown each of its knobs is.
    knobs : tuple of Knob
        One knob for each unknown; a shared one stands for all specimens that have it.
    owner : tuple of int
        Specimen of each unknown, -1 where it is shared.
    weights : tuple of arrays
        W_s of each specimen, for relative frequencies.
    quantity : {"frequency", "eigenvalue"}
        What is compared.
    regularised : bool
        Whether the tolerances hold the parameters near their start, Eq. 25.
    """

    specimens: tuple[Specimen, ...]
    index: tuple[IntArray, ...]
    knobs: tuple[Knob, ...]
    owner: tuple[int, ...]
    weights: tuple[FloatArray, ...]
    quantity: Quantity
    regularised: bool

    @cached_property
    def low(self) -> FloatArray:
        """Lower bounds of the coordinates."""
        return np.array([k.coordinate(k.low) for k in self.knobs])

    @cached_property
    def high(self) -> FloatArray:
        """Upper bounds of the coordinates."""
        return np.array([k.coordinate(k.high) for k in self.knobs])

    @cached_property
    def start(self) -> FloatArray:
        """Coordinates of the nominal model, theta_0 of Eq. 25."""
        return np.array([k.coordinate(k.start) for k in self.knobs])

    @cached_property
    def doubt(self) -> FloatArray:
        """1-sigma scales of the coordinates."""
        return np.array([k.doubt for k in self.knobs])

    @cached_property
    def prior(self) -> FloatArray:
        """Diagonal of W_theta: inverse variances of the parameters, 0 where none is told."""
        tolerated = np.array([k.tolerated for k in self.knobs]) & self.regularised
        return np.where(tolerated, 1 / self.doubt**2, 0.0)

    @property
    def count(self) -> int:
        """Number of data that weigh anything."""
        return int(sum(np.sum(w > 0) for w in self.weights))

    def values(self, theta: FloatArray, specimen: int) -> list[float]:
        """Return the factors and values of one specimen's knobs."""
        return [self.knobs[i].value(theta[i]) for i in self.index[specimen]]

    def looks(self, theta: FloatArray) -> tuple[Look, ...]:
        """Evaluate every specimen."""
        return tuple(s.look(self.values(theta, i)) for i, s in enumerate(self.specimens))

    def residual(self, looks: tuple[Look, ...]) -> FloatArray:
        """Return measured minus computed, shape (n,)."""
        parts = []
        for specimen, look in zip(self.specimens, looks, strict=True):
            test = specimen.measured.frequency
            if self.quantity == "frequency":
                parts.append(1 - look.frequency / test)
            else:
                parts.append((2 * np.pi) ** 2 * (test**2 - look.frequency**2))
        return np.concatenate(parts)

    @cached_property
    def weight(self) -> FloatArray:
        """Diagonal of W_s for the residuals, shape (n,)."""
        if self.quantity == "frequency":
            return np.concatenate(self.weights)
        both = zip(self.weights, self.specimens, strict=True)
        per = [w / (2 * (2 * np.pi * s.measured.frequency) ** 2) ** 2 for w, s in both]
        return np.concatenate(per)

    def cost(self, theta: FloatArray, looks: tuple[Look, ...]) -> float:
        """Return what Eq. 25 makes least."""
        residual = self.residual(looks)
        return float(self.weight @ residual**2 + self.prior @ (theta - self.start) ** 2)

    def linear(self, theta: FloatArray, looks: tuple[Look, ...]) -> Linear:
        """Return residuals and sensitivities, Eqs. 18 and 19."""
        blocks = []
        for i, (specimen, look) in enumerate(zip(self.specimens, looks, strict=True)):
            slopes = specimen.slopes(self.values(theta, i), look)
            block = np.zeros((len(slopes), len(self.knobs)))
            block[:, self.index[i]] = slopes * self._per_log(specimen, look)[:, None]
            blocks.append(block)
        return Linear(self.residual(looks), np.vstack(blocks), self.weight, looks)

    def _per_log(self, specimen: Specimen, look: Look) -> FloatArray:
        if self.quantity == "frequency":
            return look.frequency / specimen.measured.frequency
        return 2 * (2 * np.pi * look.frequency) ** 2

    def whitened(self, linear: Linear) -> FloatArray:
        """Return the sensitivities of ln f over what the measurement is good for, used modes only, (n, p) [-]."""
        rows = []
        end = 0
        for specimen, look in zip(self.specimens, linear.looks, strict=True):
            begin, end = end, end + len(look.frequency)
            per_log = self._per_log(specimen, look)[:, None]
            rows.append(
                linear.sensitivity[begin:end] / per_log / np.sqrt(specimen.relative_variance)[:, None]
            )
        return np.vstack(rows)[self.used]

    @cached_property
    def used(self) -> BoolArray:
        """Which data weigh anything, shape (n,)."""
        return self.weight > 0

    def corrected(self, factors: Sequence[FloatArray]) -> System:
        """Return the problem with the reduced models' frequencies corrected by factors."""
        specimens = tuple(replace(s, correction=f) for s, f in zip(self.specimens, factors, strict=True))
        return replace(self, specimens=specimens)


def build_system(
    specimens: Sequence[Specimen],
    shared: Sequence[str],
    weights: Weights,
    quantity: Quantity,
    all_modes: Sequence[int],
    *,
    regularised: bool,
) -> System:
    """Number the unknowns and lay out the weights.

    Raises
    ------
    StudyError
        If a shared name is no parameter, weights do not fit the modes, or there are more free parameters than
        data.
    """
    known = {knob.name for s in specimens for knob in s.panel.knobs}
    if missing := sorted(set(shared) - known):
        raise StudyError(
            f"update: shared parameter {missing[0]!r} is updated in no study; add it to the parameters"
        )
    unknowns: dict[tuple[str, int], Knob] = {}
    index = []
    for i, specimen in enumerate(specimens):
        keys = [(k.name, -1 if k.name in shared else i) for k in specimen.panel.knobs]
        for key, knob in zip(keys, specimen.panel.knobs, strict=True):
            unknowns.setdefault(key, knob)
        index.append([list(unknowns).index(key) for key in keys])
    system = System(
        tuple(specimens),
        tuple(np.array(i) for i in index),
        tuple(unknowns.values()),
        tuple(owner for _, owner in unknowns),
        _weights(specimens, weights, all_modes),
        quantity,
        regularised,
    )
    free = int(np.sum(system.prior == 0))
    if free > system.count:
        raise StudyError(
            f"update: {free} parameters without a tolerance to hold them and {system.count} frequencies; name fewer "
            'parameters, or use weights = "covariance" with [tolerances]'
        )
    return system


def _weights(
    specimens: Sequence[Specimen], weights: Weights, all_modes: Sequence[int]
) -> tuple[FloatArray, ...]:
    """Return W_s for relative frequencies of each specimen."""
    if isinstance(weights, str):
        if weights == "covariance":
            return tuple(1 / s.relative_variance for s in specimens)
        if weights == "relative":
            return tuple(np.ones(len(s.number)) for s in specimens)
        if weights != "eigenvalue":
            raise StudyError(
                f"update: unknown weights {weights!r}; use covariance, relative, eigenvalue or a list of numbers"
            )
        top = max(s.measured.frequency.max() for s in specimens)
        return tuple((s.measured.frequency / top) ** 4 for s in specimens)
    given = np.asarray(weights, dtype=float)
    if len(given) != sum(all_modes) or not np.all(given >= 0) or not np.any(given > 0):
        raise StudyError(
            f"update: {len(given)} weights for {sum(all_modes)} measured modes; give one for each, none negative, "
            "in the order of the tests and their frequencies"
        )
    parts = np.split(given, np.cumsum(all_modes)[:-1])
    return tuple(part[s.number - 1] for part, s in zip(parts, specimens, strict=True))
