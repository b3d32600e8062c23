"""Nodes of imported matrices at which something may sit: each once, and found in little memory."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from effect_cases import imported
from imported_cases import imported_beam, seen_from, spec_of
from scipy.linalg import eigh
from scipy.spatial import KDTree

from updating import LIBRARY, Predictor
from updating.effects.regions import WAYS
from updating.effects.structure.nodes import distinct


def test_distinct_places_are_found_in_little_memory() -> None:
    """All pairs of some thousand places would be 100 MB."""
    beam, rng = imported_beam(4), np.random.default_rng(1)
    places = rng.random((3000, 3))
    others = np.vstack([rng.random((1500, 3)) + 2.0, places[::2] + 0.5e-6 * beam.reach])
    tracemalloc.start()
    found = distinct(beam, places, others)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.tolist() == list(range(1, 3000, 2))
    assert most < 5e6


@pytest.mark.long
@pytest.mark.parametrize("measured", [(2,), (1, 2)])
def test_a_spring_at_a_point_along_what_alone_is_measured_there_is_one_form(
    measured: tuple[int, ...],
) -> None:
    """Measured in several directions, the point is held in all of them: along one is another form."""
    predictor, effect = imported(), LIBRARY["ground_spring"]
    axes = np.tile(measured, len(predictor.measured.points))
    points = np.repeat(predictor.measured.points, len(measured), axis=0)
    n = len(points)
    test = replace(
        predictor.measured, points=points, directions=np.eye(3)[axes], nodes=tuple(range(1, n + 1)),
        seen=np.arange(n), hit=np.full(n, -1), constants=np.ones((n, 2)), constants_sigma=np.ones((n, 2)),
        absolute=False,
    )  # fmt: skip
    there = predictor.of(predictor.spec).for_test(test)
    at = dict(zip("xyz", points[-1].tolist(), strict=True))
    held = there.predict(effect.state(there, {**at, "stiffness": 5e3, "along": "z"}), count=2).frequency
    hit = there.for_test(replace(test, frequency=held))
    forms = [form for form in effect.variants(hit) if "stiffness" not in form.values]
    here = [form for form in forms if all(form.values[name] == pytest.approx(at[name]) for name in "xyz")]
    unlike = {form.values.get("along", "".join(WAYS[a] for a in measured)) for form in here}
    assert len(unlike) == len(here) == len(measured)
    assert any("along" in form.values for form in forms)


@pytest.mark.long
@pytest.mark.parametrize("name", ["lumped_mass", "ground_spring"])
def test_where_every_node_is_a_test_point_there_are_no_others(name: str) -> None:
    """Forms at test points share all of the prior; the beam moves along z alone."""
    predictor = imported()
    assert predictor.spec.imported is not None
    places = predictor.spec.imported.places.at
    along = np.tile([0.0, 0.0, 1.0], (len(places), 1))
    everywhere = predictor.of(predictor.spec).for_test(seen_from(places, along, np.array([20.0, 400.0])))
    at = [
        [form.values[k] for k in "xyz"] for form in LIBRARY[name].variants(everywhere) if "x" in form.values
    ]
    away, _ = KDTree(places).query(at)
    assert len({tuple(place) for place in at}) == len(places)
    assert away.max() < 1e-9


@pytest.mark.long
@pytest.mark.parametrize("clamped", [True, False])
@pytest.mark.parametrize(("effect", "sizes"), [("lumped_mass", (0.03, 0.25)), ("ground_spring", (5e3, 1e6))])
def test_the_node_where_something_sits_is_among_the_promising(
    clamped: bool, effect: str, sizes: tuple[float, float]
) -> None:
    """Bodies of a twentieth to nearly half of the beam's mass, springs up to a stop, from matrices of all rows."""
    spec = spec_of(imported_beam(60, clamped=clamped))
    beam, ends = spec.imported, np.array([[0.5, 0.0, 0.0], [0.3, 0.0, 0.0]])
    assert beam is not None
    along = np.tile([0.0, 0.0, 1.0], (2, 1))
    rows = beam.places.rows(ends, along)["w"]
    first, kind = (0 if clamped else 2), "mass" if effect == "lumped_mass" else "stiffness"
    for node in (23, 41, 52):
        for size in sizes:
            matrices = {"stiffness": beam.stiffness.toarray(), "mass": beam.mass.toarray()}
            own = beam.places.moves[2][[node]]
            matrices[kind] = matrices[kind] + size * (own.T @ own).toarray()
            values, modes = eigh(*matrices.values(), subset_by_index=(first, first + 4))
            test = seen_from(ends, along, np.sqrt(values) / (2 * np.pi))
            seen = rows @ modes
            found = Predictor(spec, replace(test, constants=seen[test.seen] * seen[test.hit]))
            forms = LIBRARY[effect].variants(found)
            places = [form.values["x"] for form in forms if "x" in form.values]
            assert min(abs(x - 0.5 * node / 60) for x in places) < 1e-9
