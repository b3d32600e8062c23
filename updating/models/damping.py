"""Damping matrices of a state on the reduced basis: proportional by region, structural by region, added by effects.

Paper B, Eqs. 1 and 3: C = sum_k alpha_k M_k + beta_k K_k over the regions; a structural loss factor eta_k adds
the hysteretic part i eta_k K_k. A region's own coefficient takes the place of the model's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray, IntArray
from updating.models.absorbers import bordered, energies, own_flexibility, padded, structural
from updating.models.base import region_scales, supports_at
from updating.models.reduced import Reduced
from updating.models.spec import Damping
from updating.models.state import State

COEFFICIENTS = ("alpha", "beta", "loss_factor")
"""Damping proportional to mass [1/s], to stiffness [s], and structural [-]."""

ROUNDING = 1e-4
"""Eigenvalues of a free body under this share of its first elastic one are rounding [-]."""

NONE = slice(0, 0)
"""No mode."""

VISCOUS, STRUCTURAL = 0.0, -1.0
"""Powers of the frequency in the losses that are constant matrices."""

WHOLE = -1
"""The region number that stands for the whole structure."""


@dataclass(frozen=True, eq=False)
class Matrices:
    """Everything in Z(s) = s^2 M + s C + K + i D on a reduced basis.

    Parameters
    ----------
    stiffness, mass : (r, r) arrays
        K and M [SI].
    viscous : (r, r) array
        C [SI].
    structural : (r, r) array
        D, stiffness times loss factor; zero for viscous damping alone [SI].
    rigid : int
        Number of rigid-body modes, whose stiffness is rounding and is taken as none.
    """

    stiffness: FloatArray
    mass: FloatArray
    viscous: FloatArray
    structural: FloatArray
    rigid: int = 0

    @cached_property
    def undamped(self) -> tuple[FloatArray, FloatArray]:
        """Eigenvalues [rad^2/s^2] and mass-normalised vectors of K and M; what is rounding is 0 of a rigid body."""
        values, vectors = linalg.eigh(self.stiffness, self.mass)
        if self.rigid:
            rounding = values[: self.rigid] < ROUNDING * values[min(self.rigid, len(values) - 1)]
            values[: self.rigid][rounding] = 0.0
        return values, vectors

    @cached_property
    def in_modes(self) -> tuple[FloatArray, FloatArray]:
        """C and D in the undamped modes, (r, r) each [1/s], [1/s^2]."""
        vectors = self.undamped[1]
        return vectors.T @ self.viscous @ vectors, vectors.T @ self.structural @ vectors


def coefficients(reduced: Reduced, damping: Damping, state: State) -> dict[str, FloatArray]:
    """Return alpha, beta and loss factor of every region and of what lies in none.

    Parameters
    ----------
    reduced : Reduced
        The model, whose regions may have coefficients of their own.
    damping : Damping
        The model's coefficients.
    state : State
        Its ``dampers`` take the place of both, its ``damping`` that of the regions' own, and its ``ratios`` that of
        all coefficients.

    Returns
    -------
    dict of str to (n_regions + 1,) array
        Coefficients [1/s, s, -]; the last is that of the structure outside all regions.
    """
    regions = reduced.structure.spec.regions
    found: dict[str, FloatArray] = {}
    for name in COEFFICIENTS:
        if state.ratios is not None:
            found[name] = np.zeros(len(regions) + 1)
            continue
        given = state.dampers.get((WHOLE, name), getattr(damping, name))
        general = 0.0 if given is None else float(given)
        values = np.full(len(regions) + 1, general)
        for i, region in enumerate(regions):
            stated = None if state.damping else getattr(region, name)  # a baseline has measured that too
            own = state.dampers.get((i, name), stated)
            values[i] = general if own is None else float(own)
        found[name] = values
    return found


def damping_matrices(reduced: Reduced, damping: Damping, state: State) -> tuple[FloatArray, FloatArray]:
    """Return the viscous and the structural damping of a state on the columns that its releases admit.

    Masses that the modeller stated take part with the model's alpha; springs and masses that effects add are
    not damped by the coefficients.

    Parameters
    ----------
    reduced : Reduced
        The model.
    damping : Damping
        The model's coefficients; its ``ratios`` are modal and no matrix.
    state : State
        Factors, dampers, added damping, and those losses that are constant matrices; see :func:`modal_losses`.

    Returns
    -------
    viscous, structural : (r, r) arrays
        C and D of Z(s) = s^2 M + s C + K + i D, absorbers behind the structure [SI].
    """
    own = coefficients(reduced, damping, state)
    n = reduced.ranks[state.released]
    viscous, hysteretic = np.zeros((n, n)), np.zeros((n, n))
    if _known(own):
        if _uniform(own):
            stiffness, mass = reduced.matrices(replace(state, stiffness=(), mass=(), absorbers=()))
            for support in supports_at(reduced.structure, state):
                stiffness -= support.springs[:n, :n]
            viscous += own["alpha"][0] * mass + own["beta"][0] * stiffness
            hysteretic += own["loss_factor"][0] * stiffness
        else:
            stiff, heavy = region_matrices(reduced, state)
            viscous += np.tensordot(own["alpha"], heavy, axes=1) + np.tensordot(own["beta"], stiff, axes=1)
            viscous += own["alpha"][-1] * reduced.point_masses[:n, :n]
            hysteretic += np.tensordot(own["loss_factor"], stiff, axes=1)
    for added in _viscous(state):
        viscous += added[:n, :n]
    for added in _structural(state):
        hysteretic += added[:n, :n]
    if state.absorbers:
        viscous = bordered(viscous, state.absorbers, "damping")
        hysteretic = padded(padded(hysteretic, state.absorbers).T, state.absorbers).T
        attached = own_flexibility(n, state.absorbers)  # damped as the structure is, whose regions make it up
        viscous = viscous + np.mean(own["beta"]) * attached
        hysteretic = hysteretic + np.mean(own["loss_factor"]) * attached
    return viscous, hysteretic


def modal_damping(
    reduced: Reduced, damping: Damping, state: State, values: FloatArray, vectors: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what modes make of :func:`damping_matrices`: phi^T C phi and phi^T D phi.

    Where coefficients are the same all over, phi^T M phi = 1 and phi^T K phi = lambda give them without the matrices:
    only what effects add, which the coefficients do not damp, comes off.

    Parameters
    ----------
    reduced, damping, state
        As of :func:`damping_matrices`.
    values : (n_modes,) array
        Eigenvalues of the state [rad^2/s^2].
    vectors : (r, n_modes) array
        Its mass-normalised modes, absorbers behind the structure.

    Returns
    -------
    viscous, structural : (n_modes,) arrays [1/s, 1/s^2]
    """
    own = coefficients(reduced, damping, state)
    if not _uniform(own):
        matrices = damping_matrices(reduced, damping, state)
        viscous, hysteretic = (np.sum(vectors * (matrix @ vectors), axis=0) for matrix in matrices)
        return viscous, hysteretic
    hung, moving = energies(vectors, state.absorbers), structural(vectors, state.absorbers)
    heavy = 1.0 - _share(state.mass, moving) - hung["mass"]
    viscous = own["alpha"][0] * heavy + _share(_viscous(state), moving) + hung["damping"]
    hysteretic = _share(_structural(state), moving)
    if own["beta"][0] or own["loss_factor"][0]:
        springs = [one.springs for one in supports_at(reduced.structure, state)]
        elastic = values - _share([*state.stiffness, *springs], moving) - hung["stiffness"]
        viscous, hysteretic = viscous + own["beta"][0] * elastic, hysteretic + own["loss_factor"][0] * elastic
    return viscous, hysteretic


