"""How a study's structure is tested: what a simulated hammer test is made after."""

from modalkit.rig.base import SAMPLING, Options, Rig
from modalkit.rig.heard import rig_of_data
from modalkit.rig.planned import rig_of_model, spaced

__all__ = ["SAMPLING", "Options", "Rig", "rig_of_data", "rig_of_model", "spaced"]
