"""What damps the modes of a state: what is expected of the specimen, what the state adds, and what couples modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray, IntArray
from updating.models.absorbers import swinging_mass
from updating.models.damped_modes import Damped, damped, modes_taking_part, turns_modes
from updating.models.damping import (
    Matrices,
    coupled,
    damping_matrices,
    layer_slowing,
    modal_damping,
    modal_losses,
)
from updating.models.reduced import Reduced
from updating.models.spec import Damping, Spec
from updating.models.state import State


def expects_damping(spec: Spec, state: State) -> bool:
    """Whether model, regions or the state say what damping to expect."""
    own = any(v is not None for r in spec.regions for v in (r.alpha, r.beta, r.loss_factor))
    stated = bool(state.damping) or bool(state.dampers) or state.ratios is not None
    return spec.damping.known or own or stated


@dataclass(frozen=True, eq=False)
class Dampers:
    """What damps the modes of any state of a model.

    Parameters
    ----------
    reduced : Reduced
        The model on its reduced basis.
    spec : Spec
        What it was made of, with the damping that is expected.
    """

    reduced: Reduced
    spec: Spec

    def coupled_modes(
        self, state: State, values: FloatArray, vectors: FloatArray, chosen: IntArray
    ) -> Damped | None:
        """Return the modes that dashpots of absorbers, or other dampers, couple; None where they hardly do."""
        first = self.reduced.structure.rigid_modes
        size = modes_taking_part(values[first:], len(chosen))
        near = slice(first, first + size)
        dashpots = any(one.damping for one in state.absorbers)
        if np.isnan(values).any() or not (dashpots or turns_modes(state, values[near], vectors[:, near])):
            return None
        elastic = values[first:]
        modes, omega = vectors[:, near], np.sqrt(np.maximum(elastic[:size], 1e-12))
        viscous, hysteretic = (modes.T @ matrix @ modes for matrix in self._matrices(state))
        rates = 2 * self._given_ratios(state, modes) * omega + modal_losses(state, elastic[:size], modes)
        viscous = viscous + hysteretic / np.sqrt(np.outer(omega, omega)) + np.diag(rates)
        found = damped(elastic, viscous, len(chosen))
        return (
            found if expects_damping(self.spec, state) else replace(found, ratio=np.full(len(chosen), np.nan))
        )

    def slowed(
        self, state: State, values: FloatArray, vectors: FloatArray, chosen: IntArray, damped: Damped | None
    ) -> FloatArray:
        """Return the factors on frequencies where dampers couple modes, those solved for with their damping in it."""
        if damped is None:
            return coupled(state, values, vectors, chosen)
        first = self.reduced.structure.rigid_modes
        solved = slice(first, first + damped.taking_part)
        return np.asarray(damped.slowing * coupled(state, values, vectors, chosen, solved))

    def ratios(self, state: State, values: FloatArray, vectors: FloatArray) -> FloatArray:
        """Return modal damping ratios: what is expected of the specimen, plus what the state adds."""
        omega = np.sqrt(np.maximum(values, 1e-12))
        if not expects_damping(self.spec, state):
            return np.asarray(np.full(len(values), np.nan))
        expected = Damping() if state.damping else self.spec.damping
        c, d = modal_damping(self.reduced, expected, state, values, vectors)
        slow = layer_slowing(state, values, vectors)
        rate = c + modal_losses(state, values, vectors)
        added = d / (2 * omega**2) + self._given_ratios(state, vectors)
        return np.asarray(slow * rate / (2 * omega) + added)

    def _matrices(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Return C and D; damping matrices in the state replace what the model expects."""
        expected = Damping() if state.damping else self.spec.damping
        return damping_matrices(self.reduced, expected, state)

    def _given_ratios(self, state: State, vectors: FloatArray) -> FloatArray:
        """Return the damping ratios that state or modeller give mode by mode, the last for all above, (n_modes,) [-].

        They are those of the structure: of the lowest elastic modes (r, n_modes) each has its share in modal mass, and
        its rank by the shares below it.
        """
        given = self._given(state)
        if given is None:
            return np.zeros(vectors.shape[1])
        share = 1 - swinging_mass(vectors, state.absorbers)
        rank = np.round(np.cumsum(share) - share).astype(int)
        return np.asarray(np.asarray(given)[np.clip(rank, 0, len(given) - 1)] * share, dtype=float)

    def _given(self, state: State) -> tuple[float, ...] | None:
        if state.ratios is not None:
            return state.ratios
        return None if state.damping else self.spec.damping.ratios or None

    def matrices(self, total: State) -> Matrices:
        """Return K, M, C and D of a state; modal ratios enter C through the state's own modes.

        Parameters
        ----------
        total : State
            Its whole departure from the nominal model.
        """
        stiffness, mass = self.reduced.matrices(total)
        viscous, structural = self._matrices(total)
        modal = any(loss.power not in (0.0, -1.0) for loss in total.losses)
        if self._given(total) is not None or modal:
            values, vectors = linalg.eigh(stiffness, mass)
            first = self.reduced.structure.rigid_modes
            rates = np.zeros(len(values))
            omega = np.sqrt(np.maximum(values[first:], 0))
            rates[first:] = 2 * self._given_ratios(total, vectors[:, first:]) * omega
            rates[first:] += modal_losses(total, values[first:], vectors[:, first:])
            momenta = mass @ vectors
            slowing = np.ones(len(values))
            slowing[first:] = layer_slowing(total, values[first:], vectors[:, first:])
            mass = mass + (momenta * (slowing**-2 - 1)) @ momenta.T
            viscous = viscous + (momenta * rates) @ momenta.T
        return Matrices(stiffness, mass, viscous, structural, self.reduced.structure.rigid_modes)
