"""The model that an update leaves is the one whose frequencies it reports."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modalkit.study.read import study_of
from modalkit.views.pairs import pairs_of
from modalkit.workflow.case import Session, open_study
from modalkit.workflow.update import update_studies
from modalkit.workflow.updated_model import updated_predictor
from updating.nominal import predictor_of

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"


def session_of(name: str, **tables: Any) -> Session:
    path = SAMPLES / name / "study.toml"
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    content["model"] |= tables.pop("model", {})
    return open_study(study_of(content | tables, path), with_baseline=False)


@pytest.mark.parametrize(
    ("name", "tables"),
    [
        ("beam_dry", {"update": {"parameters": ["E"]}}),
        ("beam_dry", {"update": {"parameters": ["E", "length", "clamp_rotation"]}}),
        (
            "beam_dry",
            {
                "update": {"parameters": ["sensor_mass"]},
                "model": {"effect": [{"name": "sensor_mass", "mass": 0.02}]},
            },
        ),
        pytest.param("tape_taped", {}, marks=pytest.mark.long),
    ],
    ids=["a factor", "several", "an effect that the study has accepted", "by FRFs, in stages"],
)
def test_its_frequencies_are_those_after_the_update(name: str, tables: dict[str, Any]) -> None:
    session = session_of(name, **tables)
    result = update_studies([session])
    prediction = updated_predictor(result, session.case).predict()
    found = {p.test + 1: prediction.frequency[p.model] for p in pairs_of(session.case.measured, prediction)}
    for mode, hertz in zip(result.pairs["test_mode"], result.pairs["after_hz"], strict=True):
        assert found[mode] == pytest.approx(hertz, rel=1e-5)


@pytest.mark.long
def test_frequencies_of_bending_follow_the_root_of_the_modulus() -> None:
    session = session_of("beam_dry", update={"parameters": ["E"]})
    result = update_studies([session])
    factor = result.parameters[0].factor
    assert factor is not None
    before = predictor_of(session.case).predict().frequency
    after = updated_predictor(result, session.case).predict().frequency
    assert after / before == pytest.approx(np.full(len(before), np.sqrt(factor)), rel=1e-6)
