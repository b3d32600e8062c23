"""A single cause whose maximum was missed is found again from the set of which it is a part."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from updating_cases import BEAM as FINE
from updating_cases import case_of, specimen, struck

from updating import LIBRARY
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.fewer import with_parts
from updating.diagnosis.search.points import evaluate
from updating.problem.candidate import Candidate


def test_a_missed_maximum_of_a_part_is_mended_and_a_found_one_stays() -> None:
    rng = np.random.default_rng(5)
    beam = specimen(rng)
    problem, _ = pose(case_of(struck(replace(beam, E=0.9 * beam.E), rng), FINE.with_elements(20)))
    single, both = Candidate((LIBRARY["E"],)), Candidate((LIBRARY["E"], LIBRARY["length"]))
    right = explain(problem, single, laplace_only=True)
    length = explain(problem, Candidate((LIBRARY["length"],)), laplace_only=True)
    whole = explain(problem, both, laplace_only=True)
    far = evaluate(problem, single, np.array([0.95]))
    missed = replace(right, best=far, log_evidence=far.marginal.log_likelihood)
    mended = with_parts(problem, [missed, length, whole])
    found = next(e for e in mended if e.names == ("E",))
    assert len(mended) == 3
    assert abs(found.best.marginal.log_likelihood - right.best.marginal.log_likelihood) < 0.05
    assert abs(found.log_evidence - right.log_evidence) < 0.5
    assert with_parts(problem, [right, length, whole])[0] is right
    assert with_parts(problem, [right]) == [right]
