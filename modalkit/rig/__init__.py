"""How a study's structure is tested: what a simulated hammer test is made after."""

from modalkit.simulation.measured import rig_of_data
from modalkit.simulation.planned import rig_of_model, spaced
from modalkit.simulation.setup import SAMPLING, Options, Rig

__all__ = ["SAMPLING", "Options", "Rig", "rig_of_data", "rig_of_model", "spaced"]
