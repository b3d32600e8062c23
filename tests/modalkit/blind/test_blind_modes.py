"""Poles and residues of the rig: exactness, damping, and the record made from them."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acquisition import estimate_frfs, read_uff
from modalkit.blind.trial import draw_trial, write_trial
from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.complex_modes import complex_modes
from modalkit.simulator.bodies.parts import Attached
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.measurement import hammer_plan, measure, modal_system, remounting, scaled
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

BEAM = Beam(0.0, 0.5, 0.03, 0.005, 210e9, 7850.0, alpha=3.0, beta=1e-6)
PLACES = np.array([0.1, 0.27, 0.5])


def test_rayleigh_damping() -> None:
    modes = complex_modes(BEAM, PLACES, PLACES[1], count=6, scatter=np.ones(6))
    omega, shapes = BEAM.real_modes(6)
    np.testing.assert_allclose(np.abs(modes.poles), omega, rtol=1e-9)
    np.testing.assert_allclose(modes.damping, 0.5 * (3.0 / omega + 1e-6 * omega), rtol=1e-8)
    real = BEAM.rows(PLACES, "w") @ shapes
    damped = np.abs(modes.poles.imag)
    expected = real[1] * real / (2j * damped)
    np.testing.assert_allclose(modes.residues, expected, rtol=1e-6, atol=1e-12)


def test_dashpot_gives_the_response_of_the_full_equations() -> None:
    damped = replace(BEAM, attached=(Attached(0.27, mass=0.02, damping=15.0),))
    count = 40
    modes = complex_modes(damped, PLACES, PLACES[0], count=count, scatter=np.ones(count))
    assert np.abs(np.angle(modes.points[0] ** 2 * 1j)).max() > 0.01  # truly complex shapes
    omega, shapes = damped.real_modes(count)
    material, dashpots = damped.modal_damping(shapes)
    real = damped.rows(PLACES, "w") @ shapes
    for s in (2j * np.pi * 40.0, 2j * np.pi * 333.0, -3.0 + 2j * np.pi * 90.0):
        dynamic = np.diag(omega**2 + s**2) + s * (material + dashpots)
        direct = real[0] @ np.linalg.solve(dynamic, real.T)
        pairs = modes.residues / (s - modes.poles) + np.conj(modes.residues) / (s - modes.poles.conj())
        np.testing.assert_allclose(pairs.sum(axis=1), direct, rtol=1e-6)


def test_gradients_are_derivatives_of_residues() -> None:
    step = 1e-6
    at, ahead = (
        complex_modes(BEAM, PLACES[:2] + d, PLACES[2], count=5, scatter=np.ones(5)) for d in (0.0, step)
    )
    numeric = (np.abs(ahead.residues) - np.abs(at.residues)) / step
    sign = np.sign((at.residues * 1j).real)
    np.testing.assert_allclose((at.gradients[0] * 1j).real * sign, numeric, rtol=1e-3)


def test_remounting_scatters_frequencies_and_nothing_else() -> None:
    setup = replace(plain_setup(), repeatability=0.001)
    rng = np.random.default_rng(3)
    drawn = np.array([remounting(setup, 5, rng) for _ in range(400)])
    assert (drawn - 1).std(axis=0) == pytest.approx(0.001, rel=0.15)
    modes = complex_modes(BEAM, PLACES, PLACES[1], count=5, scatter=np.ones(5))
    again = scaled(modes, drawn[0])
    np.testing.assert_allclose(again.frequency / modes.frequency, drawn[0])
    np.testing.assert_allclose(again.damping, modes.damping)
    level = again.residues * again.poles.imag
    np.testing.assert_allclose(level, modes.residues * modes.poles.imag)


def plain_setup() -> Setup:
    return draw_trial(4, 1, plan=DrawRanges(kinds=("beam",), effects=("none",))).scene.setup


def quiet(scene: Scene) -> Scene:
    """Take noise, bad hits, re-mounting and strays away, so that records hold what the scene says."""
    setup = replace(
        scene.setup, noise=1e-9, bits=24, repeatability=0.0, position_sigma=0.0, sensor_sign=-1, bad_hits=0.0
    )
    return replace(scene, setup=setup)


@pytest.mark.parametrize("effect", ["none", "exponential_window", "time_delay", "swapped_points"])
def test_records_hold_the_rigs_own_frf(effect: str) -> None:
    plan = DrawRanges(kinds=("beam",), effects=(effect,), pairs=0.0)
    scene = quiet(draw_trial(11, 2, plan=plan).scene).with_chain(gain=1.3)
    setup, chain = scene.setup, scene.chain
    test = measure(scene, rng=np.random.default_rng(5))
    modes = scene.modes()
    assert test.decay == setup.window
    inside = (modes.frequency > setup.band[0]) & (modes.frequency < setup.band[1])
    assert inside.sum() >= setup.modes
    estimated = estimate_frfs(test)
    line = estimated.frequency
    near = np.unique(np.searchsorted(line, np.outer(modes.frequency[inside], [0.998, 1.0, 1.002]).ravel()))
    s = np.asarray(2j * np.pi * line[near] + chain.window, dtype=np.complex128)
    system = modal_system(modes, setup)
    for row in range(len(test.points)):
        exact = 1.3 * s**2 * np.exp(-s * chain.delay) * system.receptance(s, row)[0]
        assert np.abs(estimated.values[row, near] - exact).max() < 0.01 * np.abs(exact).max()


def test_files_hold_what_the_study_says_of_them(tmp_path: Path) -> None:
    trial = draw_trial(17, 3, plan=DrawRanges(kinds=("beam",), effects=("E",)))
    setup = trial.scene.setup
    study = tomllib.loads(write_trial(trial, tmp_path).read_text())
    content = read_uff([tmp_path / name for name in study["test"]["files"]])
    (test,) = content.tests
    hit = [i for i in range(len(setup.points)) if setup.drive or i != setup.sensor]
    assert [point.reference.node - 1 for point in test.points] == hit
    assert {point.count for point in test.points} == {setup.hits}
    places = content.geometry.at(range(1, len(setup.points) + 1))
    np.testing.assert_allclose(places[:, 0], setup.places[:, 0], atol=1e-9)
    assert np.all(places[:, 1:] == 0)
    (response,) = test.points[0].responses
    assert (response.node - 1, response.sign) == (setup.sensor, setup.sensor_sign)


def test_the_same_trial_writes_the_same_records(tmp_path: Path) -> None:
    contents = []
    for name in ("first", "second"):
        folder = tmp_path / name
        folder.mkdir()
        write_trial(draw_trial(17, 3, plan=DrawRanges(kinds=("beam",), effects=("E",))), folder)
        contents.append(b"".join(p.read_bytes()[-5000:] for p in sorted(folder.iterdir())))
    assert contents[0] == contents[1]


def test_records_are_long_enough() -> None:
    for index in range(6):
        scene = draw_trial(21, index, plan=DrawRanges(kinds=("beam",))).scene
        modes = scene.modes()
        plan = hammer_plan(scene, modes, np.random.default_rng(1))
        inside = (modes.frequency > scene.setup.band[0]) & (modes.frequency < scene.setup.band[1])
        left = np.exp(-(scene.chain.window - modes.poles.real[inside]).min() * plan.samples / plan.rate)
        assert left < 0.05
        assert plan.rate > 2.56 * scene.setup.band[1]


def test_nominal_scene_is_what_the_study_states() -> None:
    setup = plain_setup()
    modes = nominal_scene(setup).elastic()
    bare = np.array(setup.nominal_hz[: setup.modes])
    heavier = modes.frequency[: setup.modes]
    assert np.all(heavier <= bare * (1 + 1e-3))
    assert np.all(heavier > 0.96 * bare)


def test_structural_damping_is_the_same_ratio_in_every_mode() -> None:
    lossy = replace(BEAM, alpha=0.0, beta=0.0, added_loss=0.02)
    modes = complex_modes(lossy, PLACES, PLACES[0], count=5, scatter=np.ones(5))
    np.testing.assert_allclose(modes.damping, 0.01, rtol=1e-3)


def test_mass_proportional_damping_is_a_window() -> None:
    held = replace(BEAM, attached=(Attached(0.4, mass=0.05),))
    damped = replace(held, added_alpha=5.0)
    plain, more = (
        complex_modes(b, PLACES, PLACES[0], count=6, scatter=np.linspace(0.7, 1.4, 6)) for b in (held, damped)
    )
    np.testing.assert_allclose(plain.poles.real - more.poles.real, 2.5, rtol=1e-3)
