"""Updating by FRFs with damping that is not proportional: paper B, Eqs. 7-13."""

from updating.frf_update.bootstrap import FrfBootstrap, bootstrap_frf_update
from updating.frf_update.result import FrfUpdate
from updating.frf_update.run import update_frfs

__all__ = ["FrfBootstrap", "FrfUpdate", "bootstrap_frf_update", "update_frfs"]
