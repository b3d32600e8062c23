"""What an update by FRFs reports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray, IntArray
from acquisition.quantities import percent
from identification import frac
from updating.frf_update.columns import columns
from updating.frf_update.evaluation import evaluate
from updating.frf_update.result import FrfUpdate
from updating.frf_update.stage import nominal
from updating.frf_update.statistics import StageStatistics, assess, misses, with_misses
from updating.frf_update.step import Step, identified_ratios, last_steps
from updating.models.state import NOMINAL, State, combine
from updating.prediction.assignment import mac_of_constants, match
from updating.prediction.predict import Predictor
from updating.test_data.measured_frfs import MeasuredFrfs
from updating.update.data.specimen import Specimen
from updating.update.estimate import Estimate
from updating.update.parameters.exact import full_modes
from updating.update.parameters.parameters import ModelParameter
from updating.update.statistics.determined import correlations

NOTEWORTHY = 0.01
"""Discrepancy from which a warning is given [-]."""


def report(specimen: Specimen, frfs: MeasuredFrfs, steps: Sequence[Step]) -> FrfUpdate:
    """Put together what the stages have found.

    Parameters
    ----------
    specimen : Specimen
        The specimen.
    frfs : MeasuredFrfs
        All its FRFs.
    steps : sequence of Step
        Every stage as often as it was gone through, in order.
    """
    last = last_steps(steps)
    results = _assessed(specimen, last)
    model_parameters = [k for step in last for k in step.stage.model_parameters]
    theta = np.concatenate([s.solved.theta for s in last])
    slope = np.array(
        [k.nominal * (k.value(t) if k.log else 1.0) for k, t in zip(model_parameters, theta, strict=True)]
    )
    covariance = _blocks([r.covariance for r in results])
    state = combine([s.own for s in last])
    if not specimen.predictor.expects(specimen.predictor.base.plus(state)):
        state = replace(state, ratios=last[0].stage.earlier.ratios)
    lost = np.concatenate([r.undetermined for r in results])
    pairs, exact = _pairs(
        specimen,
        last[-1].stage.predictor,
        state,
        [k.value(t) for k, t in zip(model_parameters, theta, strict=True)],
    )
    chi2, count = sum(r.chi2 for r in results), sum(r.count for r in results)
    return FrfUpdate(
        parameters=tuple(
            _estimate(k, float(t), float(s))
            for k, t, s in zip(model_parameters, theta, np.sqrt(np.diag(covariance)) * slope, strict=True)
        ),
        pairs=pairs,
        covariance=covariance * np.outer(slope, slope),
        correlations=correlations(covariance),
        undetermined=tuple(k.name for k, bad in zip(model_parameters, lost, strict=True) if bad),
        iterations=sum(len(s.solved.history) - 1 for s in steps),
        converged=all(s.solved.converged for s in last),
        chi2=chi2,
        dof=count - len(model_parameters),
        inflation=1.0,
        history=_history(steps, model_parameters),
        exact=exact,
        warnings=tuple(_warnings(specimen, last, exact)),
        data=count,
        weights="noise and discrepancy",
        quantity="receptance",
        frac=_frac(specimen, frfs, steps, state),
        stages=tuple(len(s.solved.history) - 1 for s in steps),
        lines=tuple(tuple(s.stage.frfs.frequency.tolist()) for s in last),
        discrepancy=tuple(s.solved.discrepancy for s in last),
        state=state,
    )


def _assessed(specimen: Specimen, last: Sequence[Step]) -> list[StageStatistics]:
    """Return how well the parameters of each stage are known, the misses of the model among it."""
    test = specimen.measured
    # a stage of damping alone looks at the lines where a mounting puts its peaks; misses hold the scatter too
    separate = [s.stage.damps_alone or s.solved.discrepancy > 0 for s in last]
    scatter = [0.0 if a else test.repeatability for a in separate]
    results = [assess(s.stage, s.solved, test.calibration, r) for s, r in zip(last, scatter, strict=True)]
    return [
        r if s.solved.discrepancy == 0 else with_misses(r, misses(specimen, s))
        for r, s in zip(results, last, strict=True)
    ]


def _blocks(parts: Sequence[FloatArray]) -> FloatArray:
    size = sum(len(p) for p in parts)
    total, first = np.zeros((size, size)), 0
    for part in parts:
        total[first : first + len(part), first : first + len(part)] = part
        first += len(part)
    return total


def _estimate(model_parameter: ModelParameter, coordinate: float, sigma: float) -> Estimate:
    value = model_parameter.value(coordinate)
    margin = 1e-6 * model_parameter.span()
    ends = (
        model_parameter.coordinate(model_parameter.low) + margin,
        model_parameter.coordinate(model_parameter.high) - margin,
    )
    factor = value if model_parameter.is_factor or model_parameter.parameter == "factor" else None
    if model_parameter.reach:
        factor = 1 + model_parameter.reach * value
    return Estimate(
        name=model_parameter.name,
        study=None,
        value=model_parameter.nominal * value,
        unit=model_parameter.unit,
        factor=factor,
        sigma=sigma,
        at_bound=not ends[0] < coordinate < ends[1],
        low=model_parameter.nominal * model_parameter.low,
        high=model_parameter.nominal * model_parameter.high,
        initial=model_parameter.nominal * model_parameter.start,
        relative=model_parameter.is_factor,
        quantity=model_parameter.quantity,
    )


def _history(steps: Sequence[Step], model_parameters: Sequence[ModelParameter]) -> pd.DataFrame:
    """Return factors and values of every iteration; parameters of other stages stand still."""
    current = {
        k.name: k.value(t)
        for s in steps
        for k, t in zip(s.stage.model_parameters, nominal(s.stage.model_parameters), strict=True)
    }
    rows = [dict(current)]
    for step in steps:
        for theta in step.solved.history[1:]:
            current |= {k.name: k.value(t) for k, t in zip(step.stage.model_parameters, theta, strict=True)}
            rows.append(dict(current))
    return pd.DataFrame(
        rows, columns=[k.name for k in model_parameters], index=pd.RangeIndex(len(rows), name="iteration")
    )


def _pairs(
    specimen: Specimen, predictor: Predictor, state: State, values: Sequence[float]
) -> tuple[pd.DataFrame, bool]:
    test = specimen.measured
    found = {}
    for name, own_predictor, at in (("before", specimen.predictor, NOMINAL), ("after", predictor, state)):
        prediction = own_predictor.predict(at)
        partner = match(test, prediction, specimen.order)
        found[name] = (prediction.select(partner), partner)
    after, partner = found["after"]
    whole = full_modes(predictor, lambda on: specimen.parameter_set.state(on, values), int(partner.max()) + 1)
    after_hz = after.frequency if whole is None else whole[0][partner]
    mac = np.full(len(partner), np.nan)
    if test.has_shapes:
        mac = np.diag(mac_of_constants(test, after)).copy()
    table = pd.DataFrame(
        {
            "study": specimen.title,
            "test_mode": specimen.number,
            "model_mode": partner + 1,
            "mac": mac,
            "test_hz": test.frequency,
            "before_hz": found["before"][0].frequency,
            "after_hz": after_hz,
            "used": True,
            "test_damping": test.damping,
            "before_damping": _damped(specimen.predictor, NOMINAL, found["before"][1]),
            "after_damping": _damped(predictor, state, partner),
        }
    )
    return table, whole is not None


def _damped(predictor: Predictor, state: State, partner: IntArray) -> FloatArray:
    """Return damping ratios by the complex modes; nan where the model has no damping [-]."""
    if not predictor.expects(predictor.base.plus(state)):
        return np.full(len(partner), np.nan)
    poles = predictor.complex_modes(state).poles
    return np.asarray((-poles.real / np.abs(poles))[partner])


def _frac(specimen: Specimen, frfs: MeasuredFrfs, steps: Sequence[Step], state: State) -> pd.DataFrame:
    """Compare FRFs before, after each stage's first round but the last stage's, and at the end."""
    nodes = specimen.measured.nodes
    table: dict[str, list[float] | list[int]] = {
        "response": [nodes[i] for i in frfs.seen],
        "force": [nodes[i] for i in frfs.hit],
    }
    separate = [s for s in steps if not s.together]
    first = [s.own for s in separate[: max(s.number for s in separate)]]
    stations = {"before": NOMINAL}
    stations |= {f"after stage {i + 1}": combine(first[: i + 1]) for i in range(len(first))}
    undamped = not specimen.predictor.expects(specimen.predictor.base)
    for name, at in (stations | {"after": state}).items():
        shown = replace(at, ratios=identified_ratios(specimen)) if undamped and not at.dampers else at
        own_predictor = specimen.predictor if name == "before" else steps[-1].stage.predictor
        computed = evaluate(own_predictor, shown, columns(frfs), frfs.laplace, order=frfs.order).receptance
        table[name] = frac(frfs.values, computed).tolist()
    return pd.DataFrame(table)


def _warnings(specimen: Specimen, last: Sequence[Step], exact: bool) -> list[str]:
    """Return the warnings, those that make the parameters doubtful first."""
    found = []
    for i, step in enumerate(last, start=1):
        if not step.solved.converged:
            found.append(
                f"not converged: the parameters of stage {i} still change after {len(step.solved.history) - 1} "
                "iterations"
            )
        if step.solved.discrepancy > NOTEWORTHY:
            found.append(
                f"stage {i}: the updated model misses the FRFs by "
                f"{percent(100 * step.solved.discrepancy)}, more than noise explains; the standard "
                "deviations include it"
            )
    if not exact:
        found.append(
            "an effect exists only in the reduced model: the frequencies after the update are those of "
            "the reduced model"
        )
    return [*found, *specimen.warnings]
