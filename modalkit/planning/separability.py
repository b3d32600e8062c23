"""How far effects lie apart in a test: distances from one effect to all that another can do, doubts projected out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from modalkit.planning.bench import Bench
from modalkit.planning.curves import Curve
from modalkit.planning.design import Design
from modalkit.planning.surface import Surface

NONE = "none"
SEEN = 3.0
"""Standard deviations from which on an effect is detected, or separated from another."""

SURE = 5.0
"""Standard deviations from which on an effect is expected to be named alone."""

CLASS = 2.0
"""Effects less apart than this are one class to a test."""

EQUAL = frozenset(
    {
        ("sensor_mass", "lumped_mass"),
        ("exponential_window", "uniform_damping"),
        ("calibration_gain", "section_scale"),
        ("section_scale", "calibration_gain"),
    }
)
"""(effect, rival): the rival can do exactly what the effect does, whatever is hit."""

_TARGET_PLACES = 9


@dataclass(frozen=True, eq=False)
class Distances:
    """One effect against all others in one test.

    Parameters
    ----------
    curve : Curve
        The effect.
    places : (n_places,) array
        Places that were examined [m].
    rivals : tuple of str
        ``none`` first, then the other families.
    causes : tuple of str
        Their effects, by which exact equals are known.
    sigma : (n_rivals, n_places, n_severities) array
        Mahalanobis distance to the nearest that the rival can do [-].
    """

    curve: Curve
    places: FloatArray
    rivals: tuple[str, ...]
    causes: tuple[str, ...]
    sigma: FloatArray

    @property
    def nearest(self) -> FloatArray:
        """Distance to the nearest rival that is not its exact equal, ``none`` among them."""
        return np.asarray(self.sigma[self.unequal].min(axis=0))

    @property
    def unequal(self) -> list[int]:
        """Which rivals are no exact equals of it."""
        cause = self.curve.family.cause
        return [i for i, other in enumerate(self.causes) if (cause, other) not in EQUAL]

    def clear(self, sigma: FloatArray) -> FloatArray:
        """Return distances at the clear severities: the worse sign, the middle of the places.

        Parameters
        ----------
        sigma : (..., n_places, n_severities) array
            Distances.
        """
        family = self.curve.family
        at = np.stack([at_severity(family.grid, sigma, q) for q in family.asked], axis=-1).min(axis=-1)
        return np.asarray(np.median(at, axis=-1))

    def clear_of(self, rival: str) -> float:
        """Return the distance to one rival at the clear severities."""
        return float(self.clear(self.sigma[self.rivals.index(rival)]))

    def threshold(self, sigma: FloatArray, level: float = SEEN) -> float:
        """Return the severity from which on distances stay above a level: the worse sign, the middle of the places.

        Parameters
        ----------
        sigma : (n_places, n_severities) array
            Distances.
        level : float
            Standard deviations [-].

        Returns
        -------
        float
            Size of the severity [SI]; infinite where there is none.
        """
        grid = self.curve.family.grid
        if not self.curve.family.graded:
            return float(grid[-1]) if sigma[:, -1].min() >= level else np.inf
        up = grid > 0
        each = [[crossing(grid[up], row[up], level) for row in sigma]]
        if (down := grid < 0).any():
            each.append([crossing(-grid[down][::-1], row[down][::-1], level) for row in sigma])
        worst = np.sort(np.max(each, axis=0))
        return float(worst[len(worst) // 2])


def at_severity(grid: FloatArray, sigma: FloatArray, q: float) -> FloatArray:
    """Return distances at a severity between those of a grid, (...,) [-].

    Parameters
    ----------
    grid : (n,) array
        Severities [SI].
    sigma : (..., n) array
        Distances [-].
    q : float
        The severity [SI].
    """
    above = int(np.clip(np.searchsorted(grid, q), 1, len(grid) - 1))
    part = (q - grid[above - 1]) / (grid[above] - grid[above - 1])
    return np.asarray((1 - part) * sigma[..., above - 1] + part * sigma[..., above])


def crossing(q: FloatArray, sigma: FloatArray, level: float) -> float:
    """Return the severity from which on distances stay above a level, interpolated; infinite where there is none.

    Parameters
    ----------
    q : (n,) array
        Sizes of the severity, ascending [SI].
    sigma : (n,) array
        Distances [-].
    level : float
        Standard deviations [-].
    """
    below = np.flatnonzero(sigma < level)
    if not len(below):  # small changes are in proportion
        return float(q[0] * level / sigma[0])
    last = int(below[-1])
    if last == len(q) - 1:
        return np.inf
    ends = np.log(np.maximum(sigma[last : last + 2], 1e-9))
    part = (np.log(level) - ends[0]) / (ends[1] - ends[0])
    return float(np.exp(np.interp(part, [0, 1], np.log(q[last : last + 2]))))


def distances(
    curves: Sequence[Curve], design: Design, bench: Bench, *, fine: bool = True
) -> tuple[Distances, ...]:
    """Return how far every effect is from every other in a test.

    Parameters
    ----------
    curves : sequence of Curve
        The effects.
    design : Design
        The test.
    bench : Bench
        What the data are, and how well they are known.
    fine : bool
        Whether surfaces are interpolated between the severities and places that were solved.
    """
    have, white = bench.columns(design), bench.whitener(design)
    chosen = [_chosen(len(curve.data)) for curve in curves]
    targets = [curve.data[i][..., have] for curve, i in zip(curves, chosen, strict=True)]
    flat = np.concatenate([one.reshape(-1, one.shape[-1]) for one in targets])
    nothing = np.linalg.norm(flat @ white.T, axis=1)
    reached = [
        np.minimum(_surface(curve, have, fine=fine).distance(flat, white), nothing) for curve in curves
    ]
    ends = np.cumsum([0, *(np.prod(one.shape[:2]) for one in targets)])
    return tuple(
        _against(curves, i, chosen[i], [row[ends[i] : ends[i + 1]] for row in (nothing, *reached)])
        for i in range(len(curves))
    )


def _chosen(places: int) -> IntArray:
    """Return the places at which an effect is asked about, of so many."""
    return np.unique(np.linspace(0, places - 1, _TARGET_PLACES).astype(int))


def _against(curves: Sequence[Curve], own: int, chosen: IntArray, rows: Sequence[FloatArray]) -> Distances:
    """Return one effect against none (the first row) and all others (one row for each curve)."""
    curve, others = curves[own], [j for j in range(len(curves)) if j != own]
    families = [curves[j].family for j in others]
    sigma = np.array([rows[0], *(rows[1 + j] for j in others)])
    return Distances(
        curve,
        curve.family.sites[chosen],
        (NONE, *(family.name for family in families)),
        (NONE, *(family.cause for family in families)),
        sigma.reshape(len(sigma), len(chosen), -1),
    )


def _surface(curve: Curve, have: IntArray, *, fine: bool) -> Surface:
    coarse = curve.data if curve.dense is None else curve.dense.data
    cloud = (curve.cloud if fine else coarse)[..., have]
    slack = None if curve.slack is None else curve.slack[have]
    return Surface(cloud, curve.fidelity, slack, joined=not curve.family.separately)
