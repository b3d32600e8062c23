"""Updating by eigenvalues: paper A, Eqs. 15-25, with the errata corrected."""

from updating.update.estimate import Estimate
from updating.update.resampling import Bootstrap, bootstrap
from updating.update.result import Update
from updating.update.run import update
from updating.update.statistics.hits import redrawn_frequencies
from updating.update.statistics.identifiability import Determinability

__all__ = [
    "Bootstrap",
    "Determinability",
    "Estimate",
    "Update",
    "bootstrap",
    "redrawn_frequencies",
    "update",
]
