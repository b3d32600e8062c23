"""The evidence of a cause in no library, beside no cause or beside a set of them, and what it would be.

The field has a Gaussian prior, so that it is integrated out as the nuisances are. Its amplitudes and its length are
summed over a grid. Stiffness and mass are linearised about their most probable values, in a few rounds; the one whose
most probable field lies nearest to where it was linearised stands. A linearisation from afar may promise a fit that the
model does not have. The parameters of the set stay free: their sensitivities are nuisances with and without the field,
and what that leaves out of their own evidence is alike in both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.generic.columns import PROPERTIES, Columns, columns, compared, correlations
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.slope import sensitivities
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import Marginal, marginal
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True)
class Grid:
    """What is summed over, and how a field is linearised.

    Parameters
    ----------
    amplitudes : tuple of float
        Standard deviations of the logarithms of stiffness and mass in a region [-].
    lengths : tuple of float
        Lengths over which they go together: a place by itself, and a gradient [share of the span].
    losses, gains : tuple of float
        Standard deviations of ln zeta mode by mode, and of ln gain channel by channel [-].
    rounds : int
        Most linearisations about the most probable field.
    steps : tuple of float
        Shares of the way to the most probable field that are tried [-].
    at_rest : float
        The field is at rest when no logarithm of a factor moves by more [-].
    farthest : float
        Farthest from the model that a field is linearised at [-]: a factor of 4.5.
    """

    amplitudes: tuple[float, ...] = (0.02, 0.1, 0.5)
    lengths: tuple[float, ...] = (0.05, 0.3)
    losses: tuple[float, ...] = (0.0, 0.3, 1.0)
    gains: tuple[float, ...] = (0.0, 0.03, 0.3)
    rounds: int = 6
    steps: tuple[float, ...] = (1.0, 0.5, 0.25, 0.1)
    at_rest: float = 0.02
    farthest: float = 1.5


@dataclass(frozen=True)
class Kind:
    """One choice of what a field changes, and by how much.

    Parameters
    ----------
    properties : tuple of str
        Which of ``PROPERTIES``.
    amplitude, loss, gain : float
        Standard deviations [-].
    length : int
        Which length of the grid.
    """

    properties: tuple[str, ...] = ()
    amplitude: float = 0.0
    length: int = 0
    loss: float = 0.0
    gain: float = 0.0


@dataclass(frozen=True, eq=False)
class Field:
    """A cause in no library beside a set of causes.

    Parameters
    ----------
    log_factor : float
        Logarithm of the Bayes factor: with the field over without [-].
    kind : Kind
        The most probable choice.
    changes : (2, r) array
        Most probable logarithm of the factor of each of ``PROPERTIES`` in each region, and in what is in none, the
        last [-].
    spread : (2 r, 2 r) array
        Their covariance [-].
    shares : mapping of Kind to float
        Probability of each choice, given that there is a field [-].
    """

    log_factor: float
    kind: Kind
    changes: FloatArray
    spread: FloatArray
    shares: Mapping[Kind, float] = field(default_factory=dict)

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations of the changes, (2, r) [-]."""
        return np.asarray(np.sqrt(np.diag(self.spread)).reshape(self.changes.shape))

    def smooth(self, name: str) -> float:
        """Return the probability that a property changes smoothly, given that it does: not over the shortest length."""
        free = {kind: share for kind, share in self.shares.items() if name in kind.properties}
        return sum(share for kind, share in free.items() if kind.length) / max(sum(free.values()), 1e-300)

    def changes_of(self, attribute: str) -> float:
        """Return the probability of the choices that leave a property, or ``loss`` or ``gain``, free [-]."""
        free = (attribute in kind.properties or getattr(kind, attribute, 0.0) > 0 for kind in self.shares)
        return float(sum(share for share, one in zip(self.shares.values(), free, strict=True) if one))


