"""Motion under a given force, exact for a force that runs straight from sample to sample."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from acquisition import FORMS
from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.errors import InputError
from acquisition.form import Form
from updating.simulation.model import Simulated
from updating.simulation.poles import damped_modes


def time_response(
    model: Simulated,
    force: FloatArray,
    rate: float,
    *,
    hit: IntArray,
    seen: IntArray,
    form: Form = "accelerance",
) -> FloatArray:
    """Return the motion under sampled forces, from rest at the first sample.

    Every complex mode moves by z' = p z + psi^T f, whose transition from sample to sample is known in closed form
    where f is linear between them (first-order hold; Franklin, Powell and Workman, Digital Control, 1998, sec. 6.3).
    Where structural damping is in the model, this is the motion of the system of its poles and residues. Gain and
    window of the model belong to the measurement; they are not in the motion.

    Parameters
    ----------
    model : Simulated
        A clamped or hung structure.
    force : (n_forces, n_samples) array
        Forces [N].
    rate : float
        Sampling rate [Hz].
    hit : (n_forces,) int array
        Rows of the points that the forces act on, along the points' directions.
    seen : (n_seen,) int array
        Rows of the points to look at.
    form : {"receptance", "mobility", "accelerance"}
        Whether displacement, velocity or acceleration is returned.

    Returns
    -------
    (n_seen, n_samples) array [m, m/s or m/s^2]

    Raises
    ------
    InputError
        If the forces are not one record for each point, or have fewer than two samples.
    StudyError
        If the structure is free to drift away.
    """
    force = np.asarray(force, dtype=float)
    if force.ndim != 2 or len(force) != len(hit) or force.shape[1] < 2 or not rate > 0:
        raise InputError(
            f"forces of shape {force.shape} at {rate} Hz for {len(hit)} points: give (n_forces, n_samples)"
        )
    modes = damped_modes(model)
    pushes = (model.rows[hit] @ modes.vectors).T @ force
    states = _states(modes.poles, pushes, 1 / rate)
    shapes = model.rows[seen] @ modes.vectors
    order = FORMS.index(form)
    moved = shapes * modes.poles**order @ states
    # d/dt of z is p z + push: what jumps with the force and its slope
    for n in range(order):
        rest = np.gradient(pushes, 1 / rate, axis=1) if order - 1 - n else pushes
        moved = moved + (shapes * modes.poles**n) @ rest
    return np.asarray(2 * moved.real)


def _states(poles: ComplexArray, pushes: ComplexArray, step: float) -> ComplexArray:
    """Return every mode's z at the samples, (n_modes, n_samples), z = 0 at the first."""
    end = np.exp(poles * step)
    late = _late(poles * step) * step
    early = _whole(poles * step) * step - late
    states = np.empty_like(pushes)
    for i, (e, a, b) in enumerate(zip(end, early, late, strict=True)):
        states[i] = lfilter([b, a], [1.0, -e], pushes[i], zi=[-b * pushes[i, 0]])[0]
    return states


SHORT = 0.05
"""Steps below which the weights come from their series, as a phase [rad]."""


def _whole(x: ComplexArray) -> ComplexArray:
    """Return (exp(x) - 1) / x."""
    small = 1 + x / 2 * (1 + x / 3 * (1 + x / 4 * (1 + x / 5 * (1 + x / 6 * (1 + x / 7)))))
    safe = np.where(np.abs(x) < SHORT, 1.0, x)
    return np.asarray(np.where(np.abs(x) < SHORT, small, (np.exp(safe) - 1) / safe))


def _late(x: ComplexArray) -> ComplexArray:
    """Return (exp(x) - 1 - x) / x^2, the share of the later end of a step."""
    small = (1 + x / 3 * (1 + x / 4 * (1 + x / 5 * (1 + x / 6 * (1 + x / 7 * (1 + x / 8)))))) / 2
    safe = np.where(np.abs(x) < SHORT, 1.0, x)
    return np.asarray(np.where(np.abs(x) < SHORT, small, (np.exp(safe) - 1 - safe) / safe**2))
