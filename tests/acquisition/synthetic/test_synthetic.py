"""The synthetic test against the analytic FRF and against time integration of M, C, K."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from acquisition import (
    Dof,
    HammerPlan,
    InputError,
    ModalSystem,
    estimate_frfs,
    hammer_test,
    modal_system,
    read_uff,
    write_uff,
)

FREQUENCY = np.array([80.0, 200.0, 403.0, 405.5, 700.0])
DAMPING = np.array([0.02, 0.01, 0.01, 0.008, 0.01])
DOFS = tuple(Dof(node, 3) for node in (1, 2, 3))
QUIET = {"adc_bits": None, "level_scatter": 0.2}


@pytest.fixture
def system(rng: np.random.Generator) -> ModalSystem:
    shapes = rng.standard_normal((3, 5))
    return modal_system(
        frequency=FREQUENCY,
        damping=DAMPING,
        response_shapes=shapes[:2],
        point_shapes=shapes,
        responses=DOFS[:2],
        points=DOFS,
    )


def analytic(system: ModalSystem, laplace: NDArray[np.complex128], power: int) -> NDArray[np.complex128]:
    rows = [system.receptance(laplace, point) for point in range(len(system.points))]
    return np.concatenate(rows) * laplace**power


@pytest.mark.parametrize("pulse", ["haversine", "half-sine"])
@pytest.mark.parametrize(("form", "power"), [("receptance", 0), ("mobility", 1), ("accelerance", 2)])
def test_h1_of_decayed_records_is_the_frf(system, rng, pulse, form, power):
    plan = HammerPlan(samples=16384, hits=2, pulse=pulse, form=form, **QUIET)
    frfs = estimate_frfs(hammer_test(system, plan, rng=rng)).band(20.0, 1000.0)
    exact = analytic(system, frfs.laplace, power)
    size = np.abs(exact)
    resonant = size > 0.1 * size.max(axis=1, keepdims=True)
    assert np.abs(frfs.values / exact - 1)[resonant].max() < 1e-5
    assert (np.abs(frfs.values - exact) / size.max(axis=1, keepdims=True)).max() < 1e-5


def test_exponential_window_shifts_the_axis_and_nothing_else(system, rng):
    """With a window that brings records to nothing, the FRFs are exact samples beside the imaginary axis."""
    plan = HammerPlan(samples=4096, hits=2, decay=12.0, **QUIET)
    frfs = estimate_frfs(hammer_test(system, plan, rng=rng)).band(20.0, 1000.0)
    exact = analytic(system, frfs.laplace, 2)
    assert frfs.decay == 12.0
    assert (np.abs(frfs.values - exact) / np.abs(exact).max(axis=1, keepdims=True)).max() < 1e-4


def test_records_that_are_cut_leak(rng):
    light = modal_system(
        frequency=np.array([100.3]),
        damping=np.array([2e-4]),
        response_shapes=np.ones((1, 1)),
        point_shapes=np.ones((1, 1)),
        responses=DOFS[:1],
        points=DOFS[:1],
    )
    frfs = estimate_frfs(hammer_test(light, HammerPlan(samples=4096, **QUIET), rng=rng)).band(90.0, 110.0)
    exact = analytic(light, frfs.laplace, 2)
    assert np.abs(frfs.values - exact).max() > 0.05 * np.abs(exact).max()


def test_nothing_wraps_round(rng):
    """What is left of an undecayed response must not appear before the hit."""
    light = modal_system(
        frequency=np.array([100.3]),
        damping=np.array([1e-5]),
        response_shapes=np.ones((1, 1)),
        point_shapes=np.ones((1, 1)),
        responses=DOFS[:1],
        points=DOFS[:1],
    )
    test = hammer_test(light, HammerPlan(samples=2048, pre_trigger=0.05, **QUIET), rng=rng)
    motion = test.points[0].motion
    assert np.abs(motion[..., :100]).max() < 1e-5 * np.abs(motion).max()


def test_records_agree_with_time_integration(rng):
    """A two-degree-of-freedom M, C, K system integrated by scipy with the same pulse, 64 times oversampled."""
    mass = np.diag([2.0, 1.0])
    stiffness = np.array([[9.0e5, -3.0e5], [-3.0e5, 3.0e5]])
    damping = 0.8 * mass + 2e-5 * stiffness
    square, shapes = scipy.linalg.eigh(stiffness, mass)
    omega = np.sqrt(square)
    system = modal_system(
        frequency=omega / (2 * np.pi),
        damping=(0.8 / omega + 2e-5 * omega) / 2,
        response_shapes=shapes,
        point_shapes=shapes[1:],
        responses=DOFS[:2],
        points=DOFS[1:2],
    )
    plan = HammerPlan(samples=2048, hits=1, form="receptance", width=4e-3, width_scatter=0.0, **QUIET)
    test = hammer_test(system, plan, rng=np.random.default_rng(5))
    twin = np.random.default_rng(5)
    level = plan.peak * np.exp(plan.level_scatter * twin.standard_normal(5)[0])
    start = plan.pre_trigger + twin.uniform() / plan.rate
    fine = np.arange(plan.samples * 64) / (64 * plan.rate)
    push = np.where(
        np.abs(fine - start - 2e-3) < 2e-3, level * np.sin(np.pi * (fine - start) / 4e-3) ** 2, 0.0
    )
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ damping]])
    model = (state, np.r_[0, 0, inverse @ [0, 1]][:, None], np.eye(2, 4), np.zeros((2, 1)))
    _, answer, _ = scipy.signal.lsim(model, push, fine)
    expected = answer[::64].T
    assert np.abs(test.points[0].motion[0] - expected).max() < 1e-4 * np.abs(expected).max()
    assert (
        np.abs(test.points[0].force[0] - push[::64]).max() < 2e-3 * level
    )  # the filter rounds the pulse's feet


def test_same_seed_same_records(system):
    plan = HammerPlan(
        samples=512, force_noise=0.1, response_noise=1e-3, bad={(0, 1): "double", (1, 0): "clipped"}
    )
    one = hammer_test(system, plan, rng=np.random.default_rng(3))
    two = hammer_test(system, plan, rng=np.random.default_rng(3))
    three = hammer_test(system, plan, rng=np.random.default_rng(4))
    assert all(np.array_equal(a.motion, b.motion) for a, b in zip(one.points, two.points, strict=True))
    assert not np.array_equal(one.points[0].force, three.points[0].force)


def test_level_dependent_structure_is_asked_for_each_peak(system, rng):
    asked = []

    def softer(level: float) -> ModalSystem:
        asked.append(level)
        return system

    test = hammer_test(
        softer, HammerPlan(rate=51200.0, samples=2048, hits=4, level_scatter=0.5, adc_bits=None), rng=rng
    )
    peaks = np.concatenate([p.force.max(axis=-1) for p in test.points])
    assert np.allclose(np.array(asked[1:]) / peaks, np.mean(np.array(asked[1:]) / peaks), rtol=0.01)
    assert np.ptp(peaks) > 0.3 * np.median(peaks)


def test_gain_and_delay_change_the_frf_as_they_should(system):
    plain = {"samples": 16384, "hits": 1, **QUIET}
    same = [
        estimate_frfs(hammer_test(system, HammerPlan(**plain, **more), rng=np.random.default_rng(1))).band(
            50, 900
        )
        for more in ({}, {"gain": 1.05}, {"delay": 2e-4})
    ]
    factor = 1.05 * np.ones_like(same[0].frequency)
    assert np.allclose(same[1].values, factor * same[0].values, rtol=1e-9)
    turned = same[0].values * np.exp(-2j * np.pi * same[0].frequency * 2e-4)
    assert np.abs(same[2].values - turned).max() < 1e-5 * np.abs(turned).max()


def test_records_of_the_converter_are_exact_in_single_precision(system, rng):
    test = hammer_test(system, HammerPlan(samples=512, response_noise=1e-3, adc_bits=24), rng=rng)
    for point in test.points:
        assert np.array_equal(point.motion, point.motion.astype(np.float32))
        assert np.array_equal(point.force, point.force.astype(np.float32))


def test_position_scatter_needs_gradients_and_uses_them(system, rng):
    plan = HammerPlan(samples=512, position_sigma=1e-3)
    with pytest.raises(InputError, match="gradients"):
        hammer_test(system, plan, rng=rng)
    gradients = np.stack([100 * system.residues, np.zeros_like(system.residues)])
    wide = ModalSystem(system.poles, system.residues, system.responses, system.points, gradients)
    test = hammer_test(wide, HammerPlan(samples=512, hits=200, position_sigma=1e-3, **QUIET), rng=rng)
    level = np.abs(test.points[0].motion).max(axis=(1, 2)) / np.abs(test.points[0].force).max(axis=1)
    assert 0.07 < level.std() / level.mean() < 0.14  # 100/m times 1 mm is a tenth


@pytest.mark.parametrize(
    "wrong", [{"rate": 0.0}, {"samples": 8}, {"bad": {(0, 0): "lost"}}, {"form": "force"}]
)
def test_senseless_plans_are_refused(wrong):
    with pytest.raises(InputError):
        HammerPlan(**wrong)


@pytest.mark.parametrize("slope", [-1.0, 0.0, 2.0])
def test_noise_has_the_colour_and_the_strength_asked_for(slope):
    still = modal_system(
        frequency=np.array([80.0]),
        damping=np.array([0.02]),
        response_shapes=np.zeros((1, 1)),
        point_shapes=np.zeros((1, 1)),
        responses=DOFS[:1],
        points=DOFS[:1],
    )
    plan = HammerPlan(samples=4096, hits=200, response_floor=3.0, noise_slope=slope, adc_bits=None)
    noise = hammer_test(still, plan, rng=np.random.default_rng(2)).points[0].motion[:, 0]
    assert np.sqrt(np.mean(noise**2)) == pytest.approx(3.0, rel=0.01)
    power = np.mean(np.abs(np.fft.rfft(noise, axis=-1)) ** 2, axis=0)[8:2000]
    octaves = np.log(np.arange(8, 2000))
    assert np.polyfit(octaves, np.log(power), 1)[0] == pytest.approx(slope, abs=0.02)


def test_a_hit_in_the_wrong_place_excites_the_next_point(system):
    plan = HammerPlan(samples=8192, hits=2, bad={(0, 1): "wrong place"}, **QUIET)
    test = hammer_test(system, plan, rng=np.random.default_rng(1))
    force, motion = (np.fft.rfft(r, axis=-1) for r in (test.points[0].force, test.points[0].motion))
    lines = slice(200, 1600)  # 100 to 800 Hz
    laplace = 2j * np.pi * np.fft.rfftfreq(8192, 1 / plan.rate)[lines]
    for hit, place in ((0, 0), (1, 1)):
        exact = system.receptance(laplace, place) * laplace**2
        found = (motion[hit] / force[hit])[:, lines]
        assert np.abs(found - exact).max() < 0.01 * np.abs(exact).max()
    with pytest.raises(InputError, match="second point"):
        hammer_test(
            ModalSystem(system.poles, system.residues[:, :1], system.responses, system.points[:1]),
            replace(plan, bad={(0, 0): "wrong place"}),
            rng=np.random.default_rng(1),
        )


def test_the_converter_saturates_at_its_range(system, rng):
    plan = HammerPlan(samples=512, adc_bits=12, force_range=64.0, level_scatter=0.2)
    force = hammer_test(system, plan, rng=rng).points[0].force
    step = 64.0 / 2**11
    assert force.max() == 64.0 - step
    assert np.array_equal(force, np.round(force / step) * step)
    with pytest.raises(InputError, match="force_range"):
        HammerPlan(force_range=-1.0)


def test_pulses_fall_between_samples_and_are_jittered(system, rng):
    """Where pulses begin is spread as asked, to a fraction of a sample: seen in the phase of the force."""
    plan = HammerPlan(samples=1024, hits=300, jitter=2e-3, width_scatter=0.0, **QUIET)
    force = np.fft.rfft(hammer_test(system, plan, rng=rng).points[0].force, axis=-1)
    low = 2 * np.pi * np.fft.rfftfreq(1024, 1 / plan.rate)[1:8]
    start = -np.array([np.polyfit(low, np.unwrap(np.angle(f[1:8])), 1)[0] for f in force]) - plan.width / 2
    spread = np.sqrt(plan.jitter**2 + 1 / (12 * plan.rate**2))
    assert start.std() == pytest.approx(spread, rel=0.13)  # 300 draws: 4 %
    assert start.mean() == pytest.approx(plan.pre_trigger + 0.5 / plan.rate, abs=4 * spread / np.sqrt(300))
    fraction = (start * plan.rate) % 1.0
    assert np.abs(np.histogram(fraction, bins=4, range=(0, 1))[0] - 75).max() < 35


def test_hits_survive_a_file_bit_for_bit(system, rng, tmp_path):
    test = hammer_test(system, HammerPlan(samples=512, response_noise=1e-3, decay=5.0), rng=rng)
    write_uff(tmp_path / "hits.uff", tests=test)
    (back,) = read_uff(tmp_path / "hits.uff").tests
    assert back.rate == pytest.approx(test.rate) and back.form == test.form
    for one, two in zip(test.points, back.points, strict=True):
        assert one.reference == two.reference and one.responses == two.responses
        assert np.array_equal(one.force, two.force) and np.array_equal(one.motion, two.motion)
