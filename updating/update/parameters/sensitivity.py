"""Sensitivities of eigenvalues, paper A Eqs. 16 and 17, for factors of the whole model and of its regions."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.reduced import Reduced
from updating.models.state import State
from updating.prediction.prediction import Prediction


def log_frequency_by(
    reduced: Reduced, state: State, prediction: Prediction, factor: str, regions: tuple[int, ...] = ()
) -> FloatArray:
    """Return d ln f / d ln factor of the modes of a prediction, shape (n_modes,) [-].

    d lambda = phi^T dK phi - lambda phi^T dM phi with mass-normalised phi (Eqs. 16, 17), and
    d ln f = d lambda / (2 lambda).

    Parameters
    ----------
    reduced : Reduced
        The model.
    state : State
        Where the prediction was made, everything included.
    prediction : Prediction
        The modes.
    factor : str
        E, density, thickness, width or length.
    regions : tuple of int
        Regions on which the factor acts; empty is the whole structure.
    """
    stiffness, mass = reduced.sensitivity(state, factor, regions)
    n = len(stiffness)
    vectors = prediction.vectors[:n]
    k = np.einsum("ir,ij,jr->r", vectors, stiffness, vectors)
    m = np.einsum("ir,ij,jr->r", vectors, mass, vectors)
    eigenvalue = (2 * np.pi * prediction.frequency) ** 2
    return np.asarray((k / eigenvalue - m) / 2)
