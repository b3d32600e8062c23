"""From cases to an updated model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.case import Case
from updating.update.determine import Statistics, assess, correlations
from updating.update.exact import full_frequencies
from updating.update.knobs import Knob
from updating.update.result import Estimate, Update
from updating.update.solve import Solution, solve
from updating.update.specimen import build_specimen
from updating.update.system import Quantity, System, Weights, build_system

EXACT = 1e-6
"""Agreement of reduced and full frequencies at which the outer iteration ends, relative [-]."""


def update(
    cases: Case | Sequence[Case],
    *,
    parameters: Sequence[str] | Sequence[Sequence[str]] = ("E",),
    shared: Sequence[str] = (),
    weights: Weights = "covariance",
    quantity: Quantity | None = None,
    regularise: bool | None = None,
) -> Update:
    """Update the parameters of one or several models by the frequencies of their tests.

    Paper A, Eqs. 15-25 with the errata corrected: the bracket of Eq. 25 closes behind W_theta (theta - theta_0),
    whose sign is negative, and W_theta holds inverse variances. The *nominal* model is updated; a baseline of
    the case plays no part.

    Parameters
    ----------
    cases : Case or sequence of Case
        Tests beside models.
    parameters : sequence of str, or one such sequence per case
        ``E``, ``density``, ``thickness``, ``width``, ``length``, ``root.E`` (a region), ``sensor_mass`` or any
        effect of the library, as ``name`` or ``name.parameter``.
    shared : sequence of str
        Parameters that have one value in all cases that have them.
    weights : {"covariance", "relative", "eigenvalue"} or sequence of float
        W_s: inverse variances of the measured frequencies; unit weights on relative frequencies; unit weights on
        eigenvalues; or one weight on the relative frequency of each measured mode, 0 to leave it out.
    quantity : {"frequency", "eigenvalue"}, optional
        Residual: 1 - f / f_e or lambda_e - lambda; left out, eigenvalues only for weights on eigenvalues.
    regularise : bool, optional
        Whether the tolerances hold the parameters near their nominal values (W_theta); left out, only with
        weights from the covariance.

    Returns
    -------
    Update

    Raises
    ------
    StudyError
        If a parameter, a shared name or the weights do not fit.
    EstimationError
        If no measured mode has a partner.
    """
    several = [cases] if isinstance(cases, Case) else list(cases)
    names = _per_case(parameters, len(several))
    specimens = [build_specimen(case, own) for case, own in zip(several, names, strict=True)]
    system = build_system(
        specimens,
        shared,
        weights,
        quantity or ("eigenvalue" if weights == "eigenvalue" else "frequency"),
        [len(case.measured.frequency) for case in several],
        regularised=weights == "covariance" if regularise is None else regularise,
    )
    system, solution, exact = _exactly(system)
    return _report(system, solution, assess(system, system.linear(solution.theta, solution.looks)), exact)


def _per_case(parameters: Sequence[str] | Sequence[Sequence[str]], count: int) -> list[list[str]]:
    if not parameters:
        raise StudyError('update: no parameters; name some, for instance parameters = ["E"]')
    if all(isinstance(p, str) for p in parameters):
        return [[str(p) for p in parameters]] * count
    if len(parameters) != count:
        raise StudyError(
            f"update: {len(parameters)} lists of parameters for {count} studies; give one for each"
        )
    return [list(own) for own in parameters]


def _exactly(system: System) -> tuple[System, Solution, bool]:
    """Solve on the reduced models, correct these by the full ones, and repeat until they agree."""
    solution = solve(system)
    history = [solution.history]
    for _ in range(5):
        full = [_full(system, i, solution) for i in range(len(system.specimens))]
        if any(f is None for f in full):
            return system, solution, False
        pairs = list(zip(full, solution.looks, strict=True))
        ratios = [np.asarray(f)[k.partner] / k.frequency for f, k in pairs]
        system = system.corrected([s.correction * r for s, r in zip(system.specimens, ratios, strict=True)])
        if max(np.abs(r - 1).max() for r in ratios) < EXACT:
            break
        solution = solve(system, solution.theta)
        history.append(solution.history[1:])
    looks = system.looks(solution.theta)
    return system, Solution(solution.theta, looks, np.vstack(history), solution.converged), True


def _full(system: System, index: int, solution: Solution) -> FloatArray | None:
    """Return the full model's frequencies; None where an effect lives on the reduced one alone."""
    specimen, look = system.specimens[index], solution.looks[index]
    updated = specimen.panel.effects(system.values(solution.theta, index))
    state = specimen.predictor.base.plus(look.state)
    return full_frequencies(
        specimen.predictor, state, dict(specimen.accepted) | updated, int(look.partner.max()) + 1
    )


