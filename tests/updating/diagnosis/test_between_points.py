"""A spring, and a body, at a node that carries no test point: found there, or with the places that are as likely."""

from __future__ import annotations

import numpy as np
import pytest
from space_frame import Hidden, case, frame, nearest
from test_give_way import POINTS

from updating import LIBRARY, Diagnosis, diagnose

ON_ARM, ON_BEAM = nearest((0.1, 0.7 / 3, 0.45)), nearest((1 / 6, 1 / 30, 0.45 - 0.07 / 3))
RIVALS = ("ground_spring", "lumped_mass", "local_stiffness", "clamp_translation", "E")


def diagnosed(hidden: Hidden, points: list[tuple[int, int]], **options: float) -> Diagnosis:
    return diagnose(case(hidden, points, **options), library=[LIBRARY[name] for name in RIVALS])  # type: ignore[arg-type]


def place(node: int) -> np.ndarray:
    return np.array(frame().made.places[node])


@pytest.mark.long
def test_a_spring_between_the_points_is_found_along_its_axis() -> None:
    assert all(node != ON_ARM for node, _ in POINTS)
    found = diagnosed(Hidden(springs=((ON_ARM, 2, 3e4),)), POINTS)
    assert (found.verdict, found.sets) == ("named", (("ground_spring",),))
    assert found.where.locations == (pytest.approx(place(ON_ARM)),)
    assert found.ranking[0].forms[0]["along"] == "z"
    assert found.ranking[0].parameters["ground_spring.stiffness"].value == pytest.approx(3e4, rel=0.02)


@pytest.mark.long
def test_a_spring_at_a_point_across_what_is_measured_there_is_found() -> None:
    assert [axis for node, axis in POINTS if node == ON_BEAM] == [1, 2]
    found = diagnosed(Hidden(springs=((ON_BEAM, 0, 2e6),)), POINTS)
    assert found.verdict == "named"
    assert found.sets[0] == ("ground_spring",)
    assert found.ranking[0].forms[0]["along"] == "x"


@pytest.mark.long
def test_a_body_between_the_points_is_found() -> None:
    node = nearest((0.05, 0.35 / 3, 0.45))
    found = diagnosed(Hidden(masses=((node, 0.05),)), POINTS)
    assert (found.verdict, found.sets) == ("named", (("lumped_mass",),))
    assert found.where.locations == (pytest.approx(place(node)),)
    assert found.ranking[0].parameters["lumped_mass.mass"].value == pytest.approx(0.05, rel=0.03)


@pytest.mark.long
def test_neighbours_that_the_data_do_not_separate_are_all_places() -> None:
    """Four frequencies do not say where a light body sits."""
    node = nearest((0.05, 0.35 / 3, 0.45))
    found = diagnosed(Hidden(masses=((node, 0.05),)), [], modes=4, scatter=1e-3)
    assert len(found.where.locations) > 1
    away = [float(np.linalg.norm(np.subtract(at, place(node)))) for at in found.where.locations]
    assert min(away) < 1e-6
