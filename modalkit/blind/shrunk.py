"""How far an answer truly closes the gap: what it states, put into the rig's own nominal body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.optimize

from acquisition.arrays import FloatArray
from modalkit.blind.answer import Answer, Row
from modalkit.blind.trial import Trial
from modalkit.simulator.bodies.complex_modes import ComplexModes
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.matching import match
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

_TOLERANCES = ("E", "density", "thickness", "length", "width")
_STEP = 1e-3
_BOUND = 3.0
_FREQUENCY_SIGMA = 2e-4
_HELD_OUT = 3
_LEAST = 1e-3
_RIGID = 0.1  # of the compliance that a stiffer place keeps at least, a loss of -9
_STANDS = 0.02  # of the first nominal frequency; what is slower has buckled


@dataclass(frozen=True)
class Shrinkage:
    """R.m.s. error of the model against the specimen's true modes, before the answer and after.

    Parameters
    ----------
    metric : {"frequency", "damping"}
        Error of what.
    before_percent, after_percent : float
        On the modes that the band was chosen for [%].
    beyond_before_percent, beyond_after_percent : float
        On the next three modes, above the band [%].
    """

    metric: str
    before_percent: float
    after_percent: float
    beyond_before_percent: float
    beyond_after_percent: float


def true_shrinkage(trial: Trial, answer: Answer) -> Shrinkage | None:
    """Return how far the best answer shrinks the gap on the rig.

    Parameters
    ----------
    trial : Trial
        With the true specimen.
    answer : Answer
        What the diagnosis states; its most probable row counts.

    Returns
    -------
    Shrinkage or None
        None where the answer names nothing that the rig can do, or so much of it that modes are missing, as where a
        load buckles the nominal body; and of what is modelled by matrices, whose answers name parts. Tolerances are
        refitted in their linearisation, each within three standard deviations, to the frequencies measured; with a
        baseline they are known.
        Damping is not refitted: its tolerance is each mode's own and would explain all.
    """
    row = answer.best
    if row is None or not row.effects or trial.scene.setup.by_matrices:
        return None
    added = put_in(nominal_scene(trial.scene.setup), row)
    if added is None:
        return None
    metric = "damping" if all(HIDDEN_EFFECTS[n].metric == "damping" for n in row.effects) else "frequency"
    if "shear" not in row.effects:
        added = _as_modelled(added)
    errors = _errors(trial, added, metric)
    if errors is None:
        return None
    before, after = errors
    count = trial.scene.setup.modes

    def rms(errors: FloatArray) -> float:
        return float(100 * np.sqrt(np.mean(np.expm1(-errors) ** 2)))

    return Shrinkage(metric, rms(before[:count]), rms(after[:count]), rms(before[count:]), rms(after[count:]))


def put_in(scene: Scene, row: Row) -> Scene | None:
    """Put the effects of an answer into a rig.

    Parameters
    ----------
    scene : Scene
        The rig as the model has it.
    row : Row
        Effects and their parameters.

    Returns
    -------
    Scene or None
        None where the rig lacks one of them, or the answer lacks a number it needs.
    """
    for name in sorted(
        row.effects, key=list(HIDDEN_EFFECTS).index if row.effects <= set(HIDDEN_EFFECTS) else str
    ):
        hidden_effect = HIDDEN_EFFECTS.get(name)
        if hidden_effect is None or not hidden_effect.in_library:
            return None
        values = _values(name, row)
        try:
            if not all(np.all(np.isfinite(v)) for v in values.values()):
                return None
            scene = hidden_effect.act(scene, _as_box(values) if name == "local_stiffness" else values)
        except KeyError:
            return None
    return scene


def _values(name: str, row: Row) -> dict[str, Any]:
    prefix = f"{name}."
    found: dict[str, Any] = {
        key.removeprefix(prefix): estimate.value
        for key, estimate in row.parameters.items()
        if key.startswith(prefix)
    }
    for key, points in row.points.items():
        if key.startswith(prefix):
            short = key.removeprefix(prefix)
            found[short] = points[0] if short == "point" else list(points)
    return found


def _as_box(values: dict[str, Any]) -> dict[str, Any]:
    """Return a soft place as the library means it, a box, and with the compliance that is stated, which counts."""
    if "compliance" not in values:
        return values | {"form": "rectangle"}
    left = max(values["compliance"] + values["extent"], _RIGID * values["extent"])
    return values | {"form": "rectangle", "loss": 1.0 - values["extent"] / left}


def _errors(trial: Trial, added: Scene, metric: str) -> tuple[FloatArray, FloatArray] | None:
    """Return ln(specimen / model) before and after, measured modes first [-]; None where modes are missing."""
    setup = trial.scene.setup
    count = setup.modes + _HELD_OUT
    nominal = _as_modelled(nominal_scene(setup))
    model = nominal.elastic().take(slice(0, count))
    found = [_quantities(s, model, metric) for s in (trial.scene, nominal, added, trial.before)]
    if any(len(one) < count for one in found):
        return None
    true, plain, moved, known = found
    if setup.baseline:
        if metric == "damping":
            return np.log(true / known), np.log(true / np.maximum(known + moved - plain, _LEAST * known))
        return np.log(true / known), np.log(true / known * plain / moved)
    before, after = np.log(true / plain), np.log(true / moved)
    if metric == "damping":
        return before, after
    return before, _refitted(after, _tolerances(setup, model), setup)


def _as_modelled(scene: Scene) -> Scene:
    """Return the scene in the theory of the study's model."""
    return scene.with_body(shear=False) if scene.setup.theory != "timoshenko" else scene


def _quantities(scene: Scene, like: ComplexModes, metric: str) -> FloatArray:
    """Return angular frequency or decay of the modes matched to the model's, none if it buckles [rad/s], [1/s]."""
    body = scene.at_level(scene.body, scene.setup.peak)
    lowest = body.real_modes(body.rigid_modes + 1)[0][-1] / (2 * np.pi)
    if not lowest > _STANDS * like.frequency[0]:
        return np.zeros(0)
    modes = scene.elastic()
    poles = modes.poles[match(like, modes)]
    return np.abs(poles) if metric == "frequency" else scene.chain.window - poles.real


def _tolerances(setup: Setup, model: ComplexModes) -> FloatArray:
    """Return the change of ln f per standard deviation of each doubt, (n_modes, n_doubts)."""
    columns = []
    for name in _TOLERANCES:
        moved = _as_modelled(nominal_scene(setup, factors={name: 1.0 + _STEP})).elastic()
        shift = np.log(moved.frequency[match(model, moved)] / model.frequency)
        columns.append(shift / _STEP * getattr(setup.tolerances, name))
    return np.column_stack(columns)


def _refitted(errors: FloatArray, shift: FloatArray, setup: Setup) -> FloatArray:
    """Return what the tolerances leave, fitted to the measured modes and to their own sigma."""
    count = setup.modes
    sigma = np.hypot(_FREQUENCY_SIGMA, setup.repeatability)
    rows = np.vstack([shift[:count] / sigma, np.eye(shift.shape[1])])
    wanted = np.concatenate([errors[:count] / sigma, np.zeros(shift.shape[1])])
    fit = scipy.optimize.lsq_linear(rows, wanted, bounds=(-_BOUND, _BOUND))
    left: FloatArray = errors - shift @ fit.x
    return left
