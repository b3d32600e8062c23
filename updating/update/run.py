"""From cases to an updated model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.quantities import percent
from updating.case import Case
from updating.update.building import BEYOND, build_specimen, build_system, check_data, per_case
from updating.update.data.specimen import Specimen
from updating.update.data.system import Quantity, System, Weights
from updating.update.discrepancy import agreed
from updating.update.estimate import Estimate
from updating.update.parameters.exact import full_modes
from updating.update.parameters.parameters import ModelParameter
from updating.update.result import Update
from updating.update.solve import Solution, solve
from updating.update.statistics.determined import Statistics, assess, correlations
from updating.update.statistics.doubts import doubts
from updating.update.statistics.held import Held, held, sentences
from updating.update.statistics.mixture import Mixture
from updating.update.statistics.solutions import Others, mixture, notes_on_others, within

EXACT = 1e-7
"""Agreement of reduced and full frequencies at which the outer iteration ends, relative [-]."""

AGREED = 1e-5
"""Agreement from which on they count as the same where it ends without, relative [-]: a tenth of the best test's
sigma. Doubled: the warning that they differ comes later."""


def update(
    cases: Case | Sequence[Case],
    *,
    parameters: Sequence[str] | Sequence[Sequence[str]] = ("E",),
    shared: Sequence[str] = (),
    weights: Weights = "covariance",
    quantity: Quantity | None = None,
    regularise: bool | None = None,
    data: Sequence[str] = ("frequencies",),
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
    data : sequence of str
        ``frequencies``, and one of ``shapes`` and ``constants``. Shapes are those of the modes up to a factor
        each; constants have their level, which needs calibrated FRFs or mass-normalised shapes. Both are weighted by
        the inverse of the modal constants' covariance: noise, errors of the poles, places of points and sensors, and
        for constants the calibration, which all of a test have in common. They need weights from the covariance.

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
    fitted = fit(
        cases,
        parameters=parameters,
        shared=shared,
        weights=weights,
        quantity=quantity,
        regularise=regularise,
        data=data,
    )
    return report(fitted)


@dataclass(frozen=True, eq=False)
class Fitted:
    """An update before it is reported.

    Parameters
    ----------
    system : System
        The problem, on reduced models that agree with the full ones at the solution.
    solution : Solution
        Where the iteration came to rest.
    disagreement : float or None
        How far the frequencies there were from those of the full models, relative, before they were made to agree;
        None where an effect is known to the reduced model alone [-].
    others : Others
        Other solutions that explain the data about as well.
    contradicted : bool
        Whether shapes count for less than what is left of them asks for, because they pulled the frequencies off.
    weights : str
        What W_s is.
    """

    system: System
    solution: Solution
    disagreement: float | None
    others: Others
    contradicted: bool
    weights: str


def fit(
    cases: Case | Sequence[Case],
    *,
    parameters: Sequence[str] | Sequence[Sequence[str]] = ("E",),
    shared: Sequence[str] = (),
    weights: Weights = "covariance",
    quantity: Quantity | None = None,
    regularise: bool | None = None,
    data: Sequence[str] = ("frequencies",),
) -> Fitted:
    """Solve an update; see :func:`update`."""
    several = [cases] if isinstance(cases, Case) else list(cases)
    names = per_case(parameters, len(several))
    check_data(data, several, weights)
    specimens = [
        build_specimen(case, own, lean=True, level="constants" in data)
        for case, own in zip(several, names, strict=True)
    ]
    system = build_system(
        specimens,
        shared,
        weights,
        quantity or ("eigenvalue" if weights == "eigenvalue" else "frequency"),
        [len(case.measured.frequency) for case in several],
        regularised=weights == "covariance" if regularise is None else regularise,
        shapes=bool(set(data) & set(BEYOND)),
    )
    kind = weights if isinstance(weights, str) else "given for each mode"
    return Fitted(*_exactly(system), kind)


def _exactly(system: System) -> tuple[System, Solution, float | None, Others, bool]:
    """Solve on the reduced models, bring these nearer to the full ones there, and repeat until they agree."""
    found = agreed(system)
    system, solution, others = found.system, found.solution, found.others
    history = [solution.history]
    if system.shapes:
        system = system.settled(solution.theta, solution.evaluations)
        solution = solve(system, solution.theta)
        history.append(solution.history[1:])
    for left in range(6, -1, -1):
        full = [_full(system, i, solution) for i in range(len(system.specimens))]
        modes = [f for f in full if f is not None]
        if len(modes) < len(full):
            return system, solution, None, others, found.contradicted
        ratios = [
            f / evaluation.frequency for (f, _), evaluation in zip(modes, solution.evaluations, strict=True)
        ]
        disagreement = float(max(np.abs(ratio - 1).max() for ratio in ratios))
        near = disagreement < EXACT
        if not near and not left:
            break
        vectors = [v for _, v in modes]
        system = system.corrected(ratios) if near else system.nearer(vectors, ratios)
        solution = solve(system, solution.theta)
        history.append(solution.history[1:])
        if near:
            break
    evaluations = system.evaluations(solution.theta)
    return (
        system,
        Solution(solution.theta, evaluations, np.vstack(history), solution.converged),
        disagreement,
        others,
        found.contradicted,
    )


def _full(system: System, index: int, solution: Solution) -> tuple[FloatArray, FloatArray] | None:
    """Return the full model's frequencies of the partners, and all its low modes; None where there is no such."""
    specimen, evaluation = system.specimens[index], solution.evaluations[index]
    values = system.values(solution.theta, index)
    modes = full_modes(
        specimen.predictor,
        lambda on: specimen.parameter_set.state(on, values),
        int(evaluation.partner.max()) + 1,
    )
    return None if modes is None else (modes[0][evaluation.partner], modes[1])


