"""The page on effects: its table is the command's own, and the effect it teaches to write is named by a diagnosis."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from modalkit.cli import app
from modalkit.output.library import effects_record, effects_table
from updating import LIBRARY, Case, Damping, Effect, Material, Measured, Predictor, Spec, Tolerances, diagnose

PAGE = Path(__file__).resolve().parents[2] / "docs" / "effects.md"
BEAM = Spec(
    *("beam", 0.376, 0.0305, 0.0047625, (20,), ("x0",), "timoshenko", Material(210e9, 7850.0)),
    damping=Damping(2.0, 1e-6),
)


@pytest.fixture
def library() -> Iterator[dict[str, Effect]]:
    before = dict(LIBRARY)
    yield LIBRARY
    LIBRARY.clear()
    LIBRARY.update(before)


def code() -> str:
    """Return the one block of Python on the page."""
    (block,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    return str(block)


def test_the_table_is_what_the_command_prints() -> None:
    message = CliRunner().invoke(app, ["effects", "--table"])
    assert message.exit_code == 0
    assert message.stdout == effects_table(effects_record())
    begin = PAGE.read_text(encoding="utf-8").split("| effect |")[1]
    written = "| effect |" + begin.split("\n\n")[0] + "\n"
    assert written == message.stdout, (
        "the library has changed: put `modalkit effects --table` into docs/effects.md"
    )


def test_an_effect_takes_some_thirty_lines() -> None:
    assert len([line for line in code().splitlines() if line.strip()]) <= 32


def test_the_effect_on_the_page_is_named(library: dict[str, Effect]) -> None:
    exec(compile(code(), str(PAGE), "exec"), {})
    effect = library["ground_spring"]
    rng = np.random.default_rng(3)
    x = np.linspace(0.0752, 0.376, 5)
    ones = np.ones(5)
    evaluation = Measured(
        *(np.array([28.0, 176.0, 493.0, 964.0, 1590.0]), ones, 0.01 * ones, 0.001 * ones),
        *(x[:, None], (1, 2, 3, 4, 5), np.full(5, 4), np.arange(5), np.ones((5, 5)), np.ones((5, 5))),
        absolute=True,
    )
    finer = Predictor(BEAM.with_elements(60), evaluation)
    truth = finer.predict(effect.state(finer, {"stiffness": 3000.0}), count=5)
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
    found = diagnose(
        Case("held", BEAM, test, tolerances=Tolerances({"E": 0.01, "density": 0.003, "thickness": 0.005}))
    )
    assert (found.verdict, found.sets) == ("named", (("ground_spring",),)), found.table()
    estimate = found.ranking[0].parameters["ground_spring.stiffness"]
    assert estimate.low95 < 3000 < estimate.high95


def test_bulk_is_explained_where_an_effect_has_it() -> None:
    """It stands in rankings as ``sensor_mass.bulk``; the report and the list of effects say what it is."""
    for name in ("sensor_mass", "lumped_mass"):
        assert "bulk is its rotary inertia over that of a steel cube" in LIBRARY[name].footprint
