"""Samples about a peak: their density is right however unevenly the data know the parameters."""

import numpy as np
import pytest

from updating.diagnosis.search.evidence import _draw
from updating.diagnosis.search.fit import Peak, Point
from updating.likelihood.gaussian import Marginal


def peak(normal: np.ndarray) -> Peak:
    """A maximum in the middle of the unit cube with a given information matrix."""
    middle = np.full(len(normal), 0.5)
    point = Point(middle, None, Marginal(0.0, 0.0, middle, 1, 1.0))  # type: ignore[arg-type]
    return Peak(point, normal, np.zeros(len(normal)))


@pytest.mark.parametrize("information", [1e2, 1e6, 1e16, 1e18, 1e22])
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (1.0, -2.0, 0.5), (0.3, 0.3, 0.3)])
def test_densities_integrate_to_one(information: float, direction: tuple[float, ...]) -> None:
    """One combination of three parameters is known, by up to eleven digits, and nothing is of the others."""
    samples, density = _draw([peak(information * np.outer(direction, direction))], 4096)
    assert np.isfinite(density).all()
    assert ((samples >= 0) & (samples <= 1)).all()
    assert np.mean(np.exp(-density)) == pytest.approx(1.0, rel=0.05)