def beside(problem: SpecimenProblem, explanation: Explanation, *, grid: Grid = Grid()) -> Field:
    """Compare a cause outside the library beside a set of causes; beside none it is the cause.

    Parameters
    ----------
    problem : SpecimenProblem
        Test and model.
    explanation : Explanation
        The set, or no effect.
    grid : Grid
        What is summed over.
    """
    factors = correlations(problem.predictor.spec, grid.lengths)
    free = sensitivities(problem, explanation.candidate, explanation.best)
    there = np.zeros((len(PROPERTIES), len(factors[0])))
    plain, nearest, best = -np.inf, np.inf, Field(-np.inf, Kind(), there, np.zeros((there.size, there.size)))
    for once in range(grid.rounds):
        here = columns(problem, explanation, there)
        found = {kind: _marginal(here, kind, factors, free) for kind in _kinds(here, grid, len(factors))}
        without = found.pop(Kind()).log_likelihood
        plain = plain if once else without
        total = float(np.logaddexp.reduce([one.log_likelihood for one in found.values()])) - np.log(
            len(found)
        )
        if not (np.isfinite(plain) and np.isfinite(total)):
            break
        top = max(found, key=lambda kind: found[kind].log_likelihood)
        moved, spread = _most_probable(here, top, factors, free)
        moved = np.clip(moved, -grid.farthest, grid.farthest)
        off = float(np.abs(moved - there).max())
        if off < nearest:
            shares = {kind: one.log_likelihood - total - np.log(len(found)) for kind, one in found.items()}
            shares = {kind: float(np.exp(share)) for kind, share in shares.items()}
            nearest, best = off, Field(total - plain, top, moved, spread, shares)
        height = partial(_height, problem, explanation, here, top, factors, free)
        following = max((there + step * (moved - there) for step in grid.steps), key=height)
        if off < grid.at_rest or np.abs(following - there).max() < grid.at_rest:
            break
        there = following
    return best


def _kinds(here: Columns, grid: Grid, lengths: int) -> list[Kind]:
    """Return all choices that the data may support, no field at all among them."""
    structure = [Kind()]
    for properties in (("E",), ("density",), PROPERTIES):
        structure += [Kind(properties, *one) for one in product(grid.amplitudes, range(lengths))]
    losses = grid.losses if here.loss.shape[1] else grid.losses[:1]
    gains = grid.gains if here.gain.shape[1] else grid.gains[:1]
    return [replace(one, loss=loss, gain=gain) for one in structure for loss in losses for gain in gains]


def _with(here: Columns, kind: Kind, factors: list[FloatArray], free: FloatArray) -> Comparison:
    """Return the data with what a field of one kind changes per standard deviation, stiffness and mass first."""
    parts = [kind.amplitude * here.regions[name] @ factors[kind.length] for name in kind.properties]
    parts += [kind.loss * here.loss] * bool(kind.loss) + [kind.gain * here.gain] * bool(kind.gain)
    return here.comparison.beside(np.hstack([np.zeros((len(free), 0)), *parts]), free)


def _marginal(here: Columns, kind: Kind, factors: list[FloatArray], free: FloatArray) -> Marginal:
    """Integrate a field of one kind out, and the parameters (n, k) of the set beside it."""
    return marginal(_with(here, kind, factors, free))


def _height(
    problem: SpecimenProblem,
    explanation: Explanation,
    here: Columns,
    kind: Kind,
    factors: list[FloatArray],
    free: FloatArray,
    field: FloatArray,
) -> float:
    """Return the logarithm of likelihood times prior of a field (2, r) that is not linearised [-].

    What is no longer of its kind counts as if it were.
    """
    there = replace(here, comparison=compared(problem, explanation, field), regions={})
    standard = np.linalg.solve(kind.amplitude * factors[kind.length], field.T) if kind.amplitude else field
    prior = -0.5 * float(np.sum(standard**2))
    return _marginal(there, replace(kind, properties=()), factors, free).log_likelihood + prior


def _most_probable(
    here: Columns, kind: Kind, factors: list[FloatArray], free: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the most probable logarithms of the factors (2, r), and their covariance (2 r, 2 r) [-]."""
    found = _marginal(here, kind, factors, free)
    settled = found.settle(_with(here, kind, factors, free))
    whole, noise = settled.nuisance, settled.noise(found.scale)
    precision = np.eye(whole.shape[1]) + (whole.T / noise) @ whole
    standard, lower = np.linalg.inv(precision), kind.amplitude * factors[kind.length]
    count = len(lower) * len(kind.properties)
    mapping = np.zeros((len(PROPERTIES) * len(lower), count))
    for k, name in enumerate(kind.properties):
        rows = PROPERTIES.index(name) * len(lower)
        mapping[rows : rows + len(lower), k * len(lower) : (k + 1) * len(lower)] = lower
    changes = (mapping @ found.shift[:count]).reshape(len(PROPERTIES), -1)
    return changes, np.asarray(mapping @ standard[:count, :count] @ mapping.T)
