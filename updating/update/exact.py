"""Frequencies of the full model at a state, against which the reduced one is held at the end."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.clamp import edge_slopes
from updating.effects.mass import sensor_places
from updating.models.fields import Sparse
from updating.models.state import State
from updating.models.structure import Structure
from updating.prediction import Predictor

PLAIN = frozenset({"E", "density", "thickness", "section_scale", "length", "shear"})
"""Effects that are nothing but factors of the model."""

NO_STRUCTURE = frozenset({"calibration_gain", "exponential_window"})
"""Effects of the measurement, which leave the structure alone."""


def full_matrices(structure: Structure, state: State) -> tuple[Sparse, Sparse]:
    """Assemble stiffness and mass of the full model under a state's factors, Eqs. 11-14 [SI].

    Parameters
    ----------
    structure : Structure
        The full model.
    state : State
        Only its factors, of the whole and of regions, are looked at.
    """
    n = structure.fields.n_dofs
    total = {"stiffness": Sparse((n, n)), "mass": structure.point_masses()}
    fields = structure.fields.sampled
    for term in structure.terms:
        weights = term.coefficient * term.scale(state.factors)
        for (region, factor), value in state.regional.items():
            inside = structure.region_of == region
            weights = np.where(inside, weights * value ** term.powers.get(factor, 0.0), weights)
        part = fields[term.left].T @ (fields[term.right] * weights[:, None])
        total[term.kind] = total[term.kind] + (part if term.left == term.right else (part + part.T) / 2)
    return Sparse(total["stiffness"]), Sparse(total["mass"])


def full_frequencies(
    predictor: Predictor, state: State, effects: Mapping[str, Mapping[str, float]], count: int
) -> FloatArray | None:
    """Solve the full model for its lowest elastic modes.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    state : State
        Everything that departs from the nominal model.
    effects : mapping of str to mapping
        Effects in the state and the values of their parameters.
    count : int
        Number of elastic modes.

    Returns
    -------
    (count,) array or None
        Frequencies [Hz]; None if an effect is known to the reduced model alone.
    """
    if set(effects) - PLAIN - NO_STRUCTURE - {"sensor_mass", "clamp_rotation"}:
        return None
    structure = predictor.reduced.structure
    stiffness, mass = full_matrices(structure, state)
    if "sensor_mass" in effects:
        rows = structure.fields.at(sensor_places(predictor))["w"]
        mass = Sparse(mass + effects["sensor_mass"]["mass"] * (rows.T @ rows))
    if "clamp_rotation" in effects:
        spring = effects["clamp_rotation"]["stiffness"]
        stiffness = Sparse(stiffness + spring * edge_slopes(structure))
    first = structure.rigid_modes
    values, _ = structure.eigen(first + count, stiffness=stiffness, mass=mass, released=state.released)
    return np.asarray(np.sqrt(np.maximum(values[first:], 0.0)) / (2 * np.pi))
