"""Localisation: in which region of the model the error sits.

Siblings with one face: each takes a test beside a model and gives every region a score. :func:`localise` compares them;
:func:`compare_regions` is what a diagnosis uses.
"""

from updating.localisation.base import KINDS, Kind, Localiser, areas
from updating.localisation.comac import Comac
from updating.localisation.evidence import RegionEvidence, RegionPosterior, compare_regions
from updating.localisation.force_residual import ForceResidual
from updating.localisation.localise import METHODS, Localisation, Ranked, localise
from updating.localisation.mece import ConstitutiveError
from updating.localisation.places import boxes, centres, regions_at
from updating.localisation.subspace import BestSubspace

__all__ = [
    "KINDS",
    "METHODS",
    "BestSubspace",
    "Comac",
    "ConstitutiveError",
    "ForceResidual",
    "Kind",
    "Localisation",
    "Localiser",
    "Ranked",
    "RegionEvidence",
    "RegionPosterior",
    "areas",
    "boxes",
    "centres",
    "compare_regions",
    "localise",
    "regions_at",
]
