"""Pole estimators, all with one signature."""

from identification.poles.base import PoleEstimator, PoleSets
from identification.poles.lsce import lsce
from identification.poles.lscf import lscf

ESTIMATORS: dict[str, PoleEstimator] = {"lscf": lscf, "lsce": lsce}

__all__ = ["ESTIMATORS", "PoleEstimator", "PoleSets", "lsce", "lscf"]
