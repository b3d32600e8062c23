"""From modal constants to mode shapes, mass-normalised where the data allow it."""

from identification.scaling.constants import modal_constants
from identification.scaling.scale import mode_shapes
from identification.scaling.shapes import Shapes, real_modes

__all__ = ["Shapes", "modal_constants", "mode_shapes", "real_modes"]
