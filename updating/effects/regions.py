"""Regions of imported matrices, on which an effect acts where there are no fields."""

from __future__ import annotations

from updating.effects.base import Parameter
from updating.effects.box import Place
from updating.prediction.predict import Predictor


def stiff_regions(predictor: Predictor) -> tuple[int, ...]:
    """Return the regions of imported matrices that have a stiffness of their own."""
    imported = predictor.spec.imported
    return () if imported is None else tuple(range(len(imported.stiffness_parts)))


def region_parameter(predictor: Predictor) -> Parameter:
    """Return the number of the region, from 0, which the forms of an effect fix."""
    last = max(len(stiff_regions(predictor)) - 1, 1)
    return Parameter("region", "-", 0.0, float(last), "any of the regions, in the study's order from 0")


def region_centre(predictor: Predictor, region: int) -> Place:
    """Return the middle of a region [m]."""
    spec = predictor.spec
    chosen = spec.regions[region]
    across = (0.0, spec.width) if chosen.y is None else chosen.y
    return (sum(chosen.x) / 2, sum(across) / 2, 0.0)
