"""Modes of the full model at a state, against which the reduced one is held at the end."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.clamp import edge_slopes
from updating.effects.mass import sensor_places, sensor_share
from updating.models.fields import Sparse
from updating.models.solve import DENSE
from updating.models.state import State
from updating.models.structure import FieldStructure
from updating.prediction import Predictor
from updating.update.basis import Factor

PLAIN = frozenset({"E", "density", "thickness", "section_scale", "length", "shear"})
"""Effects that are nothing but factors of the model."""

NO_STRUCTURE = frozenset({"calibration_gain", "exponential_window"})
"""Effects of the measurement, which leave the structure alone."""


def full_modes(
    predictor: Predictor, state: State, effects: Mapping[str, Mapping[str, float]], count: int
) -> tuple[FloatArray, FloatArray] | None:
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
    frequency : (count,) array
        Frequencies [Hz].
    vectors : (n_dofs, count) array
        Mass-normalised shapes [kg^-1/2].

    Both are None together if an effect is known to the reduced model alone.
    """
    if set(effects) - PLAIN - NO_STRUCTURE - {"sensor_mass", "clamp_rotation"}:
        return None
    structure = predictor.reduced.structure
    stiffness, mass = structure.matrices(state)
    if "sensor_mass" in effects:
        points, share = sensor_places(predictor), sensor_share(predictor)
        mass = Sparse(mass + share * effects["sensor_mass"]["mass"] * structure.unit_mass(points))
    if "clamp_rotation" in effects:
        stiffness = Sparse(stiffness + effects["clamp_rotation"]["stiffness"] * edge_slopes(structure))
    first = structure.rigid_modes
    wanted = first + count
    if isinstance(structure, FieldStructure) and not state.released and structure.unknowns > DENSE:
        values, vectors = Factor(structure, stiffness, mass).lowest(wanted)
    else:
        values, vectors = structure.eigen(wanted, stiffness=stiffness, mass=mass, released=state.released)
    return np.asarray(np.sqrt(np.maximum(values[first:], 0.0)) / (2 * np.pi)), vectors[:, first:]
