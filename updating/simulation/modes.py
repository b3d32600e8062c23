"""Natural frequencies, damping ratios and shapes of a simulated model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray
from updating.prediction.window_left import with_window
from updating.simulation.model import Simulated
from updating.simulation.poles import modal_damping


@dataclass(frozen=True, eq=False)
class NaturalModes:
    """The lowest elastic modes of a model.

    Parameters
    ----------
    frequency : (n_modes,) array
        Undamped natural frequencies, moved by an unknown window [Hz].
    damping : (n_modes,) array
        Damping ratios, that of an unknown window included [-].
    shapes : (n_points, n_modes) array
        Mass-normalised real shapes at the points [kg^-1/2].
    """

    frequency: FloatArray
    damping: FloatArray
    shapes: FloatArray


def natural_modes(model: Simulated, *, count: int | None = None) -> NaturalModes:
    """Solve for natural frequencies and shapes.

    Damping ratios are those of the diagonal of the damping in the undamped modes: exact where it does not couple
    them, of first order where it does; :func:`damped_modes` has the exact poles.

    Parameters
    ----------
    model : Simulated
        The model.
    count : int, optional
        How many of the elastic modes; left out, all of the basis.
    """
    values, vectors = linalg.eigh(model.matrices.stiffness, model.matrices.mass)
    last = len(values) if count is None else model.rigid + count
    values, vectors = values[model.rigid : last], vectors[:, model.rigid : last]
    viscous, structural = (np.diag(d) for d in modal_damping(model.matrices, vectors))
    omega = np.sqrt(np.where(values > 0, values, np.nan))
    ratios = viscous / (2 * omega) + structural / (2 * omega**2)
    return NaturalModes(*with_window(omega / (2 * np.pi), ratios, model.decay), model.rows @ vectors)
