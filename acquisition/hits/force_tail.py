"""The ringing of a force behind the place where a force window cut it off."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.optimize import least_squares

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.hits.checks import pulse_ends
from acquisition.hits.hammer import HammerTest
from acquisition.warned import Consequential

PAIRS = 4
"""Pairs of poles that ringing may have: converters' filters are of eighth order [-]."""

DELAYS = (0, 1, 2)
"""Samples after a pulse has fallen to a tenth of its peak at which it may be over [-]."""

PLACES = -0.4 + 1j * np.linspace(0.3, 2.9, 14)
"""Where a pair of poles may be before it is fitted: closer than their widths [-]."""

LONGEST = 200
"""Samples behind a pulse after which no filter rings any more: at 0.9 a sample, 1e-9 is left [-]."""

ENOUGH = 50
"""Forces from which the poles are found: twice as many determine them by a fifth better, on a few samples each [-]."""

HEARS = 0.25
"""Share of the power behind the pulses that ringing leaves, at most; else it is something else [-]."""

HEARD = 0.003
"""Ringing at the cut over the peak of the force from which the message counts: FRFs err by about as much [-]."""


@dataclass(frozen=True, eq=False)
class _Rest:
    """One force from the end of its pulse to its cut.

    Parameters
    ----------
    number : tuple of int
        Point and hit.
    cut : int
        The first sample that is zero.
    wave : array
        The force up to there [N].
    """

    number: tuple[int, int]
    cut: int
    wave: FloatArray

    def later(self, delay: int) -> Self:
        """Return it from some samples later on."""
        return replace(self, wave=self.wave[delay:])


@dataclass(frozen=True, eq=False)
class _Fit:
    """Damped exponentials fitted to what rings.

    Parameters
    ----------
    rests : list of _Rest
        The forces.
    poles : (n,) complex array
        Per sample, one of each pair [-].
    variance : float
        Of what they leave [N^2].
    """

    rests: list[_Rest]
    poles: ComplexArray
    variance: float


def with_tails(test: HammerTest) -> tuple[HammerTest, tuple[str, ...]]:
    """Return a test whose forces ring on behind a force window, and what was done.

    The filter in front of a converter rings behind a short pulse. A force window cuts the ringing off, in the force
    alone: the FRF then errs by the share of what is cut off, up to several per cent near the edge of the filter, alike
    in all hits. The filter is linear and the same for all hits, so that what rings is a sum of damped exponentials
    with common poles. Least squares with separated amplitudes find them in what is left (Golub and Pereyra, SIAM J.
    Numer. Anal. 10 (1973) 413-432), and so each force is continued.

    Parameters
    ----------
    test : HammerTest
        Records, one a hit.
    """
    rests = [
        rest
        for i, point in enumerate(test.points)
        for j, wave in enumerate(point.force)
        if (rest := _rest((i, j), np.asarray(wave, dtype=np.float64))) is not None
    ]
    later = [[rest.later(delay) for rest in rests] for delay in DELAYS]
    fits = [fit for each in later if (fit := _fit(each)) is not None]
    if not fits:
        return test, ()
    best = min(fits, key=lambda fit: fit.variance)
    rests, poles = best.rests, best.poles
    forces = [np.array(point.force, dtype=np.float64) for point in test.points]
    sizes = []
    for rest in rests:
        i, j = rest.number
        tail = _continued(rest, poles, forces[i].shape[-1] - rest.cut)
        forces[i][j, rest.cut :] += tail
        sizes.append(np.abs(tail[: 2 * PAIRS]).max(initial=0.0) / np.abs(forces[i][j]).max())
    points = tuple(replace(p, force=force) for p, force in zip(test.points, forces, strict=True))
    size = float(np.median(sizes))
    text = (
        f"{test.source}: a window ends the force while the filter of the converter still rings at {100 * size:.2g} % "
        "of the peak; the rest of the ringing is computed from its poles"
    )
    return replace(test, points=points), (Consequential(text),) if size > HEARD else ()