def _report(system: System, solution: Solution, statistics: Statistics, exact: bool) -> Update:
    jacobian = np.array([_slope(k, t) for k, t in zip(system.knobs, solution.theta, strict=True)])
    with_units = statistics.covariance * np.outer(jacobian, jacobian)
    sigma = np.sqrt(np.diag(with_units))
    parameters = tuple(
        _estimate(system, i, float(t), float(s))
        for i, (t, s) in enumerate(zip(solution.theta, sigma, strict=True))
    )
    names = [_column(system, i) for i in range(len(system.knobs))]
    history = pd.DataFrame(
        [[k.value(t) for k, t in zip(system.knobs, row, strict=True)] for row in solution.history],
        columns=names,
        index=pd.RangeIndex(len(solution.history), name="iteration"),
    )
    return Update(
        parameters,
        _pairs(system, solution),
        with_units,
        correlations(statistics.covariance),
        tuple(n for n, bad in zip(names, statistics.undetermined, strict=True) if bad),
        solution.iterations,
        solution.converged,
        statistics.chi2,
        statistics.dof,
        statistics.inflation,
        history,
        exact,
        tuple(_warnings(system, solution, statistics, exact)),
    )


def _column(system: System, index: int) -> str:
    owner, name = system.owner[index], system.knobs[index].name
    return name if owner < 0 or len(system.specimens) == 1 else f"{name} ({system.specimens[owner].title})"


def _slope(knob: Knob, coordinate: float) -> float:
    value = knob.value(coordinate)
    return knob.nominal * (value if knob.log else 1.0)


def _estimate(system: System, index: int, coordinate: float, sigma: float) -> Estimate:
    knob, owner = system.knobs[index], system.owner[index]
    value = knob.value(coordinate)
    margin = 1e-6 * knob.span()
    factor = value if knob.is_factor or knob.parameter == "factor" else None
    if knob.reach and owner >= 0:
        factor = 1 + knob.reach * value
    return Estimate(
        knob.name,
        None if owner < 0 else system.specimens[owner].title,
        knob.nominal * value,
        knob.unit,
        factor,
        sigma,
        bool(coordinate <= system.low[index] + margin or coordinate >= system.high[index] - margin),
        knob.nominal * knob.low,
        knob.nominal * knob.high,
    )


def _pairs(system: System, solution: Solution) -> pd.DataFrame:
    weights = system.weights
    parts = []
    for specimen, look, weight in zip(system.specimens, solution.looks, weights, strict=True):
        before = specimen.nominal
        parts.append(
            pd.DataFrame(
                {
                    "study": specimen.title,
                    "test_mode": specimen.number,
                    "model_mode": look.partner + 1,
                    "mac": specimen.mac(look),
                    "test_hz": specimen.measured.frequency,
                    "before_hz": before.frequency,
                    "after_hz": look.frequency,
                    "used": weight > 0,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def _warnings(system: System, solution: Solution, statistics: Statistics, exact: bool) -> list[str]:
    found = [w for s in system.specimens for w in s.warnings]
    if not solution.converged:
        found.append(f"the parameters still move after {solution.iterations} iterations")
    if statistics.inflation > 1:
        found.append(
            f"the updated model misses the frequencies by {statistics.inflation:.1f} times what the measurement "
            "explains; the standard deviations are raised by that factor"
        )
    if not exact:
        found.append(
            "an effect is known to the reduced model alone: the frequencies after the update are its own"
        )
    return found
