"""Bodies and springs of any size at a place of imported matrices: the search at that place finds each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from imported_cases import bolted_frame, frame_matrices, seen_from, spec_of
from updating_cases import observed

from updating import LIBRARY, Case, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.points import evaluate
from updating.problem.candidate import Candidate

COUNT = 8
OWN = {"ground_spring": ("stiffness", "damping"), "lumped_mass": ("mass", "bulk")}


@pytest.fixture(scope="module")
def specimen(tmp_path_factory: pytest.TempPathFactory) -> Predictor:
    """The bolted frame of the examples, hit at its points."""
    with bolted_frame() as frame:
        spec = spec_of(frame_matrices(frame, tmp_path_factory.mktemp("frame"), named=False))
        points = np.array([place for place, _ in frame.POINTS.values()])
        along = np.eye(3)[[axis - 1 for _, axis in frame.POINTS.values()]]
    return Predictor(spec, seen_from(points, along, np.geomspace(20, 2000, COUNT)))


@pytest.mark.long
@pytest.mark.parametrize("place", [4, 7])
@pytest.mark.parametrize("quantile", [0.02, 0.15, 0.2, 0.5, 0.9])
@pytest.mark.parametrize("name", ["ground_spring", "lumped_mass"])
def test_a_size_is_found_where_it_sits(
    name: str, quantile: float, place: int, specimen: Predictor, rng: np.random.Generator
) -> None:
    """No start of the search leads away from it to where modes have changed places."""
    effect, measured = LIBRARY[name], specimen.measured
    size = next(p for p in effect.parameters(specimen) if p.name in ("stiffness", "mass"))
    at = dict(zip("xyz", measured.points[place].tolist(), strict=True))
    state = effect.state(specimen, {**at, size.name: size.value(quantile), "bulk": 1.0})
    moved = specimen.predict(state, count=20)
    seen = (
        np.abs(moved.constants).max(axis=0) > 1e-6 * np.abs(moved.constants).max()
    )  # not those out of its plane
    there = moved.select(np.flatnonzero(seen)[:COUNT])
    test = replace(
        observed(there.frequency, np.full(COUNT, 0.01), there.constants, measured.points, rng),
        directions=measured.directions,
    )
    problem, _ = pose(Case("frame", specimen.spec, test, baseline=None, tolerances=Tolerances()))
    form = next(
        f
        for f in problem.forms(effect)
        if all(f.values.get(n) == v for n, v in at.items()) and f.values.get("stiffness", 1.0)
    )
    candidate = Candidate((effect,), chosen=(form,))
    free = [name for name in ("stiffness", "damping", "mass", "bulk") if name not in form.values]
    truth = {size.name: quantile, "bulk": 1.0 / 6.0, "damping": 0.0}
    there = evaluate(problem, candidate, np.array([truth[n] for n in free if n in OWN[name]]))
    found = explain(problem, candidate, laplace_only=True)
    assert found.best.marginal.log_likelihood > there.marginal.log_likelihood - 1.0
