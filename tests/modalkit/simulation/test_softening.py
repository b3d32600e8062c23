"""A joint that softens with the level of the hits: false modes find no partner, and the user hears of the joint."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from acquisition import Dof, Geometry, UffContent, estimate_frfs, hammer_test, judge_hits
from acquisition.synthetic import HammerPlan, ModalSystem, modal_system
from identification import ModalModel
from modalkit.workflow.judged_hits import Judged
from modalkit.workflow.processed import Processed
from modalkit.workflow.processing_options import ProcessingOptions
from updating import Axes, Material, Predictor, Spec, measured_from_identified
from updating.prediction.matching import pair_modes

BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(20,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=Material(210e9, 7850.0, 0.3),
)
X = np.linspace(0.05, 0.4, 8)
NODES = tuple(range(1, 9))
SHARE = np.array([1.0, 0.6, 0.3, 0.1])
BAND = (15.0, 1200.0)


@cache
def beam() -> tuple[np.ndarray, np.ndarray]:
    from updating import build_structure

    structure = build_structure(BEAM)
    values, vectors = structure.eigen(4)
    return np.sqrt(values) / (2 * np.pi), np.asarray(structure.rows(X[:, None])["w"] @ vectors)


def softened(level: float, slope: float) -> ModalSystem:
    """The beam with a joint: every mode falls with the level, the lowest most."""
    frequency, shapes = beam()
    dofs = [Dof(n, 3) for n in NODES]
    return modal_system(
        frequency=frequency * (1 - SHARE * slope * level),
        damping=np.full(4, 0.006),
        response_shapes=shapes[-1:],
        point_shapes=shapes,
        responses=dofs[-1:],
        points=dofs,
    )


@cache
def identified(slope: float, scatter: float, seed: int) -> ModalModel:
    plan = HammerPlan(
        rate=3072.0,
        samples=6144,
        hits=4,
        level_scatter=scatter,
        width=5e-4,
        force_noise=0.01,
        response_noise=1e-3,
    )
    geometry = Geometry(NODES, np.stack([X, 0 * X, 0 * X], axis=1))
    test = hammer_test(
        lambda level: softened(level, slope), plan, rng=np.random.default_rng(seed), geometry=geometry
    )
    processed = Processed(
        UffContent(), estimate_frfs(test), (Judged(test, judge_hits(test)),), ProcessingOptions(), ()
    )
    return processed.identify(band=BAND)


@pytest.mark.long
@pytest.mark.parametrize("slope", [1e-4, 6e-4])
@pytest.mark.parametrize("seed", [0, 2])
def test_every_pair_is_of_one_mode_and_no_false_one_has_a_partner(slope: float, seed: int) -> None:
    measured = measured_from_identified(identified(slope, 0.5, seed), Axes(), BEAM)
    paired = pair_modes(measured, Predictor(BEAM, measured).predict())
    frequency, _ = beam()
    level = np.abs(paired.measured.frequency / frequency[paired.order] - 1)
    assert (level < 0.2).all()  # the softest of the hits, not a neighbour
    assert (
        len(paired.order) >= 2
    )  # where softening is worst the lowest are too uncertain to compare, and that is said
    assert len(set(paired.order.tolist())) == len(paired.order)


def test_a_mode_of_another_shape_between_true_ones_has_no_partner() -> None:
    """What is put between the first and the second mode looks like neither: MAC 0.33 with the nearest."""

    measured = measured_from_identified(identified(0.0, 0.5, 0), Axes(), BEAM)
    constants, frequency = np.asarray(measured.constants), measured.frequency
    unit = constants / np.linalg.norm(constants, axis=0)
    other = np.linalg.qr(np.hstack([unit, np.eye(len(unit))[:, :1]]))[0][:, -1]
    false = np.sqrt(0.33) * unit[:, 1] + np.sqrt(0.67) * other
    order = np.argsort([*frequency, 2.5 * frequency[0]])
    both = np.column_stack([constants, false * np.linalg.norm(constants[:, 1])])[:, order]
    size = np.median(measured.constants_sigma) * np.ones_like(both)
    many = replace(
        measured,
        frequency=np.append(frequency, 2.5 * frequency[0])[order],
        frequency_sigma=np.append(measured.frequency_sigma, 0.1)[order],
        damping=np.append(measured.damping, 0.01)[order],
        damping_sigma=np.append(measured.damping_sigma, 0.001)[order],
        constants=both, constants_sigma=size, noise=None, shared=None, hit_errors=None, quadrature=None, phase=None,
        phase_sigma=None, channel_group=None, trend=None, trend_sigma=None,
    )  # fmt: skip
    paired = pair_modes(many, Predictor(BEAM, many).predict())
    np.testing.assert_allclose(paired.measured.frequency, frequency)
    assert any("has no partner in the model (best: MAC 0." in w for w in paired.warnings)


@pytest.mark.long
def test_frequencies_that_follow_the_level_are_warned_of() -> None:
    soft = identified(3e-4, 0.5, 1)
    message = [w for w in soft.warnings if "follow the force of the hits" in w]
    assert len(message) == 1
    assert "-" in message[0] and "joint" in message[0]
    assert not any("follow the force" in w for w in identified(0.0, 0.5, 0).warnings)
