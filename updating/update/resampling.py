"""Intervals of the parameters from tests that might have been: data drawn anew, and updated again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.display import Displayed
from acquisition.errors import StudyError
from updating.case import Case
from updating.steps import SILENT, Steps
from updating.update.data.specimen import Specimen
from updating.update.data.system import Quantity, System, Weights
from updating.update.intervals import check_draws, with_intervals
from updating.update.result import Update
from updating.update.run import Fitted, fit, report
from updating.update.solve import solve


@dataclass(frozen=True, eq=False)
class Draws:
    """What was drawn, and what came of it.

    Parameters
    ----------
    frequency : (n, n_modes) array
        Frequencies of all paired modes, study after study [Hz].
    centre : (n, p) array
        Coordinates near which the tolerances hold the parameters.
    coordinates : (n, p) array
        Coordinates of the updated parameters.
    values : (n, p) array
        The same as factors and values.
    converged : int
        How many of the updates came to rest.
    """

    frequency: FloatArray
    centre: FloatArray
    coordinates: FloatArray
    values: FloatArray
    converged: int


@dataclass(frozen=True, eq=False)
class Bootstrap(Displayed):
    """An update and its repetitions.

    Parameters
    ----------
    update : Update
        The update of the data at hand, whose parameters carry percentile intervals.
    draws : Draws
        The repetitions.
    """

    update: Update
    draws: Draws


def bootstrap(
    cases: Case | Sequence[Case],
    *,
    rng: np.random.Generator,
    n: int = 200,
    frequencies: Sequence[FloatArray | None] | None = None,
    parameters: Sequence[str] | Sequence[Sequence[str]] = ("E",),
    shared: Sequence[str] = (),
    weights: Weights = "covariance",
    quantity: Quantity | None = None,
    regularise: bool | None = None,
    data: Sequence[str] = ("frequencies",),
    steps: Steps = SILENT,
) -> Bootstrap:
    """Update, then update again many times from data drawn anew.

    Frequencies are those that :func:`redrawn_frequencies` makes from the test's hits, or are drawn from the
    covariance that the identification states; the scatter by re-mounting, which neither includes, is added.
    Shapes or constants, where they are data, are drawn from their covariance.
    Where tolerances hold the parameters, what they hold them near is drawn too (randomised maximum likelihood;
    Oliver, He and Reynolds 1996), for otherwise the spread would leave out what only the tolerances determine.
    All draws are updated on the reduced model that agrees with the full one at the solution. They begin at it:
    where several solutions explain the data about as well, the intervals are widened to those of all of them.

    The intervals cover the measurement's scatter and, with tolerances, the modeller's doubt. They do not cover
    the model's error: a form of model that cannot fit, a wrong length or a wrong boundary shifts all draws alike;
    ``inflation`` and the remaining errors of the frequencies show it.

    Parameters
    ----------
    cases, parameters, shared, weights, quantity, regularise, data
        As for :func:`update`.
    rng : numpy.random.Generator
        Source of the draws.
    n : int
        Number of draws [-].
    frequencies : sequence of (n, n_measured) arrays or None, optional
        For each case, redrawn frequencies of all its measured modes, None to draw from the covariance [Hz].
    steps : Steps
        Where it is announced how many draws are updated.

    Raises
    ------
    StudyError
        If there are fewer than twenty draws, or the redrawn frequencies do not fit the test.
    """
    check_draws(n, better=200)
    fitted = fit(
        cases,
        parameters=parameters,
        shared=shared,
        weights=weights,
        quantity=quantity,
        regularise=regularise,
        data=data,
    )
    draws = _repeat(fitted, rng, n, frequencies or [None] * len(fitted.system.specimens), steps)
    return Bootstrap(_reported(report(fitted), fitted.system, draws), draws)


def _repeat(
    fitted: Fitted, rng: np.random.Generator, n: int, given: Sequence[FloatArray | None], steps: Steps
) -> Draws:
    system, theta = fitted.system.around(fitted.solution.theta), fitted.solution.theta
    system.evaluations(theta)  # what all draws share is worked out before the first
    if len(given) != len(system.specimens):
        raise StudyError(
            f"bootstrap: redrawn frequencies for {len(given)} of {len(system.specimens)} studies; give one set, or "
            "None, for each"
        )
    frequency = [_redrawn(system, i, own, rng, n) for i, own in enumerate(given)]
    spread = np.where(system.prior > 0, 1 / np.sqrt(np.maximum(system.prior, 1e-300)), 0.0)
    centre = system.start + spread * rng.standard_normal((n, len(theta)))
    coordinates, rested = np.empty((n, len(theta))), 0
    for i in steps.each(range(n)):
        constants = [_redrawn_shapes(s, rng) for s in system.specimens] if system.shapes else None
        solution = solve(system.redrawn([f[i] for f in frequency], centre[i], constants), theta)
        coordinates[i] = solution.theta
        rested += solution.converged
    values = np.stack(
        [[k.value(t) for t in c] for k, c in zip(system.model_parameters, coordinates.T, strict=True)], axis=1
    )
    return Draws(np.hstack(frequency), centre, coordinates, values, rested)


def _redrawn(
    system: System, index: int, given: FloatArray | None, rng: np.random.Generator, n: int
) -> FloatArray:
    """Return redrawn frequencies of the paired modes of one specimen, (n, n_modes) [Hz]."""
    specimen = system.specimens[index]
    test = specimen.measured
    if given is None:
        sigma = np.sqrt(specimen.relative_variance)
        return np.asarray(test.frequency * (1 + sigma * rng.standard_normal((n, len(sigma)))))
    if given.ndim != 2 or len(given) != n or given.shape[1] < specimen.number.max():
        raise StudyError(
            f"bootstrap: {specimen.title}: redrawn frequencies of shape {given.shape} for {n} draws of "
            f"{specimen.number.max()} or more modes; draw them for all measured modes"
        )
    chosen = given[:, specimen.number - 1]
    return np.asarray(chosen * (1 + test.repeatability * rng.standard_normal(chosen.shape)))


def _redrawn_shapes(specimen: Specimen, rng: np.random.Generator) -> FloatArray:
    """Return the constants of a specimen with other errors of the same variance, (n_frf, n_modes) [1/kg]."""
    constants = specimen.measured.constants
    return np.asarray(constants + specimen.errors.draw(rng).reshape(constants.shape))


def _reported(update: Update, system: System, draws: Draws) -> Update:
    parameters = with_intervals(update.parameters, draws.values, system.model_parameters)
    warnings = list(update.warnings)
    if draws.converged < len(draws.values):
        lost = len(draws.values) - draws.converged
        warnings.append(f"bootstrap: {lost} of {len(draws.values)} updates did not converge")
    return replace(update, parameters=parameters, warnings=tuple(warnings), draws=len(draws.values))