def _known(own: Mapping[str, FloatArray]) -> bool:
    """Return whether any coefficient damps."""
    return any(np.any(values) for values in own.values())


def _uniform(own: Mapping[str, FloatArray]) -> bool:
    """Return whether every coefficient is the same all over."""
    return all(np.ptp(values) == 0 for values in own.values())


def _viscous(state: State) -> list[FloatArray]:
    """Return the damping that effects add, as far as it is viscous."""
    return [*state.damping, *(loss.matrix for loss in state.losses if loss.power == VISCOUS)]


def _structural(state: State) -> list[FloatArray]:
    """Return the damping that effects add, as far as it is structural."""
    return [loss.matrix for loss in state.losses if loss.power == STRUCTURAL]


def _share(matrices: Sequence[FloatArray], vectors: FloatArray) -> FloatArray:
    """Return phi^T A phi of every mode, summed over some matrices [SI]."""
    n, total = len(vectors), np.zeros(vectors.shape[1])
    for matrix in matrices:
        total = total + np.sum(vectors * (matrix[:n, :n] @ vectors), axis=0)
    return total


def modal_losses(state: State, values: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return the decay rates 2 zeta omega of a state's losses that are no constant matrix.

    Parameters
    ----------
    state : State
        Its losses.
    values : (n_modes,) array
        Eigenvalues [rad^2/s^2].
    vectors : (r, n_modes) array
        Mass-normalised modes, absorbers behind the structure.

    Returns
    -------
    (n_modes,) array [1/s]
    """
    vectors = structural(vectors, state.absorbers)
    n = len(vectors)
    omega = np.sqrt(np.maximum(values, 0.0))
    total = np.zeros(len(values))
    for loss in state.losses:
        if loss.power not in (VISCOUS, STRUCTURAL):
            own = np.sum(vectors * (loss.matrix[:n, :n] @ vectors), axis=0)
            total += np.where(omega > 0, np.maximum(omega, 1e-12) ** loss.power, 0.0) * own
    return total


def layer_slowing(state: State, values: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return the factors that viscous boundary layers make on frequencies by the fluid that they carry along.

    The drag of Stokes' layer on a plane that oscillates leads the velocity by 45 degrees (Landau and Lifshitz, Fluid
    Mechanics, section 24): a mode that it damps at the rate c carries the modal mass c / omega along, so that its own
    becomes the square of the inverse of this factor.

    Parameters
    ----------
    state, values, vectors
        As of :func:`modal_losses`.

    Returns
    -------
    (n_modes,) array [-]
    """
    if not state.losses:
        return np.ones(len(values))
    omega = np.sqrt(np.maximum(values, 1e-12))
    return np.asarray(1 / np.sqrt(1.0 + modal_losses(state, values, vectors) / omega))


def coupled(
    state: State, values: FloatArray, vectors: FloatArray, chosen: IntArray, solved: slice = NONE
) -> FloatArray:
    """Return the factors on frequencies where dampers of effects couple the modes, to second order in the dampers.

    Eliminating all modes but r from s^2 + s C + diag(omega^2) near s = i omega_r leaves |s|^2 = omega_r^2 (1 + sum of
    C_kr^2 / (omega_k^2 - omega_r^2)); to first order nothing changes (Rayleigh, Theory of Sound, section 102). Modes
    nearer to each other than their coupling differ in damping and keep their frequency, so that the sum is bounded.

    Parameters
    ----------
    state, values, vectors
        As of :func:`modal_losses`, of all modes of the basis.
    chosen : (n_modes,) array
        Modes that are asked for.
    solved : slice
        Modes whose coupling is solved for elsewhere; the others' alone counts.

    Returns
    -------
    (n_modes,) array [-]
    """
    dampers = [loss.matrix for loss in state.losses if loss.power == VISCOUS]
    if not dampers:
        return np.ones(len(chosen))
    vectors = structural(vectors, state.absorbers)
    n = len(vectors)
    squares = (vectors.T @ (sum(damper[:n, :n] for damper in dampers) @ vectors[:, chosen])) ** 2
    squares[solved] = 0.0
    gap = values[:, None] - values[chosen]
    near = np.abs(values[chosen]) * squares
    far = np.maximum(gap**2 + near, 1e-300)
    shift = 0.5 * np.sum(squares * gap / far, axis=0)
    return np.asarray(np.exp(np.clip(shift, -50.0, 50.0)))  # beyond any frequency: finite, and fits nothing


def region_matrices(reduced: Reduced, state: State) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of every region under a state's factors, each (n_regions + 1, r, r) [SI].

    The K_i and M_i of paper A, Eqs. 11-14; the last is what lies in no region, and no point mass is in them. Where a
    support gives way, each region has its share of what that takes off, without the springs.
    """
    n = reduced.ranks[state.released]
    count = len(reduced.parts[0])
    total = {"stiffness": np.zeros((count, n, n)), "mass": np.zeros((count, n, n))}
    for term, parts in zip(reduced.structure.terms, reduced.parts, strict=True):
        total[term.kind] += region_scales(term, state, count - 1)[:, None, None] * parts[:, :n, :n]
    for one in supports_at(reduced.structure, state):
        total["stiffness"] += one.held_by[:, None, None] * one.strained
        total["mass"] += one.carried_by[:, None, None] * one.carried
    return total["stiffness"], total["mass"]
