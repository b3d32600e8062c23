"""Modes of the full model at a state, against which the reduced one is held at the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.base import added
from updating.models.fields import Sparse
from updating.models.solve import DENSE
from updating.models.state import State
from updating.models.structure import FieldStructure
from updating.models.whole import ReducedOnlyError, size_of
from updating.prediction.predict import Predictor
from updating.prediction.window_left import with_window
from updating.update.parameters.basis import Factor


def full_modes(
    predictor: Predictor, change: Callable[[Predictor], State], count: int
) -> tuple[FloatArray, FloatArray] | None:
    """Solve the full model for its lowest elastic modes.

    Accepted effects and the change are asked for what they do to the full matrices by the same lines as on the
    reduced basis, with all their parameters.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    change : function
        Departure from the nominal model that a predictor is asked for, on top of its additions.
    count : int
        Number of elastic modes.

    Returns
    -------
    frequency : (count,) array
        Frequencies [Hz].
    vectors : (n_dofs, count) array
        Mass-normalised shapes [kg^-1/2].

    None in place of both if an effect is known on the reduced basis alone, or asks for another theory than the
    specimen's.
    """
    state = _on_all(predictor.whole, change)
    if state is None or state.theory not in (None, predictor.spec.theory):
        return None
    structure = predictor.reduced.structure
    stiffness, mass = (Sparse(matrix) for matrix in predictor.whole.reduced.matrices(state))
    first = structure.rigid_modes
    wanted = first + count
    if isinstance(structure, FieldStructure) and not state.released and structure.unknowns > DENSE:
        values, vectors = Factor(structure, stiffness, mass).lowest(wanted)
    else:
        values, vectors = structure.eigen(wanted, stiffness=stiffness, mass=mass, released=state.released)
    shift = 1.0 + state.slope * (predictor.measured.level or 0.0)
    frequency = (
        shift
        * predictor.slowing(change(predictor), count)
        * np.sqrt(np.maximum(values[first:], 0.0))
        / (2 * np.pi)
    )
    if state.decay:  # a window moves poles beside their damping, that of the reduced model
        without = replace(change(predictor), decay=-predictor.base.decay)
        frequency, _ = with_window(frequency, predictor.predict(without, count=count).damping, state.decay)
    return np.asarray(frequency), vectors[:, first:]


def _on_all(whole: Predictor, change: Callable[[Predictor], State]) -> State | None:
    """Return the state on all degrees of freedom; None if some part of it cannot be stated on them.

    An effect of a user's own may be written for dense matrices alone; an absorber has a degree of freedom of its own.
    """
    try:
        state = whole.base.plus(change(whole))
    except (ReducedOnlyError, TypeError, ValueError, AttributeError):
        return None
    if state.absorbers:
        return None
    size = (whole.reduced.structure.n_dofs,) * 2
    more = added(whole.reduced.structure, state)
    return state if all(size_of(m) == size for m in (*more["stiffness"], *more["mass"])) else None
