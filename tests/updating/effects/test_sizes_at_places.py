"""Bodies and springs of any size at a place of imported matrices: the search at that place finds each."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from imported_cases import seen_from, spec_of
from updating_cases import observed

from updating import LIBRARY, Case, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.fit import evaluate
from updating.models.imported import Imported
from updating.models.imported.nodes import read_table
from updating.problem.candidate import Candidate

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "matrices"
COUNT = 8
OWN = {"ground_spring": ("stiffness", "damping"), "lumped_mass": ("mass", "bulk")}


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Predictor]:
    """The bolted frame of the examples, hit at its points."""
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(str(EXAMPLES))
    import frame  # type: ignore[import-not-found]

    model, _ = frame.frame()
    path = tmp_path_factory.mktemp("frame") / "nodes.csv"
    path.write_text(model.table({}))
    stiffness = model.matrix("stiffness")
    imported = Imported(stiffness, model.matrix("mass"), read_table(path, stiffness.shape[0]))
    points = np.array([place for place, _ in frame.POINTS.values()])
    along = np.eye(3)[[axis - 1 for _, axis in frame.POINTS.values()]]
    yield Predictor(spec_of(imported), seen_from(points, along, np.geomspace(20, 2000, COUNT)))
    patch.undo()
    for name in ("frame", "bars", "hits"):
        sys.modules.pop(name, None)


@pytest.mark.parametrize("place", [4, 7])
@pytest.mark.parametrize("quantile", [0.02, 0.15, 0.2, 0.5, 0.9])
@pytest.mark.parametrize("name", ["ground_spring", "lumped_mass"])
def test_a_size_is_found_where_it_sits(
    name: str, quantile: float, place: int, frame: Predictor, rng: np.random.Generator
) -> None:
    """No start of the search leads away from it to where modes have changed places."""
    effect, measured = LIBRARY[name], frame.measured
    size = next(p for p in effect.parameters(frame) if p.name in ("stiffness", "mass"))
    at = dict(zip("xyz", measured.points[place].tolist(), strict=True))
    state = effect.state(frame, {**at, size.name: size.value(quantile), "bulk": 1.0})
    moved = frame.predict(state, count=20)
    seen = (
        np.abs(moved.constants).max(axis=0) > 1e-6 * np.abs(moved.constants).max()
    )  # not those out of its plane
    there = moved.select(np.flatnonzero(seen)[:COUNT])
    test = replace(
        observed(there.frequency, np.full(COUNT, 0.01), there.constants, measured.points, rng),
        directions=measured.directions,
    )
    problem, _ = pose(Case("frame", frame.spec, test, None, Tolerances()))
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
