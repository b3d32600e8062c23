"""Where bodies and sensors sit: forms of a lumped mass, and a sensor beside its stated place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import CORNERS, LOOK
from updating_cases import BEAM, POINTS, case_of, specimen, struck

from updating import LIBRARY, diagnose
from updating.effects.structure.mass import FARTHEST, free_ends, promising_points

BODY, SENSOR = LIBRARY["lumped_mass"], LIBRARY["sensor_mass"]


def test_bodies_are_sought_at_ends_at_points_and_anywhere() -> None:
    free = LOOK["free"]  # its sensor is at x1
    forms = BODY.variants(free)
    assert sum(form.weight for form in forms) <= 1 + 1e-12
    assert (dict(forms[0].values), forms[0].weight) == ({"x": 0.0}, pytest.approx(0.125))
    assert all(form.values.get("x") != BEAM.length for form in (*forms, *BODY.variants(LOOK["beam"])))
    assert all(form.values["x"] in POINTS and form.weight == pytest.approx(0.05) for form in forms[1:-1])
    assert (dict(forms[-1].values), forms[-1].weight) == ({}, pytest.approx(0.5))
    assert len(free_ends(LOOK["free"].spec)) == 2
    corners = free_ends(LOOK["plate"].spec)
    assert corners.tolist() == [[0.376, 0.0], [0.376, 0.2]]


@pytest.mark.parametrize("place", ["beam", "plate", "free"])
def test_the_point_where_a_body_sits_is_among_the_promising(place: str) -> None:
    """Frequencies of the rig at test points, all a per mille or two off alike."""
    predictor = LOOK[place]
    for at in CORNERS[3:] if place == "plate" else POINTS[1:, None]:
        values = dict(zip("xy", at, strict=False)) | {"mass": 0.01, "bulk": 1.0}
        found = predictor.predict(BODY.state(predictor, values), count=5)
        ones = np.ones(5)
        shapes = found.constants
        test = replace(
            predictor.measured, frequency=1.002 * found.frequency, frequency_sigma=ones, damping=0.01 * ones,
            damping_sigma=ones, constants=shapes, constants_sigma=np.abs(shapes), phase=None, phase_sigma=None,
        )  # fmt: skip
        near = promising_points(predictor.for_test(test))
        mirrored = at * [1, -1][: len(at)] + [0, 0.2][: len(at)] if place == "plate" else at
        assert min(np.abs(near - at).sum(axis=1).min(), np.abs(near - mirrored).sum(axis=1).min()) < 1e-9


def test_a_sensor_beside_its_place_is_a_body_there() -> None:
    predictor = LOOK["beam"]
    values = {"mass": 0.01, "bulk": 2.0}
    beside = predictor.predict(SENSOR.state(predictor, values | {"dx": -0.002}), count=4)
    body = predictor.predict(BODY.state(predictor, values | {"x": POINTS[-1] - 0.002}), count=4)
    assert beside.frequency == pytest.approx(body.frequency, rel=1e-12)
    here = predictor.predict(SENSOR.state(predictor, values), count=4)
    near = predictor.predict(SENSOR.state(predictor, values | {"dx": -1e-9}), count=4)
    assert near.frequency == pytest.approx(here.frequency, rel=1e-7)


def test_how_far_a_sensor_sits_beside_its_place_is_normal_about_it() -> None:
    predictor = LOOK["beam"]
    away = SENSOR.parameters(predictor)[2]
    assert away.name == "dx"
    sigma = predictor.measured.position_sigma
    drawn = np.array([away.value(u) for u in (np.arange(4000) + 0.5) / 4000])
    assert drawn.std() == pytest.approx(0.9866 * sigma, rel=1e-3)  # normal, cut off at three sigma
    assert np.abs(drawn).max() <= FARTHEST * sigma
    exact = predictor.for_test(replace(predictor.measured, position_sigma=0.0))
    assert [p.name for p in SENSOR.parameters(exact)] == ["mass", "bulk"]


@pytest.mark.long
def test_a_body_beside_the_sensor_is_the_sensors_mass_by_its_prior() -> None:
    """1.4 mm from a place that is known to 1 mm: the sensor leads, the body is not named over it."""
    rng = np.random.default_rng(11)
    bench = replace(specimen(rng), masses=((BEAM.length - 0.0014, 0.02),))
    found = diagnose(case_of(struck(bench, rng)), library=[SENSOR, BODY, LIBRARY["E"], LIBRARY["density"]])
    assert found.ranking[0].effects == ("sensor_mass",), found.table()
