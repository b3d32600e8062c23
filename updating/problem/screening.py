"""Where a search for a local effect begins: the places of a fine grid at which the effect, at its best size, fits.

The likelihood of a place is narrow: some hundredths of the length where shapes are good. Its maxima at one fixed size
are not those at the best size, and between two places where a size fits well lies one where none does. So all places
of a grid are tried with sizes over the whole prior range. Only frequencies and shapes are compared, in the lowest
modes of the model, for all places and sizes in one batch; this costs less than one search.

The noise is not that of the test, under which every place of a grid is equally impossible. It is what remains at a
place: a Gaussian noise of unknown scale, one of frequencies and one of shapes, each at its maximum likelihood. What
all frequencies have in common is left out as far as tolerances explain it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.ndimage import minimum_filter

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, bending_stiffness
from updating.effects.box import AXES
from updating.effects.structure.frequency_gap import common_metric
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.problem.candidate import Candidate
from updating.test_data.chain import measurement_chain


@dataclass(frozen=True)
class Grid:
    """What is tried.

    Parameters
    ----------
    per_half_wave : int
        Places for each half wave of bending at the highest measured frequency, along a side: the square of a shape,
        which a mass or a spring sees, repeats once in it.
    fewest : int
        Places along a side at the least.
    sizes : int
        Sizes at each place, evenly spread over the quantiles of the prior.
    beyond : int
        Modes beyond those measured in which the changed model is solved: a local change mixes in what bends there.
    minima : int
        So many minima of the misfit are starts.
    closest : float
        No frequency or shape is compared more closely than this, relative: the grid itself is coarser [-].
    """

    per_half_wave: int = 5
    fewest: int = 8
    sizes: int = 10
    beyond: int = 16
    minima: int = 6
    closest: float = 1e-4


def basins(candidate: Candidate, predictor: Predictor, *, grid: Grid = Grid()) -> list[FloatArray]:
    """Return prior quantiles from which to search for a single effect at a free place, the best first.

    Parameters
    ----------
    candidate : Candidate
        One effect whose class states by ``screened`` what is tried at every place.
    predictor : Predictor
        The specimen.
    grid : Grid
        How fine the grid is.

    Returns
    -------
    list of (k,) arrays
        Empty where the effect has no free place, or the model is no beam or plate.
    """
    stage = candidate.stage(predictor)
    if len(candidate.effects) != 1 or not stage.spec.outlined or stage.base.absorbers:
        return []
    effect, form = candidate.effects[0], candidate.forms[0]
    free = [p for p in effect.parameters(stage) if p.name not in form.values]
    placed = any(p.name in AXES for p in free)
    sized = any({p.name, p.like}.isdisjoint({*AXES, *effect.screened}) for p in free)
    if not (effect.screened and placed and sized):
        return []
    key = f"basins of {effect.name} {sorted(form.values.items())} {sorted(form.within.items())}"
    return list(stage.once(key, lambda: _basins(candidate, free, stage, grid)))


def _basins(candidate: Candidate, free: Sequence[Parameter], stage: Predictor, grid: Grid) -> FloatArray:
    """Return the prior quantiles of the lowest minima of the misfit over the places of a grid, (n, k) [-]."""
    sides = [p.name for p in free if p.name in AXES]
    lines = [(np.arange(n) + 0.5) / n for n in _counts(stage, sides, grid)]
    others = _others(candidate.effects[0], [p for p in free if p.name not in AXES], grid)
    row = [p.name for p in free]
    tried = [
        [{**dict(zip(sides, at, strict=True)), **other}[name] for name in row]
        for at in product(*lines)
        for other in others
    ]
    states = (replace(candidate.state(stage, u), theory=None) for u in tried)  # each holds whole matrices
    misfit = _misfits(stage, states, grid).reshape(*map(len, lines), len(others))
    lowest, best = misfit.min(axis=-1), misfit.argmin(axis=-1)
    minima = np.argwhere((lowest == minimum_filter(lowest, size=3, mode="nearest")) & np.isfinite(lowest))
    chosen = sorted((tuple(i) for i in minima.tolist()), key=lambda i: lowest[i])[: grid.minima]
    found = np.array(tried).reshape(*misfit.shape, len(row))
    return np.array([found[(*i, best[i])] for i in chosen]).reshape(-1, len(row))


def _counts(stage: Predictor, sides: Sequence[str], grid: Grid) -> list[int]:
    """Return how many places there are along each side, by the half waves of bending at the highest frequency."""
    spec = stage.spec
    mass = spec.material.density * spec.thickness * (spec.width if spec.kind == "beam" else 1.0)
    wave_number = ((2 * np.pi * stage.measured.top) ** 2 * mass / bending_stiffness(spec)) ** 0.25
    lengths = {"x": spec.length, "y": spec.width}
    return [
        max(int(np.ceil(grid.per_half_wave * wave_number * lengths[side] / np.pi)), grid.fewest)
        for side in sides
    ]


def _others(effect: Effect, free: Sequence[Parameter], grid: Grid) -> list[dict[str, float]]:
    """Return what is tried at every place: quantiles of the other parameters, those that follow another with it."""
    sizes = tuple((np.arange(grid.sizes) + 0.5) / grid.sizes)
    tried = {p.name: effect.screened.get(p.name, sizes) for p in free if p.like not in effect.screened}
    followers = {p.name: p.like for p in free if p.like in effect.screened}
    every = [dict(zip(tried, chosen, strict=True)) for chosen in product(*tried.values())]
    return [{**one, **{name: one[leader] for name, leader in followers.items()}} for one in every]


def _misfits(stage: Predictor, states: Iterable[State], grid: Grid) -> FloatArray:
    """Return minus the log-likelihood of frequencies and shapes, noise of unknown scale, under each state (n,) [-].

    Each measured mode is compared with the mode of the state that is nearest in both.
    """
    test, first = stage.measured, stage.reduced.structure.rigid_modes
    count = len(test.frequency)
    basis = stage.reduced.eigen(stage.base)[1][:, : first + test.below + count + grid.beyond]
    projected = [
        [basis.T @ part @ basis for part in stage.reduced.matrices(stage.base.plus(state))]
        for state in states
    ]
    stiffness, mass = np.array(projected).transpose(1, 0, 2, 3)
    lower = np.linalg.inv(np.linalg.cholesky(mass))
    values, vectors = np.linalg.eigh(lower @ stiffness @ lower.transpose(0, 2, 1))
    frequency = np.sqrt(np.maximum(values[:, first + test.below :], 1e-12)) / (2 * np.pi)
    off = np.log(test.frequency[:, None] / frequency[:, None, :])  # (states, measured, modes)
    unlike = np.zeros_like(off)
    if test.has_shapes:
        modes = (basis @ lower.transpose(0, 2, 1) @ vectors)[:, :, first + test.below :]
        unlike = 1 - _macs(stage, modes)
    nearest = np.argmin(off**2 + unlike, axis=2)[..., None]
    off, unlike = (np.take_along_axis(one, nearest, axis=2)[..., 0] for one in (off, unlike))
    metric = common_metric(count)
    squares = np.einsum("br,rs,bs->b", off, metric, off)
    misfit = count * np.log(squares / count + grid.closest**2)
    if test.has_shapes:
        misfit = misfit + count * np.log(unlike.mean(axis=1) + grid.closest)
    return np.asarray(misfit)


def _macs(stage: Predictor, modes: FloatArray) -> FloatArray:
    """Return the MAC of the measured constants with those of modes (n_states, r, m), (n_states, n_modes, m) [-]."""
    test = stage.measured
    shapes = stage.point_rows()[:, : modes.shape[1]] @ modes
    moved = shapes.transpose(1, 0, 2)
    predicted = measurement_chain(test, stage.base).product(moved, moved)
    across = np.einsum("fr,fbm->brm", test.constants, predicted) ** 2
    size = np.sum(predicted**2, axis=0)[:, None] * np.sum(test.constants**2, axis=0)[:, None]
    return np.asarray(across / np.maximum(size, 1e-300))
