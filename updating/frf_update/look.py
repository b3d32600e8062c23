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
from updating.prediction import Predictor
from updating.update.knobs import Panel

STEP = 1e-4
"""Step of the differences of matrices, relative to a parameter's doubt [-]."""


@dataclass(frozen=True, eq=False)
class Look:
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
        Where in the Laplace plane [1/s].
    gain : float
        Factor of the measured level over the true one [-].
    """

    state: State
    matrices: Matrices
    rows: FloatArray
    states: ComplexArray
    receptance: ComplexArray
    laplace: ComplexArray
    gain: float


def look(predictor: Predictor, state: State, ends: Columns, laplace: ComplexArray) -> Look:
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
        Where in the Laplace plane [1/s].
    """
    matrices, rows, gain = _parts(predictor, state, ends)
    states = answers(matrices, rows.T, laplace)
    receptance = gain * on_each_line(rows, states)[:, ends.response, ends.excitation].T
    return Look(state, matrices, rows, states, receptance, laplace, gain)


def _parts(predictor: Predictor, state: State, ends: Columns) -> tuple[Matrices, FloatArray, float]:
    total = predictor.base.plus(state)
    if total.theory is not None and total.theory != predictor.spec.theory:
        return _parts(predictor.under(total.theory), replace(state, theory=None), ends)
    return predictor.matrices(state), predictor.point_rows(state)[ends.points], total.gain


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
    """

    matrices: Matrices
    rows: FloatArray
    log_gain: float


def changes(
    predictor: Predictor, panel: Panel, values: Sequence[float], ends: Columns, earlier: State
) -> list[Change]:
    """Return what each parameter changes in the model, by central differences of its matrices.

    The matrices are powers and sums, so that these differences are good to rounding; the receptances are then
    differentiated exactly. One way serves every parameter: section, modulus, damping by region (Eqs. 11-13),
    length, effects.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    panel : Panel
        Its parameters.
    values : sequence of float
        Their factors and values.
    ends : Columns
        The points of every FRF.
    earlier : State
        What earlier stages have settled.
    """
    found = []
    for i, knob in enumerate(panel.knobs):
        here, step = knob.coordinate(values[i]), STEP * min(knob.doubt, knob.span() / 4)
        limits = knob.coordinate(knob.low), knob.coordinate(knob.high)
        at = [max(here - step, limits[0]), min(here + step, limits[1])]
        sides = []
        for coordinate in at:
            moved = [*values[:i], knob.value(coordinate), *values[i + 1 :]]
            sides.append(_parts(predictor, earlier.plus(panel.state(predictor, moved)), ends))
        width = at[1] - at[0]
        (low, low_rows, low_gain), (high, high_rows, high_gain) = sides
        names = ("stiffness", "mass", "viscous", "structural")
        matrices = Matrices(*[(getattr(high, n) - getattr(low, n)) / width for n in names])
        found.append(
            Change(matrices, (high_rows - low_rows) / width, float(np.log(high_gain / low_gain) / width))
        )
    return found


def sensitivity(at: Look, change: Change, ends: Columns, excited: ComplexArray | None = None) -> ComplexArray:
    """Return dH / d coordinate of every FRF, shape (n_frf, n_lines) [m/N].

    Parameters
    ----------
    at : Look
        The model.
    change : Change
        What the coordinate changes.
    ends : Columns
        The points of every FRF.
    excited : (n_frf, n_lines, r) complex array, optional
        The structure's own motion under each FRF's excitation in place of the model's: H^X of Eq. 9 where it
        was measured, expanded to all of the basis [m/N].
    """
    s = at.laplace[:, None, None]
    d = change.matrices
    moved = d.stiffness + 1j * d.structural
    states = at.states
    dynamic = s**2 * on_each_line(d.mass, states) + s * on_each_line(d.viscous, states)
    dynamic = (dynamic + on_each_line(moved, states))[:, :, ends.response]
    if excited is None:
        by = -np.einsum("lrf,lrf->fl", dynamic, states[:, :, ends.excitation])
    else:
        by = -np.einsum("lrf,flr->fl", dynamic, excited)
    if np.any(change.rows):
        moving = on_each_line(change.rows, states)
        moving = moving + moving.transpose(0, 2, 1)
        by = by + moving[:, ends.response, ends.excitation].T
    return np.asarray(at.gain * by + change.log_gain * at.receptance)
