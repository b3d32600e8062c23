"""Updating by eigenvalues: paper A, Eqs. 15-25, with the errata corrected."""

from updating.update.bootstrap import Bootstrap, bootstrap
from updating.update.hits import redrawn_frequencies
from updating.update.identifiability import Determinability
from updating.update.result import Estimate, Update
from updating.update.run import update

__all__ = [
    "Bootstrap",
    "Determinability",
    "Estimate",
    "Update",
    "bootstrap",
    "redrawn_frequencies",
    "update",
]
