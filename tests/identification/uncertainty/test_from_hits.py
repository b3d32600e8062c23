"""From raw hits to damping and modal mass, hits by time integration among them, under an exponential window."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray
from time_integration import Rig, Structure, chain, hammer_tests

from acquisition import (
    Dof,
    HammerPlan,
    HammerTest,
    ModalSystem,
    Windows,
    estimate_frfs,
    hammer_test,
    judge_hits,
)
from identification import ModalModel, identify

BAND = (20.0, 300.0)
SEEDS = 24


@dataclass(frozen=True)
class Truth:
    """Poles and modal constants of a structure."""

    structure: Structure
    poles: NDArray[np.complex128]
    constants: NDArray[np.complex128]

    @property
    def damping(self) -> NDArray[np.float64]:
        return np.asarray(-self.poles.real / np.abs(self.poles))

    def mass_errors(self, model: ModalModel) -> NDArray[np.float64]:
        """Relative error of each modal mass, from the drive point at which the mode moves most."""
        rows = [i for i, (a, b) in enumerate(zip(model.responses, model.references, strict=True)) if a == b]
        nodes = np.array([model.responses[i].node - 1 for i in rows])
        exact = self.constants[:, nodes, nodes].real
        best = np.abs(exact).argmax(axis=1)
        modes = np.arange(len(self.poles))
        found = model.constants.real[np.array(rows)[best], modes]
        return np.asarray(exact[modes, best] / found - 1)


@pytest.fixture(scope="module")
def truth() -> Truth:
    structure = chain()
    return Truth(structure, *structure.truth())


def scores(models: list[ModalModel], truth: Truth):
    """Errors of the damping, (n_tests, n_modes), and the same over their sigmas."""
    errors = np.array([m.modal.damping - truth.damping for m in models])
    return errors, errors / np.array([m.modal.damping_sigma for m in models])


@pytest.mark.long
def test_time_integration_agrees_with_the_dynamic_stiffness(truth):
    """The simulator itself: without noise its FRFs are those of M s^2 + C s + K."""
    quiet = Rig(noise=0.0, force_noise=0.0, hits=2)
    (test,) = hammer_tests(truth.structure, quiet, [np.random.default_rng(0)])
    frfs = estimate_frfs(test, band=BAND)
    s, m = frfs.laplace[:, None, None], truth.structure
    exact = np.linalg.inv(m.mass * s**2 + m.damping * s + m.stiffness) * s**2
    for values, a, b in zip(frfs.values, frfs.responses, frfs.references, strict=True):
        expected = exact[:, a.node - 1, b.node - 1]
        # between steps the force is straight: sinc^2 at 300 of 16384 Hz lowers the FRF by a thousandth
        assert np.abs(values - expected).max() < 1.5e-3 * np.abs(expected).max()
    poles = 1 / (s - truth.poles[:, None, None, None])
    modal = truth.constants[:, None] / (2j * truth.poles.imag[:, None, None, None])
    summed = (modal * poles + modal.conj() / (s - truth.poles.conj()[:, None, None, None])).sum(axis=0)
    assert np.allclose(summed * s**2, exact, rtol=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("windowed_by", ["the rig", "us"])
def test_damping_is_unbiased_and_its_sigma_true(truth, windowed_by):
    rig = Rig() if windowed_by == "the rig" else Rig(decay=0.0)
    windows = None if windowed_by == "the rig" else Windows(decay=3.0)
    rngs = [np.random.default_rng(seed) for seed in range(SEEDS)]
    tests = hammer_tests(truth.structure, rig, rngs)
    sets = [estimate_frfs(test, windows=windows) for test in tests]
    assert {frfs.decay for frfs in sets} == {3.0}
    models = [identify(frfs, band=BAND) for frfs in sets]
    assert {len(m) for m in models} == {len(truth.poles)}
    errors, z = scores(models, truth)
    standard_error = errors.std(axis=0, ddof=1) / np.sqrt(SEEDS)
    assert np.abs(errors.mean(axis=0) / standard_error).max() < 2.5
    assert 0.8 < np.sqrt(np.mean(z**2)) < 1.25
    # the window left in would be far outside
    assert (3.0 / np.abs(truth.poles) > 20 * np.mean([m.modal.damping_sigma for m in models], axis=0)).all()
    masses = np.array([truth.mass_errors(m) for m in models])
    assert np.abs(masses).max() < 0.02
    assert all(np.all(m.modal.scaled) for m in models)


BAD = {(0, 1): "double", (0, 4): "cut", (1, 0): "clipped", (2, 3): "weak", (3, 2): "double", (3, 5): "weak"}
PLAN = HammerPlan(
    rate=1024.0,
    samples=2048,
    hits=6,
    width=3e-3,
    pre_trigger=0.03,
    jitter=1e-3,
    force_noise=0.02,
    response_floor=0.3,
    decay=3.0,
)


def hits(truth: Truth, seed: int, bad) -> HammerTest:
    """The same structure from its poles and residues."""
    sensors, points = [1, 4], [0, 1, 3, 4]
    residues = truth.constants / (2j * truth.poles.imag[:, None, None])
    system = ModalSystem(
        truth.poles,
        np.moveaxis(residues[:, sensors][:, :, points], 0, -1),
        tuple(Dof(i + 1, 3) for i in sensors),
        tuple(Dof(i + 1, 3) for i in points),
    )
    return hammer_test(system, replace(PLAN, bad=bad), rng=np.random.default_rng(seed))


@pytest.mark.long
def test_bad_hits_are_marked_and_without_them_all_is_as_in_a_clean_test(truth):
    clean, left_out, all_used = [], [], []
    for seed in range(12):
        clean.append(identify(estimate_frfs(hits(truth, seed, {})), band=BAND))
        test = hits(truth, seed, BAD)
        verdicts = judge_hits(test)
        row = {point.reference: i for i, point in enumerate(test.points)}
        assert {(row[v.point], v.hit - 1) for v in verdicts if not v.used} == set(BAD)
        left_out.append(identify(estimate_frfs(test, verdicts=verdicts), band=BAND))
        all_used.append(estimate_frfs(test, band=BAND))
    sigma = np.array([m.modal.damping_sigma for m in clean])
    difference = np.array([b.modal.damping - a.modal.damping for a, b in zip(clean, left_out, strict=True)])
    assert np.sqrt(np.mean((difference / sigma) ** 2)) < 1.0  # most hits are common to both
    errors, z = scores(left_out, truth)
    assert np.abs(errors.mean(axis=0) / (errors.std(axis=0, ddof=1) / np.sqrt(12))).max() < 3.1  # t of 11
    assert 0.75 < np.sqrt(np.mean(z**2)) < 1.3
    assert max(np.abs(truth.mass_errors(m)).max() for m in left_out) < 0.02
    spoilt = np.mean([(f.coherence.mean(axis=1)[[0, 1]]).min() for f in all_used])
    assert spoilt < 0.98  # the bad hits do harm if they are kept
