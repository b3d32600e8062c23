"""FRFs of a simulated model in any form, between any of its points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from scipy import linalg

from acquisition import FORMS, Dof, FrfSet
from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.errors import StudyError
from acquisition.form import Form
from updating.models.response import receptance
from updating.simulation.model import Simulated
from updating.simulation.poles import damped_modes, modal_damping, uncoupled

Method = Literal["auto", "direct", "modal"]

NEXT_TO_ZERO = 1e-3
"""Where the line at 0 Hz of a free structure is evaluated, of the distance between lines [-]."""


def receptances(
    model: Simulated,
    laplace: ComplexArray,
    *,
    seen: IntArray,
    hit: IntArray,
    method: Method = "auto",
    count: int | None = None,
) -> ComplexArray:
    """Return receptances, shape (n_frf, n_lines) [m/N].

    Parameters
    ----------
    model : Simulated
        The model.
    laplace : (n_lines,) complex array
        Where in the Laplace plane, i omega + the decay of a known window [1/s].
    seen, hit : (n_frf,) int arrays
        Row of the point of the response and of the force.
    method : {"auto", "direct", "modal"}
        Solve Z(s) on every line, or sum modes (complex ones where damping couples them); left to itself, direct where
        lines are fewer than the unknowns of the basis. Where loss factors differ by region every line is solved.
    count : int, optional
        Elastic modes in the sum, from the lowest; the others answer by their stiffness, damping and inertia, up to
        s^2. Left out, all modes of the basis.

    Raises
    ------
    StudyError
        If a sum over modes is asked of a free structure whose damping couples its modes.
    """
    s = laplace + model.decay
    left, right = model.rows[seen], model.rows[hit]
    if method == "auto" and count is None and (len(s) <= len(model.matrices.mass) or model.rigid):
        method = "direct"
    if _hysteretic(model):
        method = "direct"
    if method == "direct":
        return np.asarray(model.gain * receptance(model.matrices, left, right, s))
    return np.asarray(model.gain * _sum_of_modes(model, left, right, s, count))


def _hysteretic(model: Simulated) -> bool:
    """Whether structural damping couples the modes: no sum of conjugate poles is then the FRF."""
    _, vectors = model.matrices.undamped
    return not uncoupled(vectors.T @ model.matrices.structural @ vectors)


def _sum_of_modes(
    model: Simulated, left: FloatArray, right: FloatArray, s: ComplexArray, count: int | None
) -> ComplexArray:
    values, vectors = linalg.eigh(model.matrices.stiffness, model.matrices.mass)
    viscous, structural = modal_damping(model.matrices, vectors)
    kept = len(values) if count is None else model.rigid + count
    if not (uncoupled(viscous) and uncoupled(structural)):
        if model.rigid:
            raise StudyError(
                'the damping couples the modes of a free structure; use method="direct" or hang it'
            )
        modes = damped_modes(model)
        return _sum_of_poles(modes.poles, (left @ modes.vectors) * (right @ modes.vectors), s, kept)
    products, c = (left @ vectors) * (right @ vectors), np.diag(viscous)
    k = np.where(np.arange(len(values)) < model.rigid, 0.0, values) + 1j * np.diag(structural)
    low = products[:, :kept] @ (1 / (s**2 + c[:kept, None] * s + k[:kept, None]))
    k, c = k[kept:], c[kept:]
    expanded = np.stack([1 / k, -c / k**2, (c**2 / k - 1) / k**2])
    return np.asarray(low + products[:, kept:] @ (expanded.T @ np.stack([s**0, s, s**2])))


def _sum_of_poles(poles: ComplexArray, residues: ComplexArray, s: ComplexArray, kept: int) -> ComplexArray:
    """Sum R / (s - p) + conj R / (s - conj p); those beyond ``kept`` as -R/p - R s/p^2 - R s^2/p^3."""
    p, r = poles[:kept, None], residues[:, :kept]
    low = r @ (1 / (s - p)) + r.conj() @ (1 / (s - p.conj()))
    p, r = poles[kept:], residues[:, kept:]
    expanded = np.stack([2 * (-r / p ** (n + 1)).sum(axis=1).real for n in range(3)], axis=1)
    return np.asarray(low + expanded @ np.stack([s**0, s, s**2]))


def frf_set(
    model: Simulated,
    frequency: FloatArray,
    *,
    seen: IntArray,
    hit: IntArray,
    form: Form = "accelerance",
    decay: float = 0.0,
    dofs: Sequence[Dof] | None = None,
    method: Method = "auto",
    count: int | None = None,
) -> FrfSet:
    """Return FRFs as a set like a measured one.

    Parameters
    ----------
    model : Simulated
        The model.
    frequency : (n_lines,) array
        Evenly spaced lines [Hz].
    seen, hit : (n_frf,) int arrays
        Row of the point of the response and of the force.
    form : {"receptance", "mobility", "accelerance"}
        Displacement, velocity or acceleration per force.
    decay : float
        Decay rate of an exponential window that the set is to carry [1/s].
    dofs : sequence of Dof, optional
        Degree of freedom of every point, as the model's rows point; left out, +Z of nodes from 1.
    method, count
        As in :func:`receptances`.

    Returns
    -------
    FrfSet
        The line at 0 Hz of a free structure is the value next to it.
    """
    lines = np.asarray(frequency, dtype=float)
    moved = lines
    if model.rigid and decay + model.decay == 0 and len(lines) > 1:
        moved = np.where(lines == 0, NEXT_TO_ZERO * (lines[1] - lines[0]), lines)
    s = 2j * np.pi * moved + decay
    values = receptances(model, s, seen=seen, hit=hit, method=method, count=count)
    names = [Dof(i + 1, 3) for i in range(len(model.rows))] if dofs is None else list(dofs)
    return FrfSet(
        lines,
        values * (s + model.decay) ** FORMS.index(form),
        tuple(names[i] for i in seen),
        tuple(names[i] for i in hit),
        form,
        decay=decay,
        source="simulation",
    )
