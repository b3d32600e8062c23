"""Points of a test on a model that is longer or wider than the study says."""

from __future__ import annotations

import numpy as np
import pytest

from updating import Material, Spec
from updating.prediction.stretch import Stretch

MATERIAL = Material(E=70e9, poisson=0.33, density=2700.0)


@pytest.mark.parametrize(
    ("edges", "kept"),
    [
        (("x0",), (0.4, 0.15)),
        (("x1",), (0.0, 0.15)),
        ((), (0.2, 0.15)),
        (("x0", "x1"), (0.2, 0.15)),
        (("x0", "y0"), (0.4, 0.3)),
    ],
)
def test_the_free_end_or_the_middle_stays_where_it_is(
    edges: tuple[str, ...], kept: tuple[float, float]
) -> None:
    plate = Spec(
        "plate",
        length=0.4,
        width=0.3,
        thickness=0.002,
        material=MATERIAL,
        clamped=edges,
        elements=(8, 6),
        theory="kirchhoff",
    )
    stretch = Stretch(plate)
    factors = stretch.by({"length": 1.1, "width": 0.9})
    # on the model before, that point has the place in which the model now holds it
    before = stretch.undone(np.array([kept]), factors)
    np.testing.assert_allclose(before, [kept], rtol=1e-12)
    placed = stretch.unstretched({"x": kept[0], "y": kept[1], "mass": 0.1}, {"length": 1.1, "width": 0.9})
    assert placed == pytest.approx({"x": kept[0], "y": kept[1], "mass": 0.1})


def test_places_off_the_model_end_at_its_edge() -> None:
    beam = Spec(
        "beam",
        length=0.4,
        width=0.03,
        thickness=0.002,
        material=MATERIAL,
        clamped=("x0",),
        elements=(20,),
        theory="euler-bernoulli",
    )
    stretch = Stretch(beam)
    assert stretch.names == ("length",)
    assert stretch.unstretched({"x": 0.0}, {"length": 0.9})["x"] == 0.0
    assert stretch.unstretched({"x": 0.1}, {})["x"] == 0.1
