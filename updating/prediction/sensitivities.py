"""Sensitivities of natural frequencies and mode shapes to the factors of a model.

Eigenvalue sensitivities are paper A's Eqs. 16 and 17; eigenvector sensitivities are the modal expansion over
all modes of the reduced basis (Fox and Kapoor 1968).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.base import supports_at
from updating.models.named_factors import carried_masses, regions_of
from updating.models.reduced import Reduced
from updating.models.spec import Spec
from updating.models.state import NOMINAL, State
from updating.prediction.bodies import BodyChange

LARGEST_TURN = 1e3
"""Largest derivative of a shape by the logarithm of a factor along another shape [-]: a whole mode at a thousandth of
it, less than any tolerance. Doubled: columns of modes that lie closer than a part in a thousand grow as much."""


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Derivatives of the modes of any state of a model by some factors.

    Parameters
    ----------
    reduced : Reduced
        The model on its reduced basis.
    spec : Spec
        What it was made of.
    names : tuple of str
        Factors, those of regions as ``web.E``, and what bodies change.
    bodies : mapping of str to BodyChange
        What each doubt in a stated body changes.
    """

    reduced: Reduced
    spec: Spec
    names: tuple[str, ...]
    bodies: Mapping[str, BodyChange]

    def of(
        self, state: State, eigen: tuple[FloatArray, FloatArray], chosen: IntArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return derivatives of ln f, and of shapes along all shapes of the basis, by the logarithms of factors.

        Parameters
        ----------
        state : State
            Its whole departure from the nominal model.
        eigen : pair of arrays (r,) and (r, r)
            All eigenvalues [rad^2/s^2] and mode shapes [kg^-1/2] of that state.
        chosen : (n_modes,) int array
            The modes asked for.

        Returns
        -------
        log_frequency : (n_factors, n_modes) array
            Derivatives of ln f [-], and by bodies' places [1/m].
        shape : (n_factors, r, n_modes) array
            Derivatives of each mode shape, in shapes of all modes, by the same.
        """
        values, vectors = eigen
        modes, lam = vectors[:, chosen], values[chosen]
        n, own = len(vectors), np.arange(len(chosen))
        stack = self.reduced.stacked(state)
        heavy, sized = stack.heavy, stack.scales(state.factors)
        forces = stack.matrices @ modes
        forces *= np.where(heavy[:, None], -sized[:, None] * lam, sized[:, None])[:, None]
        whole = vectors.T @ np.tensordot(self._powers, forces, axes=1)
        parts = np.einsum("im,tim->tm", modes, forces[heavy])
        heavier = -self._powers[:, heavy] @ parts / np.where(lam == 0, 1.0, lam)
        masses = {**{name: one.mass for name, one in self.bodies.items()}, **self._carried(state)}
        for k, (name, (regions, factor)) in enumerate(zip(self.names, self._regions, strict=True)):
            if name in masses:
                mass = masses[name][:n, :n]
                whole[k] = -vectors.T @ (mass @ modes * lam)
                heavier[k] = np.sum(modes * (mass @ modes), axis=0)
            elif name not in self._supports and (regions or state.yielding):
                stiffness, mass = self.reduced.sensitivity(state, factor, regions)
                whole[k] = vectors.T @ (stiffness @ modes - mass @ modes * lam)
                heavier[k] = np.sum(modes * (mass @ modes), axis=0)
        gap = lam - values[:, None]
        near = np.abs(gap) < 1e-9 * np.abs(lam).max()
        gap[near] = np.inf
        # past a quarter of a turn no shape is another one's, and of modes that are all but double nothing is linear
        weights = np.clip(whole / gap, -LARGEST_TURN, LARGEST_TURN)
        weights[:, chosen, own] = -0.5 * heavier
        return np.asarray(whole[:, chosen, own] / (2 * np.maximum(lam, 1e-12))), np.asarray(weights)

    def _carried(self, state: State) -> dict[str, FloatArray]:
        """Return the mass that each support carries along as it gives way, as it is estimated, (r, r) [kg in w]."""
        plain = supports_at(self.reduced.structure, replace(state, carried={}))
        known = dict(zip(state.yielding, plain, strict=True))
        return {name: known[one].carried for name, one in self._supports.items() if one in known}

    @cached_property
    def _supports(self) -> dict[str, str]:
        """The supports of imported matrices, by the name of the doubt in what each carries along."""
        return carried_masses(self.spec)

    @cached_property
    def _powers(self) -> FloatArray:
        """Power of every term in every factor, (n_factors, n_terms) [-]."""
        terms = self.reduced.stacked(NOMINAL).terms
        return np.array([[term.powers.get(name, 0.0) for term in terms] for name in self.names])

    @cached_property
    def _regions(self) -> list[tuple[tuple[int, ...], str]]:
        """Regions and property of every factor."""
        return [regions_of(self.spec, name) for name in self.names]
