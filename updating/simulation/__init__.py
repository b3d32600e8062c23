"""Simulation: what a model in any state does, seen from any points.

Frequencies and shapes, FRFs in any form, the motion under a given force, and the poles and residues against which a
synthetic hammer test is run. Start with :func:`simulated`.
"""

from updating.simulation.frf import frf_set, receptances
from updating.simulation.hammer import modal_system
from updating.simulation.identified import (
    UNKNOWN_DAMPING,
    identified_ratios,
    with_identified_damping,
    with_ratios,
)
from updating.simulation.model import Simulated, simulated
from updating.simulation.modes import NaturalModes, natural_modes
from updating.simulation.poles import damped_modes
from updating.simulation.transient import time_response

__all__ = [
    "UNKNOWN_DAMPING",
    "NaturalModes",
    "Simulated",
    "damped_modes",
    "frf_set",
    "identified_ratios",
    "modal_system",
    "natural_modes",
    "receptances",
    "simulated",
    "time_response",
    "with_identified_damping",
    "with_ratios",
]
