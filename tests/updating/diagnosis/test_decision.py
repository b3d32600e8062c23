"""Other rules are tried on what was searched, without another search."""

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, case_of, specimen, struck

from updating import LIBRARY, DecisionRules
from updating.diagnosis import diagnose as module
from updating.diagnosis.decision import diagnosis_of
from updating.diagnosis.diagnose import diagnose, searched_case

SEARCHED = [LIBRARY[name] for name in ("E", "density")]


@pytest.mark.long
def test_what_was_searched_is_decided_on_by_other_rules(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    softer = replace(specimen(rng), E=0.9 * BEAM.material.E)
    case = case_of(struck(softer, rng), BEAM.with_elements(12))
    whole = diagnose(case, library=SEARCHED)
    searched = searched_case(case, library=SEARCHED)
    monkeypatch.delattr(module, "search")
    again = diagnosis_of(searched)
    assert again.verdict == whole.verdict != "none"
    assert again.sets == whole.sets
    assert again.shrink == whole.shrink
    assert again.warnings == whole.warnings
    strict = diagnosis_of(searched, rules=DecisionRules(beyond_nothing=1e6))
    assert strict.verdict == "unknown"
    assert [row.probability for row in strict.ranking] == [row.probability for row in whole.ranking]
