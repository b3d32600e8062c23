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

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.ndimage import minimum_filter

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, bending_stiffness
from updating.effects.box import AXES
from updating.effects.structure.frequency_gap import common_metric
from updating.models.state import State, combine
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
    computed : int
        How many of these are computed; the others lie between.
    beyond : int
        Modes beyond those measured in which the changed model is solved: a local change mixes in what bends there.
    minima : int
        So many minima of the misfit are starts.
    rounds : int
        How often at most each of several effects is placed beside the others.
    closest : float
        No frequency or shape is compared more closely than this, relative: the grid itself is coarser [-].
    """

    per_half_wave: int = 5
    fewest: int = 8
    sizes: int = 10
    computed: int = 4
    beyond: int = 16
    minima: int = 6
    rounds: int = 3
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
    screen = _screen(candidate, stage, grid)
    if screen is None:
        return []
    misfit = screen.misfits(stage, State())
    return [] if misfit is None else list(screen.minima(misfit)[: grid.minima])


def beside(
    parts: Sequence[tuple[Candidate, FloatArray]], predictor: Predictor, *, grid: Grid = Grid()
) -> FloatArray | None:
    """Return prior quantiles from which to search for several sets of effects together, or None.

    An effect alone takes the place at which it does most of what several do. So each part that has a free place is put
    where it fits best beside the others, one after the other, from the last; and again as long as the misfit falls.

    Parameters
    ----------
    parts : sequence of (Candidate, (k,) array)
        The sets, and prior quantiles of each to begin with [-].
    predictor : Predictor
        The specimen.
    grid : Grid
        How fine the grid is.

    Returns
    -------
    (k_1 + k_2 + ...,) array
        None where no part has a free place, or one brings unknowns of its own, as a clamp that gives way does.
    """
    effects = tuple(effect for one, _ in parts for effect in one.effects)
    stage = Candidate(effects, fuller=any(one.fuller for one, _ in parts)).stage(predictor)
    screens = [_screen(one, stage.clamped, grid) for one, _ in parts]
    if all(screen is None for screen in screens):
        return None
    places, lowest = [place for _, place in parts], np.inf
    for _ in range(grid.rounds if sum(screen is not None for screen in screens) > 1 else 1):
        before = lowest
        for i, screen in reversed(list(enumerate(screens))):
            if screen is None:
                continue
            others = [one.state(stage, places[k].tolist()) for k, (one, _) in enumerate(parts) if k != i]
            misfit = screen.misfits(stage.clamped, replace(combine(others), theory=None))
            if misfit is None:
                return None
            places[i], lowest = screen.tried[misfit.argmin()], float(misfit.min())
        if not lowest < before:
            break
    return np.concatenate(places)


@dataclass(frozen=True, eq=False)
class _Screen:
    """All that is tried of one effect.

    Parameters
    ----------
    grid : Grid
        How fine the grid is.
    tried : (n, k) array
        Prior quantiles [-].
    shape : tuple of int
        Places along each side, and what is tried at each.
    basis : (r, m) array
        Lowest modes of the model without the effect [kg^-1/2].
    changes : (n, 2, m, m) array
        What each changes of stiffness and mass, on these modes [rad^2/s^2, -].
    """

    grid: Grid
    tried: FloatArray
    shape: tuple[int, ...]
    basis: FloatArray
    changes: FloatArray

    def misfits(self, stage: Predictor, others: State) -> FloatArray | None:
        """Return the misfits of all beside other changes (n,) [-]; None where these bring unknowns of their own."""
        total = stage.base.plus(others)
        if total.released not in stage.reduced.ranks:
            return None
        matrices = stage.reduced.matrices(total)
        if len(matrices[0]) != len(self.basis):
            return None
        both = np.array([self.basis.T @ part @ self.basis for part in matrices])
        stiffness, mass = (self.changes + both).transpose(1, 0, 2, 3)
        return _misfits(stage, others, self.basis, stiffness, mass, closest=self.grid.closest)

    def minima(self, misfit: FloatArray) -> FloatArray:
        """Return the prior quantiles at the minima over the places, of each place the best, the lowest first (n, k)."""
        table = misfit.reshape(self.shape)
        lowest, best = table.min(axis=-1), table.argmin(axis=-1)
        minima = np.argwhere((lowest == minimum_filter(lowest, size=3, mode="nearest")) & np.isfinite(lowest))
        order = sorted((tuple(i) for i in minima.tolist()), key=lambda i: lowest[i])
        found = self.tried.reshape(*self.shape, -1)
        return np.array([found[(*i, best[i])] for i in order]).reshape(-1, self.tried.shape[1])


def _screen(candidate: Candidate, stage: Predictor, grid: Grid) -> _Screen | None:
    """Return what is tried of a single effect at a free place; None of anything else."""
    if len(candidate.effects) != 1 or not stage.spec.outlined or stage.base.absorbers:
        return None
    effect, form = candidate.effects[0], candidate.forms[0]
    free = [p for p in effect.parameters(stage) if p.name not in form.values]
    placed = any(p.name in AXES for p in free)
    sized = any({p.name, p.like}.isdisjoint({*AXES, *effect.screened}) for p in free)
    if not (effect.screened and placed and sized):
        return None
    key = f"screen of {effect.name} {sorted(form.values.items())} {sorted(form.within.items())} {grid}"
    return stage.once(key, lambda: _made(candidate, free, stage, grid))


def _made(candidate: Candidate, free: Sequence[Parameter], stage: Predictor, grid: Grid) -> _Screen:
    """Return the grid of places and sizes, each with what it changes of the lowest modes.

    At each place some sizes are computed. Those between are taken along the straight line of the size's own value, in
    which what a body, a spring or a soft place changes is nearly straight.
    """
    sides, row = [p.name for p in free if p.name in AXES], [p.name for p in free]
    lines = [(np.arange(n) + 0.5) / n for n in _counts(stage, sides, grid)]
    size, others = _others(candidate.effects[0], [p for p in free if p.name not in AXES], grid)
    sizes = (np.arange(grid.sizes) + 0.5) / grid.sizes
    some = np.unique(np.linspace(0, grid.sizes - 1, grid.computed).round().astype(int))
    test = stage.measured
    count = stage.reduced.structure.rigid_modes + test.below + len(test.frequency) + grid.beyond
    basis = stage.reduced.eigen(stage.base)[1][:, :count]
    nominal = stage.reduced.matrices(stage.base)

    def change(u: Sequence[float]) -> list[FloatArray]:
        state = replace(candidate.state(stage, u), theory=None)
        changed = stage.reduced.matrices(stage.base.plus(state))
        return [basis.T @ (new - old) @ basis for new, old in zip(changed, nominal, strict=True)]

    tried, changes = [], []
    for at, other in product(product(*lines), others):
        place = {**dict(zip(sides, at, strict=True)), **other}
        own = [[{**place, size: u}[name] for name in row] for u in sizes.tolist()]
        values = np.array([candidate.values(stage, u)[f"{candidate.effects[0].key}.{size}"] for u in own])
        known = np.array([change(own[i]) for i in some])
        tried += own
        changes.append(np.tensordot(_between(values[some], values), known, axes=1).astype(np.float32))
    shape = (*map(len, lines), len(others) * grid.sizes)
    return _Screen(grid, np.array(tried), shape, basis, np.concatenate(changes))  # a plate has thousands


def _between(known: FloatArray, values: FloatArray) -> FloatArray:
    """Return the weights of known values at others along straight lines between them, (n_values, n_known) [-]."""
    order = np.argsort(known)
    return np.stack([np.interp(values, known[order], one[order]) for one in np.eye(len(known))], axis=1)


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


def _others(effect: Effect, free: Sequence[Parameter], grid: Grid) -> tuple[str, list[dict[str, float]]]:
    """Return the size, and what is tried at every place: quantiles of the other parameters.

    Those that follow another have its quantile.
    """
    sizes = tuple((np.arange(grid.sizes) + 0.5) / grid.sizes)
    tried = {p.name: effect.screened.get(p.name, sizes) for p in free if p.like not in effect.screened}
    size = [name for name in tried if name not in effect.screened][-1]
    del tried[size]
    followers = {p.name: p.like for p in free if p.like in effect.screened}
    every = [dict(zip(tried, chosen, strict=True)) for chosen in product(*tried.values())]
    return size, [{**one, **{name: one[leader] for name, leader in followers.items()}} for one in every]


def _misfits(
    stage: Predictor,
    others: State,
    basis: FloatArray,
    stiffness: FloatArray,
    mass: FloatArray,
    *,
    closest: float,
) -> FloatArray:
    """Return minus the log-likelihood of frequencies and shapes, noise of unknown scale, of all matrices (n,) [-].

    Each measured mode is compared with the mode that is nearest in both.
    """
    test, elastic = stage.measured, stage.reduced.structure.rigid_modes + stage.measured.below
    count = len(test.frequency)
    heavy = np.ones(len(mass), np.bool_)
    try:
        lower = np.linalg.inv(np.linalg.cholesky(mass))
    except np.linalg.LinAlgError:
        heavy = np.linalg.eigvalsh(mass)[:, 0] > 0
        lower = np.linalg.inv(np.linalg.cholesky(np.where(heavy[:, None, None], mass, np.eye(len(basis.T)))))
    values, vectors = np.linalg.eigh(lower @ stiffness @ lower.transpose(0, 2, 1))
    frequency = np.sqrt(np.maximum(values[:, elastic:], 1e-12)) / (2 * np.pi)
    off = np.log(test.frequency[:, None] / frequency[:, None, :])  # (states, measured, modes)
    unlike = np.zeros_like(off)
    if test.has_shapes:
        unlike = 1 - _macs(stage, others, basis, (lower.transpose(0, 2, 1) @ vectors)[:, :, elastic:])
    nearest = np.argmin(off**2 + unlike, axis=2)[..., None]
    off, unlike = (np.take_along_axis(one, nearest, axis=2)[..., 0] for one in (off, unlike))
    metric = common_metric(count)
    squares = np.einsum("br,rs,bs->b", off, metric, off)
    misfit = count * np.log(squares / count + closest**2)
    if test.has_shapes:
        misfit = misfit + count * np.log(unlike.mean(axis=1) + closest)
    return np.where(heavy, misfit, np.inf)


def _macs(stage: Predictor, others: State, basis: FloatArray, modes: FloatArray) -> FloatArray:
    """Return the MAC of the measured constants with those of modes (n_states, k, m) on a basis (r, k).

    Returns
    -------
    (n_states, n_modes, m) array [-]
    """
    test, read = stage.measured, measurement_chain(stage.measured, stage.base.plus(others))
    shapes = (stage.point_rows(others, read.points)[:, : len(basis)] @ basis) @ modes
    moved = shapes.transpose(1, 0, 2)
    predicted = read.product(moved, moved)
    across = np.einsum("fr,fbm->brm", test.constants, predicted) ** 2
    size = np.sum(predicted**2, axis=0)[:, None] * np.sum(test.constants**2, axis=0)[:, None]
    return np.asarray(across / np.maximum(size, 1e-300))
