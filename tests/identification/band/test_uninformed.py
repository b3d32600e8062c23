"""Modes at lines that hold nothing of the structure come with a warning, whoever asks for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, FrfSet, estimate_frfs, hammer_test
from acquisition.quantities import hertz
from acquisition.synthetic import HammerPlan, modal_system
from identification import identify
from identification.band.uninformed import uninformed_modes

TRUE = np.array([60.0, 151.0, 288.0, 417.0, 530.0])


def hit(beyond: float, **more: object) -> FrfSet:
    shapes = np.array([[1.0, 0.8, -0.6, 0.9, 0.7, 0.9], [-0.5, 0.9, 0.8, -0.4, 0.6, 0.5]])
    system = modal_system(
        frequency=np.append(TRUE, beyond),
        damping=np.full(6, 0.005),
        response_shapes=shapes[:1],
        point_shapes=shapes,
        responses=[Dof(1, 3)],
        points=[Dof(1, 3), Dof(2, 3)],
    )
    plan = replace(HammerPlan(rate=2048.0, samples=2048, hits=4, response_noise=1e-3), **more)  # type: ignore[arg-type]
    return estimate_frfs(hammer_test(system, plan, rng=np.random.default_rng(2)))


def false_of(found: np.ndarray, true: np.ndarray) -> np.ndarray:
    return found[np.abs(found[:, None] / true - 1).min(axis=1) > 2e-3]


SMOOTH = (1100.0, {"width": 3e-4, "force_noise": 0.01}, (20.0, 1024.0))
LONG = (700.0, {"width": 3e-3, "width_scatter": 0.01, "force_noise": 0.1}, (20.0, 760.0))
SHARP = (870.0, {"width": 5e-3, "width_scatter": 0.01, "force_noise": 0.1, "anti_alias": "sharp"}, None)
Case = tuple[float, dict[str, object], tuple[float, float] | None]


@pytest.mark.parametrize("case", [SMOOTH, LONG, SHARP])
def test_what_is_found_beyond_the_force_or_the_filter_is_named(case: Case) -> None:
    beyond, plan, band = case
    model = identify(hit(beyond, **plan), band=band)
    doubtful = false_of(model.modal.frequency, TRUE)
    for frequency in doubtful:
        assert any(hertz(frequency) in warning for warning in model.warnings)
    assert len(doubtful) or case is not LONG  # a real mode that the force hardly reaches is found


@pytest.mark.parametrize(
    ("case", "frequency", "word"),
    [(SMOOTH, 990.5, "an alias from"), (LONG, 701.0, "coherence"), (SHARP, 406.6, "coherence")],
)
def test_the_warning_names_why_a_mode_is_doubted(case: Case, frequency: float, word: str) -> None:
    beyond, plan, band = case
    frfs = hit(beyond, **plan)
    warnings = uninformed_modes(frfs.band(*band) if band else frfs, np.array([frequency]))
    assert any(word in warning and hertz(frequency) in warning for warning in warnings)


def test_modes_that_the_force_reaches_are_not_doubted() -> None:
    frfs = hit(700.0, width=1e-3, force_noise=0.01)
    assert uninformed_modes(frfs, np.append(TRUE, 700.0)) == ()
    assert uninformed_modes(replace(frfs, coherence=None, variance=None, scatter=None), TRUE) == ()


def test_lines_up_to_the_filter_are_none_beyond_it() -> None:
    """Analysers keep 800 of 1024 lines: their last is where the filter begins to fall."""
    whole = replace(hit(700.0, width=1e-3, force_noise=0.01), record=None)
    assert "an alias from" in " ".join(uninformed_modes(whole, np.array([990.0])))
    assert uninformed_modes(whole.band(0.0, 800.0), np.array([790.0])) == ()
