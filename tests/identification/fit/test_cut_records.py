"""Records that end before the structure is at rest, without a window or with a weak one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from time_integration import Rig, chain, hammer_tests

from acquisition import Dof, HammerPlan, ModalSystem, estimate_frfs, hammer_test
from acquisition.synthetic import modal_system
from identification import identify

SENSORS, POINTS = [1, 4], [0, 1, 3, 4]
QUIET = HammerPlan(
    rate=1024.0, samples=2048, hits=3, width=3e-3, pre_trigger=0.03, jitter=1e-3, adc_bits=None
)


@pytest.fixture(scope="module")
def truth():
    """Poles [rad/s] and modal constants (n_modes, n, n) of a chain; 11 % of mode 1 is left after 2 s."""
    return chain().truth()


def hits(truth, plan, seed):
    poles, constants = truth
    residues = constants / (2j * poles.imag[:, None, None])
    system = ModalSystem(
        poles,
        np.moveaxis(residues[:, SENSORS][:, :, POINTS], 0, -1),
        tuple(Dof(i + 1, 3) for i in SENSORS),
        tuple(Dof(i + 1, 3) for i in POINTS),
    )
    return hammer_test(system, plan, rng=np.random.default_rng(seed))


def errors(model, truth):
    poles, constants = truth
    assert len(model) == len(poles), model.table()
    pairs = zip(model.responses, model.references, strict=True)
    exact = np.array([constants[:, a.node - 1, b.node - 1].real for a, b in pairs])
    off = np.abs(model.constants.real - exact).max(axis=0) / np.abs(exact).max(axis=0)
    return np.abs(model.modal.damping / (-poles.real / np.abs(poles)) - 1), off


@pytest.mark.long
@pytest.mark.parametrize(
    "change",
    [
        {},
        {"decay": 1.0},
        {"pre_trigger": 0.2},
        {"samples": 1024},
        {"form": "mobility"},
        {"form": "receptance"},
    ],
)
def test_without_noise_damping_and_constants_are_exact(truth, change):
    frfs = estimate_frfs(hits(truth, replace(QUIET, **change), seed=1))
    damping, constants = errors(identify(frfs, band=(20.0, 300.0)), truth)
    assert damping.max() < 1e-3
    assert constants.max() < 2e-3
    unaware = identify(replace(frfs, record=None), band=(20.0, 300.0))
    if len(unaware) == len(truth[0]):
        assert max(e.max() for e in errors(unaware, truth)) > 5e-3  # what it would cost


@pytest.mark.parametrize("form", ["receptance", "mobility", "accelerance"])
@pytest.mark.parametrize("anti_alias", ["smooth", "sharp"])
def test_what_is_cut_off_is_exact_to_the_noise_of_few_short_hits(form, anti_alias):
    """0.5 % at 60 Hz: 15 % is left after a second, and the noise of the force must not move the hits."""
    shapes = np.array([[1.0, 0.8, -0.6, 0.9, 0.7, 0.9], [-0.5, 0.9, 0.8, -0.4, 0.6, 0.5]])
    hertz = np.array([60.0, 151.0, 288.0, 417.0, 530.0, 700.0])
    system = modal_system(
        frequency=hertz, damping=np.full(6, 0.005), response_shapes=shapes[:1], point_shapes=shapes,
        responses=[Dof(1, 3)], points=[Dof(1, 3), Dof(2, 3)],
    )  # fmt: skip
    plan = HammerPlan(
        rate=2048.0,
        samples=2048,
        hits=4,
        response_noise=1e-4,
        force_noise=0.3,
        anti_alias=anti_alias,
        form=form,
    )
    model = identify(
        estimate_frfs(hammer_test(system, plan, rng=np.random.default_rng(2))), band=(20.0, 780.0)
    )
    assert len(model) == 6, (model.table(), model.warnings)
    score = (model.modal.damping - 0.005) / model.modal.damping_sigma
    assert np.abs(score).max() < 4.0
    assert model.modal.frequency_sigma[0] < 0.02
    assert not any("times the power of the noise" in w for w in model.warnings)


@pytest.mark.long
def test_the_form_of_the_frfs_does_not_matter(truth):
    frfs = estimate_frfs(hits(truth, QUIET, seed=1), band=(20.0, 300.0))
    one, other = identify(frfs), identify(frfs.to("receptance"))
    np.testing.assert_allclose(other.poles, one.poles, rtol=1e-5)


@pytest.mark.long
def test_with_noise_the_intervals_hold(truth):
    """Hits by time integration, cut after 2 s, no window."""
    tests = hammer_tests(chain(), Rig(decay=0.0), [np.random.default_rng(s) for s in range(16)])
    models = [identify(estimate_frfs(t, band=(20.0, 300.0))) for t in tests]
    poles = truth[0]
    exact = -poles.real / np.abs(poles)
    off = np.array([m.modal.damping - exact for m in models])
    score = off / np.array([m.modal.damping_sigma for m in models])
    assert np.abs(off.mean(axis=0) / (off.std(axis=0, ddof=1) / 4)).max() < 3.5
    assert 0.75 < np.sqrt(np.mean(score**2)) < 1.3


@pytest.mark.long
def test_frfs_without_records_are_warned_of(truth):
    frfs = replace(estimate_frfs(hits(truth, QUIET, seed=1), band=(20.0, 300.0)), record=None)
    assert any("% of the response is left after" in w for w in identify(frfs).warnings)
