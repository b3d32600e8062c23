"""Trials on a study's own model: hits of the model with something in it, and the diagnosis of these."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from modalkit.blind.answer import Answer, read_answer
from modalkit.output.documents import diagnosis_document
from modalkit.output.whole import plain
from modalkit.simulation.setup import Options
from modalkit.simulation.simulate import Prepared, simulate_test
from modalkit.study.read import Study
from modalkit.workflow.diagnosis import diagnose_studies

if TYPE_CHECKING:
    from modalkit.planning.cases import Case

SEED_BITS = 63

REMOUNTED = Options(remount=True)
"""The structure is mounted anew and the chain calibrated anew in every trial."""


def diagnosed(study: Study, ready: Prepared, case: Case, seed: list[int]) -> Answer:
    """Hit the study's model with a case in it, and have the hits diagnosed.

    Parameters
    ----------
    study : Study
        As the user has it.
    ready : Prepared
        The study made ready to be hit.
    case : Case
        What is hidden.
    seed : list of int
        Of all scatter and noise.
    """
    number = int(np.random.default_rng(seed).integers(2**SEED_BITS))
    hidden = simulate_test(ready, [(case.family.cause, case.values)], seed=number)
    with tempfile.TemporaryDirectory(prefix="test-", ignore_cleanup_errors=True) as folder:
        hits = Path(folder) / "hits.uff"
        hidden.write(hits)
        return read_answer(plain(diagnosis_document(diagnose_studies([with_hits(study, hits)]))))


def with_hits(study: Study, hits: Path) -> Study:
    """Return a study whose test is a file of hits in place of what it names."""
    mine = {"files": [str(hits.absolute())], "modes": None, "layout": None, "points": [], "sensor": None}
    return study.model_copy(update={"test": study.test.model_copy(update=mine)})
