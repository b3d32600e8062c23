"""A model at one setting, seen through the FRFs: receptances and what every parameter does to them.

Paper B, Eq. 9: the change of a receptance is -H dZ H, with Z = s^2 M + s C + K + i D at s = i omega + sigma, so
that a window's decay that is still in the data is in the model too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from updating.frf_update.columns import Columns
from updating.models.damping import Matrices
from updating.models.response import answers, on_each_line
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.update.parameters.parameters import ParameterSet

STEP = 1e-4
"""Step of the differences of matrices, relative to a parameter's doubt [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Evaluation:
    """A model at one setting of its parameters.

    Parameters
    ----------
    state : State
        Departure from the nominal model.
    matrices : Matrices
        K, M, C and D.
    rows : (n_points, r) array
        Displacement of the basis at the points.
    states : (n_lines, r, n_points) complex array
        Z^-1 times a unit force at every point, gain not included [m/N on the basis].
    receptance : (n_frf, n_lines) complex array
        The model's FRFs, gain included [m/N].
    laplace : (n_lines,) complex array
        Where in the Laplace plane, a window that only the model has included [1/s].
    gain : (n_lines,) complex array
        Factor of the measured level over the true one: the calibration's, and what such a window does to a motion
        that was integrated as if there were none [-].
    order : int
        How often the measured motion was integrated to a displacement [-].
    """

    state: State
    matrices: Matrices
    rows: FloatArray
    states: ComplexArray
    receptance: ComplexArray
    laplace: ComplexArray
    gain: ComplexArray
    order: int = 0


def evaluate(
    predictor: Predictor, state: State, ends: Columns, laplace: ComplexArray, *, order: int = 0
) -> Evaluation:
    """Evaluate a model at the points and lines of measured FRFs.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    state : State
        Departure from its nominal model.
    ends : Columns
        The points of every FRF.
    laplace : (n_lines,) complex array
        Where in the Laplace plane, by what is stated of the measurement [1/s].
    order : int
        How often the measured motion was integrated to a displacement: a file of accelerances, twice [-].
    """
    matrices, rows, level, decay = _parts(predictor, state, ends)
    there = laplace + decay
    gain = level * (there / laplace) ** order if decay else np.full(len(laplace), level, dtype=complex)
    states = answers(matrices, rows.T, there)
    receptance = gain * on_each_line(rows, states)[:, ends.response, ends.excitation].T
    return Evaluation(
        state=state,
        matrices=matrices,
        rows=rows,
        states=states,
        receptance=receptance,
        laplace=there,
        gain=gain,
        order=order,
    )


def _parts(predictor: Predictor, state: State, ends: Columns) -> tuple[Matrices, FloatArray, float, float]:
    total = predictor.base.plus(state)
    if total.theory is not None and total.theory != predictor.spec.theory:
        return _parts(predictor.under(total.theory), replace(state, theory=None), ends)
    return predictor.matrices(state), predictor.point_rows(state)[ends.points], total.gain, total.decay


@dataclass(frozen=True, eq=False)
class Change:
    """Derivatives of everything by one coordinate.

    Parameters
    ----------
    matrices : Matrices
        Derivatives of K, M, C and D.
    rows : (n_points, r) array
        Derivative of the rows, where points move on the model; zero elsewhere.
    log_gain : float
        Derivative of the logarithm of the gain [-].
    decay : float
        Derivative of the decay of a window that only the model has [1/s].
    """

    matrices: Matrices
    rows: FloatArray
    log_gain: float
    decay: float


def changes(
    predictor: Predictor, parameter_set: ParameterSet, values: Sequence[float], ends: Columns, earlier: State
) -> list[Change]:
    """Return what each parameter changes in the model, by central differences of its matrices.

    The matrices are powers and sums, so that these differences are good to rounding; the receptances are then
    differentiated exactly. One way serves every parameter: section, modulus, damping by region (Eqs. 11-13),
    length, effects.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    parameter_set : ParameterSet
        Its parameters.
    values : sequence of float
        Their factors and values.
    ends : Columns
        The points of every FRF.
    earlier : State
        What earlier stages have settled.
    """
    found = []
    for i, model_parameter in enumerate(parameter_set.model_parameters):
        here, step = (
            model_parameter.coordinate(values[i]),
            STEP * min(model_parameter.doubt, model_parameter.span() / 4),
        )
        limits = (
            model_parameter.coordinate(model_parameter.low),
            model_parameter.coordinate(model_parameter.high),
        )
        at = [max(here - step, limits[0]), min(here + step, limits[1])]
        sides = []
        for coordinate in at:
            moved = [*values[:i], model_parameter.value(coordinate), *values[i + 1 :]]
            sides.append(_parts(predictor, earlier.plus(parameter_set.state(predictor, moved)), ends))
        width = at[1] - at[0]
        (low, low_rows, low_gain, low_decay), (high, high_rows, high_gain, high_decay) = sides
        names = ("stiffness", "mass", "viscous", "structural")
        matrices = Matrices(*[(getattr(high, n) - getattr(low, n)) / width for n in names])
        log_gain = float(np.log(high_gain / low_gain) / width)
        found.append(
            Change(matrices, (high_rows - low_rows) / width, log_gain, (high_decay - low_decay) / width)
        )
    return found


def sensitivity(
    at: Evaluation, change: Change, ends: Columns, excited: ComplexArray | None = None
) -> ComplexArray:
    """Return dH / d coordinate of every FRF, shape (n_frf, n_lines) [m/N].

    Parameters
    ----------
    at : Evaluation
        The model.
    change : Change
        What the coordinate changes.
    ends : Columns
        The points of every FRF.
    excited : (n_lines, r, n_excitations) complex array, optional
        The structure's own motion under each excitation of ``ends`` in place of the model's: H^X of Eq. 9 where it
        was measured, expanded to all of the basis [m/N].
    """
    excitations, which = np.unique(ends.excitation, return_inverse=True)
    right = at.states[:, :, excitations] if excited is None else excited
    left = at.states.transpose(0, 2, 1)
    by = -(left @ _forces(at, change, right))[:, ends.response, which.ravel()].T
    if np.any(change.rows):
        moving = on_each_line(change.rows, at.states)
        moving = moving + moving.transpose(0, 2, 1)
        by = by + moving[:, ends.response, ends.excitation].T
    level = change.log_gain + at.order * change.decay / at.laplace
    return np.asarray(at.gain * by + level * at.receptance)


def _forces(at: Evaluation, change: Change, states: ComplexArray) -> ComplexArray:
    """Return dZ / d coordinate times states (n_lines, r, n) [N]."""
    s, d, own = at.laplace[:, None, None], change.matrices, at.matrices
    one = np.ones_like(s)
    parts = [(s**2, d.mass), (s, d.viscous), (one, d.stiffness), (1j * one, d.structural)]
    if change.decay:
        parts += [(2 * s * change.decay, own.mass), (change.decay * one, own.viscous)]
    found = np.zeros(states.shape, dtype=complex)
    for factor, matrix in parts:
        if np.any(matrix):
            found += factor * on_each_line(matrix, states)
    return found