def report(fitted: Fitted) -> Update:
    """Work out the statistics of an update."""
    system, solution, disagreement = fitted.system, fitted.solution, fitted.disagreement
    statistics, several = assess_all(fitted)
    kept = held(system, solution) if statistics.inflation > 1 else ()
    jacobian = np.array([_slope(k, t) for k, t in zip(system.model_parameters, solution.theta, strict=True)])
    with_units = statistics.covariance * np.outer(jacobian, jacobian)
    sigma = np.sqrt(np.diag(with_units))
    parameters = tuple(
        _estimate(system, i, float(t), float(s))
        for i, (t, s) in enumerate(zip(solution.theta, sigma, strict=True))
    )
    if several is not None:
        parameters = tuple(
            within(p, system.model_parameters[i], several, i) for i, p in enumerate(parameters)
        )
    names = list(system.names)
    against = {names[h.index] for h in kept}
    history = pd.DataFrame(
        [[k.value(t) for k, t in zip(system.model_parameters, row, strict=True)] for row in solution.history],
        columns=names,
        index=pd.RangeIndex(len(solution.history), name="iteration"),
    )
    return Update(
        parameters=parameters,
        pairs=_pairs(system, solution),
        covariance=with_units,
        correlations=correlations(statistics.covariance),
        undetermined=tuple(
            n for n, bad in zip(names, statistics.undetermined, strict=True) if bad and n not in against
        ),
        iterations=solution.iterations,
        converged=solution.converged,
        chi2=statistics.chi2,
        dof=statistics.dof,
        inflation=statistics.inflation,
        history=history,
        exact=disagreement is not None and disagreement < AGREED,
        warnings=(*_warnings(fitted, statistics, kept), *notes_on_others(system, several)),
        determinability=statistics.determinability.without(against),
        held=tuple(names[h.index] for h in kept),
        data=system.count,
        weights=fitted.weights,
        quantity=system.quantity,
    )


def assess_all(fitted: Fitted) -> tuple[Statistics, Mixture | None]:
    """Return the statistics of an update, and the mixture of all solutions where another one matters."""
    system, solution = fitted.system, fitted.solution
    statistics = assess(system, system.linear(solution.theta, solution.evaluations), solution.theta)
    if not fitted.others.solutions:
        return statistics.strained(), None
    both = mixture(system, solution, statistics.covariance, fitted.others)
    if both.solutions == 1:
        return statistics.strained(), None
    return replace(statistics, covariance=both.error()), both


def _slope(model_parameter: ModelParameter, coordinate: float) -> float:
    value = model_parameter.value(coordinate)
    return model_parameter.nominal * (value if model_parameter.log else 1.0)


def _estimate(system: System, index: int, coordinate: float, sigma: float) -> Estimate:
    model_parameter, owner = system.model_parameters[index], system.owner[index]
    value = model_parameter.value(coordinate)
    margin = 1e-6 * model_parameter.span()
    factor = value if model_parameter.is_factor or model_parameter.parameter == "factor" else None
    if model_parameter.reach and owner >= 0:
        factor = 1 + model_parameter.reach * value
    return Estimate(
        name=model_parameter.name,
        study=None if owner < 0 else system.specimens[owner].title,
        value=model_parameter.nominal * value,
        unit=model_parameter.unit,
        factor=factor,
        sigma=sigma,
        at_bound=bool(coordinate <= system.low[index] + margin or coordinate >= system.high[index] - margin),
        low=model_parameter.nominal * model_parameter.low,
        high=model_parameter.nominal * model_parameter.high,
        initial=model_parameter.nominal * model_parameter.start,
        relative=model_parameter.is_factor,
        quantity=model_parameter.quantity,
    )


