"""Models of beams, plates and imported matrices, as sums over regions."""

from updating.models.spec import Damping, Material, PointMass, Region, Spec
from updating.models.structure import Structure, Term, build_structure

__all__ = ["Damping", "Material", "PointMass", "Region", "Spec", "Structure", "Term", "build_structure"]
