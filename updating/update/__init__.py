"""Updating by eigenvalues: paper A, Eqs. 15-25, with the errata corrected."""

from updating.update.result import Estimate, Update
from updating.update.run import update

__all__ = ["Estimate", "Update", "update"]