def _pairs(system: System, solution: Solution) -> pd.DataFrame:
    weights = system.weights
    parts = []
    for specimen, evaluation, weight in zip(system.specimens, solution.evaluations, weights, strict=True):
        before = specimen.nominal.evaluation
        parts.append(
            pd.DataFrame(
                {
                    "study": specimen.title,
                    "test_mode": specimen.number,
                    "model_mode": evaluation.partner + 1,
                    "mac": specimen.mac(evaluation),
                    "test_hz": specimen.measured.frequency,
                    "before_hz": before.frequency,
                    "after_hz": evaluation.frequency,
                    "used": weight > 0,
                    **({"shape_sigma": _shape_sigma(specimen)} if system.shapes else {}),
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def _shape_sigma(specimen: Specimen) -> FloatArray:
    return specimen.shape_sigma if specimen.measured.has_shapes else np.full(len(specimen.number), np.nan)


def _on_shapes(system: System, *, contradicted: bool) -> Iterator[str]:
    """State how well shapes are taken to be known, where that is not as stated."""
    if not system.shapes:
        return
    for specimen in system.specimens:
        found = specimen.nominal.discrepancy
        if found is None or not found.any():
            continue
        size = specimen.shape_sigma
        middle, worst = float(np.median(size)), int(np.argmax(size))
        stated = (
            "the uncertainty of the shapes was not stated"
            if specimen.measured.guessed
            else ("shapes deviate from the model by more than their stated uncertainty")
        )
        yield (
            f"{specimen.title}: {stated}: their error is taken as {percent(100 * middle)} of their r.m.s., "
            f"that of test mode {specimen.number[worst]} as {percent(100 * size[worst])}"
            + (", so large that the shapes do not contradict the frequencies" if contradicted else "")
        )


def _at_bounds(system: System, solution: Solution) -> Iterator[str]:
    """State which parameters the data would take beyond their bounds, and what then is to be thought of the rest."""
    stopped = [
        e.name for i, t in enumerate(solution.theta) if (e := _estimate(system, i, float(t), 0.0)).at_bound
    ]
    if stopped:
        yield (
            f"{', '.join(stopped)} ended at a bound, not at the best fit: standard deviations ignore the bound, "
            "and the other parameters compensate for it; widen the bounds, or find what is wrong with the model"
        )


def _warnings(fitted: Fitted, statistics: Statistics, kept: tuple[Held, ...]) -> list[str]:
    """Return the warnings, those that make the parameters doubtful first."""
    system, solution = fitted.system, fitted.solution
    found = []
    if not solution.converged:
        found.append(f"not converged: the parameters still change after {solution.iterations} iterations")
    found += _at_bounds(system, solution)
    if statistics.strain > 1:
        away = (solution.theta - system.start) * np.sqrt(system.prior)
        worst = int(np.argmax(np.abs(away)))
        found.append(
            f"{system.names[worst]} ends {abs(away[worst]):.0f} tolerances from its nominal value: data and tolerances "
            f"contradict each other; standard deviations from tolerances are raised by {statistics.strain:.1f}"
        )
    if statistics.inflation > 1:
        found.append(
            f"the updated model misses the frequencies by {statistics.inflation:.1f} times what the measurement "
            "explains; the standard deviations are raised by that factor"
        )
    found += [*sentences(system, kept), *doubts(system, solution, statistics.dof), *_on_reduction(fitted)]
    found += (w for s in system.specimens for w in s.warnings)
    return [*found, *_on_shapes(system, contradicted=fitted.contradicted)]


def _on_reduction(fitted: Fitted) -> Iterator[str]:
    """State where the frequencies after the update are not those of the full model."""
    disagreement = fitted.disagreement
    if disagreement is None:
        yield (
            "an effect exists only in the reduced model: the frequencies after the update are those of "
            "the reduced model"
        )
    elif disagreement >= AGREED:
        yield (
            f"reduced and full model still differ by {percent(100 * disagreement)} in a frequency: the update is "
            "accurate to about that; refine the mesh, or narrow the range of what moves nodes"
        )
