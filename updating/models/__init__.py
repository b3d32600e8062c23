"""Models of beams, plates and imported matrices, as sums over regions."""

from updating.models.base import Structure, Term
from updating.models.build import build_structure
from updating.models.parts import PointMass, Region
from updating.models.spec import Damping, Material, Spec
from updating.models.structure import FieldStructure

__all__ = [
    "Damping",
    "FieldStructure",
    "Material",
    "PointMass",
    "Region",
    "Spec",
    "Structure",
    "Term",
    "build_structure",
]
