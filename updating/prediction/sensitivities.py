"""Sensitivities of natural frequencies and mode shapes to the factors of a model.

Eigenvalue sensitivities are paper A's Eqs. 16 and 17; eigenvector sensitivities are the modal expansion over
all modes of the reduced basis (Fox and Kapoor 1968).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.named_factors import regions_of
from updating.models.reduced import Reduced
from updating.models.spec import Spec
from updating.models.state import State
from updating.prediction.bodies import BodyChange

LARGEST_TURN = 1e3
"""Largest derivative of a shape by the logarithm of a factor along another shape [-]: a whole mode at a thousandth of
it, less than any tolerance. Doubled: columns of modes that lie closer than a part in a thousand grow as much."""


def sensitivities(
    reduced: Reduced,
    spec: Spec,
    state: State,
    eigen: tuple[FloatArray, FloatArray],
    chosen: IntArray,
    names: Sequence[str],
    bodies: Mapping[str, BodyChange],
) -> tuple[FloatArray, FloatArray]:
    """Return derivatives of ln f, and of shapes along all shapes of the basis, by the logarithms of factors.

    Parameters
    ----------
    reduced : Reduced
        The model on its reduced basis.
    spec : Spec
        What it was made of.
    state : State
        Its whole departure from the nominal model.
    eigen : pair of arrays (r,) and (r, r)
        All eigenvalues [rad^2/s^2] and mode shapes [kg^-1/2] of that state.
    chosen : (n_modes,) int array
        The modes asked for.
    names : sequence of str
        Factors, those of regions as ``web.E``, and what bodies change.
    bodies : mapping of str to BodyChange
        What each doubt in a stated body changes.

    Returns
    -------
    log_frequency : (n_factors, n_modes) array
        Derivatives of ln f [-], and by bodies' places [1/m].
    shape : (n_factors, r, n_modes) array
        Derivatives of each mode shape, in shapes of all modes, by the same.
    """
    values, vectors = eigen
    modes, lam = vectors[:, chosen], values[chosen]
    terms = reduced.terms(state)
    sized = np.array([term.scale(state.factors) for term, _ in terms])
    heavy = np.array([term.kind == "mass" for term, _ in terms])
    powers = np.array([[term.powers.get(name, 0.0) for term, _ in terms] for name in names])
    n = len(vectors)
    forces = np.stack([matrix[:n, :n] @ modes for _, matrix in terms])
    parts = vectors.T @ (forces * np.where(heavy[:, None], -sized[:, None] * lam, sized[:, None])[:, None])
    whole = np.tensordot(powers, parts, axes=1)
    own = np.arange(len(chosen))
    heavier = -(powers * heavy) @ parts[:, chosen, own] / np.where(lam == 0, 1.0, lam)
    for k, (regions, factor) in enumerate(regions_of(spec, name) for name in names):
        if names[k] in bodies:
            mass = bodies[names[k]].mass[:n, :n]
            whole[k] = -vectors.T @ (mass @ modes * lam)
            heavier[k] = np.sum(modes * (mass @ modes), axis=0)
        elif regions or state.yielding:
            stiffness, mass = reduced.sensitivity(state, factor, regions)
            whole[k] = vectors.T @ (stiffness @ modes - mass @ modes * lam)
            heavier[k] = np.sum(modes * (mass @ modes), axis=0)
    gap = lam - values[:, None]
    near = np.abs(gap) < 1e-9 * np.abs(lam).max()
    turn = whole * np.where(near, 0.0, 1.0 / np.where(near, 1.0, gap))
    # past a quarter of a turn no shape is another one's, and of modes that are all but double nothing is linear
    weights = np.clip(turn, -LARGEST_TURN, LARGEST_TURN)
    weights[:, chosen, own] = -0.5 * heavier
    return np.asarray(whole[:, chosen, own] / (2 * np.maximum(lam, 1e-12))), np.asarray(weights)
