"""Pole estimators, all with one signature, and the registry of their names in `identify`."""

from identification.poles.base import Baseband, PoleEstimator, PoleSets, row_scale
from identification.poles.lsce import lsce
from identification.poles.lscf import lscf

ESTIMATORS: dict[str, PoleEstimator] = {
    "lscf": PoleEstimator(lscf, poly_reference=True, any_order=True),
    "lsce": PoleEstimator(lsce),
}

__all__ = ["ESTIMATORS", "Baseband", "PoleEstimator", "PoleSets", "lsce", "lscf", "row_scale"]
