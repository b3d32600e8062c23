"""Effects: the command's table is the library's, the effect that a page teaches to write is named."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from modalkit.cli import app
from modalkit.output.library import effects_document, effects_table
from modalkit.output.summary import summary_text
from modalkit.output.words import answer, phrase
from modalkit.study.named_effects import parse_effect
from modalkit.study.stated_effects import accepted_values
from updating import (
    LIBRARY,
    Case,
    Damping,
    Diagnosis,
    Effect,
    Material,
    Measured,
    Predictor,
    Spec,
    Tolerances,
    diagnose,
)
from updating.update import update

PAGE = Path(__file__).resolve().parents[2] / "docs" / "howto" / "own_effect.md"
BEAM = Spec(
    "beam",
    length=0.376,
    width=0.0305,
    thickness=0.0047625,
    elements=(20,),
    clamped=("x0",),
    theory="timoshenko",
    material=Material(210e9, 7850.0),
    damping=Damping(2.0, 1e-6),
)


TRUE_STIFFNESS = 300.0


@pytest.fixture(scope="module")
def library() -> Iterator[dict[str, Effect]]:
    """Return the library with the effect of the page in it."""
    before = dict(LIBRARY)
    exec(compile(code(), str(PAGE), "exec"), {})
    yield LIBRARY
    LIBRARY.clear()
    LIBRARY.update(before)


@pytest.fixture(scope="module")
def case(library: dict[str, Effect]) -> Case:
    """Return a test of a beam that a bushing holds in the middle."""
    effect = library["bushing"]
    rng = np.random.default_rng(3)
    x = np.linspace(0.0752, 0.376, 5)
    ones = np.ones(5)
    evaluation = Measured(
        frequency=np.array([28.0, 176.0, 493.0, 964.0, 1590.0]),
        frequency_sigma=ones,
        damping=0.01 * ones,
        damping_sigma=0.001 * ones,
        points=x[:, None],
        nodes=(1, 2, 3, 4, 5),
        seen=np.full(5, 4),
        hit=np.arange(5),
        constants=np.ones((5, 5)),
        constants_sigma=np.ones((5, 5)),
        absolute=True,
    )
    finer = Predictor(BEAM.with_elements(60), evaluation)
    truth = finer.predict(effect.state(finer, {"stiffness": TRUE_STIFFNESS}), count=5)
    level = 0.003 * np.sqrt(np.mean(truth.constants**2, axis=0)) * np.ones((5, 5))
    test = replace(
        evaluation,
        frequency=truth.frequency * (1 + 5e-4 * rng.standard_normal(5)),
        frequency_sigma=1e-4 * truth.frequency,
        damping=truth.damping * np.exp(0.03 * rng.standard_normal(5)),
        damping_sigma=0.03 * truth.damping,
        constants=truth.constants + level * rng.standard_normal((5, 5)),
        constants_sigma=level,
    )
    return Case("held", BEAM, test, tolerances=Tolerances({"E": 0.01, "density": 0.003, "thickness": 0.005}))


@pytest.fixture(scope="module")
def diagnosis(case: Case) -> Diagnosis:
    return diagnose(case)


def code() -> str:
    """Return the one block of Python on the page."""
    (block,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    return str(block)


def test_the_command_prints_the_table_of_the_library() -> None:
    message = CliRunner().invoke(app, ["effects", "--table"])
    assert message.exit_code == 0
    assert message.stdout == effects_table(effects_document())
    assert not [name for name in LIBRARY if f"| `{name}` |" not in message.stdout]


def test_an_effect_takes_some_thirty_lines() -> None:
    assert len([line for line in code().splitlines() if line.strip()]) <= 32


@pytest.mark.long
def test_the_effect_on_the_page_is_named(diagnosis: Diagnosis) -> None:
    assert (diagnosis.verdict, diagnosis.sets) == ("named", (("bushing",),)), diagnosis.table()
    estimate = diagnosis.ranking[0].parameters["bushing.stiffness"]
    assert estimate.low95 is not None and estimate.high95 is not None
    assert estimate.low95 < TRUE_STIFFNESS < estimate.high95


def test_it_is_updated_on_the_full_model(case: Case) -> None:
    """Its own lines, written for the reduced basis, are asked for the full matrices: nothing more is to be written."""
    found = update(case, parameters=["bushing"])
    assert found.exact and found.converged
    (spring,) = found.parameters
    assert spring.unit == "N m/rad"
    assert abs(spring.value - TRUE_STIFFNESS) < 4 * spring.sigma < 0.2 * TRUE_STIFFNESS


def test_it_is_worded(diagnosis: Diagnosis) -> None:
    cause = summary_text(diagnosis)[0]
    assert (
        "bushing" in cause
        and "A bushing holds the slope in the middle of the structure." in cause
        and "N m/rad" in cause
    )
    assert "bushing" in phrase(("bushing",)) == LIBRARY["bushing"].words()
    assert "bushing" in answer(diagnosis).lower()


def test_the_next_test_confirms_it(diagnosis: Diagnosis) -> None:
    assert diagnosis.next_test
    assert all("bushing" in test.separates for test in diagnosis.next_test)
    assert all(test.expected_sigma > 1 for test in diagnosis.next_test)


def test_it_is_listed(library: dict[str, Effect], tmp_path: Path) -> None:
    out = tmp_path / "effects.json"
    assert CliRunner().invoke(app, ["effects", "--json", str(out)]).exit_code == 0
    (own,) = (e for e in json.loads(out.read_text(encoding="utf-8"))["effects"] if e["name"] == "bushing")
    assert own["not_for"] == ["matrices"]
    assert [(p["name"], p["unit"]) for p in own["parameters"]] == [("stiffness", "N m/rad")]


def test_a_study_and_the_command_line_take_it_with_its_unit(library: dict[str, Effect]) -> None:
    values = {"stiffness": pytest.approx(TRUE_STIFFNESS)}
    assert accepted_values({"name": "bushing", "stiffness": "0.3 kN m/rad"}) == ("bushing", values)
    assert parse_effect("bushing:stiffness=300 N m/rad") == ("bushing", values)


def test_bulk_is_explained_where_an_effect_has_it() -> None:
    """It stands in rankings as ``sensor_mass.bulk``; the report and the list of effects say what it is."""
    for name in ("sensor_mass", "lumped_mass"):
        assert "bulk is its rotary inertia, relative to a steel cube" in LIBRARY[name].footprint