def _rest(number: tuple[int, int], wave: FloatArray) -> _Rest | None:
    """Return what is left of the ringing of a force; None where the force goes on, or does not ring."""
    moves = np.flatnonzero(np.diff(wave))
    if not np.isfinite(wave).all() or not len(moves):
        return None
    cut, last = int(moves[-1]) + 1, pulse_ends(np.abs(wave))[1]
    if wave[-1] != 0 or not 4 < cut - last <= LONGEST or len(wave) - cut < len(wave) // 2:
        return None
    rest = wave[last + 1 : cut]
    # what rings goes up and down; the end of a long pulse does not, and is whole
    if abs(rest.sum()) > 0.5 * np.abs(rest).sum():
        return None
    return _Rest(number, cut, rest)


def _fit(rests: list[_Rest]) -> _Fit | None:
    """Return the damped exponentials that leave least of what rings, by Akaike's criterion; None if nothing rings."""
    some = rests[:: len(rests) // ENOUGH + 1]
    unit = np.sqrt(np.mean(np.concatenate([np.zeros(1), *[rest.wave**2 for rest in some]]))) or 1.0
    waves = [rest.wave / unit for rest in some]
    alike = [np.array([w for w in waves if len(w) == n]).T for n in sorted({len(wave) for wave in waves})]
    count, size = sum(len(wave) for wave in waves), sum(float(wave @ wave) for wave in waves)
    best, found, poles = np.inf, None, np.zeros(0, complex)
    for pairs in range(1, PAIRS + 1):
        unknowns = 2 * pairs * (len(waves) + 1)
        if 2 * pairs >= min((len(wave) for wave in waves), default=0) or unknowns >= count:
            break
        poles, error = _one_more(poles, alike)
        score = count * np.log(error) + 2 * unknowns
        if score < best and error < HEARS * size and np.all(poles.real < 0):
            best, found = score, _Fit(rests, poles, unit**2 * error / (count - unknowns))
    return found


def _one_more(poles: ComplexArray, waves: list[FloatArray]) -> tuple[ComplexArray, float]:
    """Return poles with one more pair and what they leave [N^2]: the best place of it tried, then all improved."""
    tried = [np.append(poles, place) for place in PLACES]
    left = [float(np.sum(_left(_parts(one), waves) ** 2)) for one in tried]
    fit = least_squares(_left, _parts(tried[int(np.argmin(left))]), args=(waves,), x_scale=0.1, max_nfev=200)
    half = len(fit.x) // 2
    return fit.x[:half] + 1j * fit.x[half:], max(2.0 * float(fit.cost), np.finfo(float).tiny)


def _parts(poles: ComplexArray) -> FloatArray:
    return np.concatenate([poles.real, poles.imag])


def _left(parts: FloatArray, waves: list[FloatArray]) -> FloatArray:
    """Return what damped exponentials leave of waves, (count, n_waves) each, their amplitudes fitted to each [N]."""
    half = len(parts) // 2
    poles = parts[:half] + 1j * parts[half:]
    left = []
    for alike in waves:
        rings = _rings(poles, len(alike))
        left.append((alike - rings @ np.linalg.lstsq(rings, alike, rcond=None)[0]).ravel())
    return np.concatenate(left)


def _rings(poles: ComplexArray, count: int) -> FloatArray:
    """Return damped cosines and sines, (count, 2 n_poles)."""
    rings = np.exp(
        np.minimum(poles.real, 0.5) * np.arange(count)[:, None] + 1j * poles.imag * np.arange(count)[:, None]
    )
    return np.hstack([rings.real, rings.imag])


def _continued(rest: _Rest, poles: ComplexArray, count: int) -> FloatArray:
    """Return the force behind its cut, (count,) [N]."""
    rings = _rings(poles, len(rest.wave) + count)
    sizes = np.linalg.lstsq(rings[: len(rest.wave)], rest.wave, rcond=None)[0]
    return np.asarray(rings[len(rest.wave) :] @ sizes)
