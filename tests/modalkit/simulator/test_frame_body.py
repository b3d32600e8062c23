"""Frames on the rig against closed forms, the modeller's matrices, and the library's effects at the hidden values."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from modalkit.blind.trial import Trial, draw_trial, write_trial
from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.bodies.frame.grillage import Bar, Grillage
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.hidden import effects_of
from modalkit.simulator.scene import nominal_scene
from modalkit.study.read import read_study
from updating import LIBRARY, Predictor
from updating.test_data.measured import Measured

LENGTH, BREADTH, DEPTH, E, DENSITY, POISSON = 0.6, 0.02, 0.008, 210e9, 7850.0, 0.3
PLAN = DrawRanges(kinds=("frame",), none=0.0, pairs=0.0, outside=0.0)


def skew_cantilever(elements: int) -> tuple[np.ndarray, np.ndarray, Grillage]:
    """Return a bar that stands out at 30 degrees, its first node held."""
    along = np.linspace(0.0, LENGTH, elements + 1)[:, None] * np.array([np.cos(np.pi / 6), 0.5])
    mesh = Grillage(along, tuple(Bar("bar", (i, i + 1)) for i in range(elements)), {})
    ((k, m),) = mesh.parts((BREADTH, DEPTH), (E, DENSITY, POISSON)).values()
    return k[3:, 3:], m[3:, 3:], mesh


def test_a_bar_at_an_angle_bends_and_twists_as_in_closed_form() -> None:
    k, m, mesh = skew_cantilever(20)
    values, vectors = eigh(k, m)
    hertz = np.sqrt(values) / (2 * np.pi)
    rigidity, line = E * BREADTH * DEPTH**3 / 12, DENSITY * BREADTH * DEPTH
    bending = (
        np.array([1.875104, 4.694091, 7.854757]) ** 2 / LENGTH**2 * np.sqrt(rigidity / line) / (2 * np.pi)
    )
    for f in bending:
        assert np.abs(hertz / f - 1).min() < 2e-5
    torsion = BREADTH * DEPTH**3 * (1 / 3 - 0.21 * DEPTH / BREADTH * (1 - (DEPTH / BREADTH) ** 4 / 12))
    polar = BREADTH * DEPTH * (BREADTH**2 + DEPTH**2) / 12
    twisting = np.sqrt(E / 2.6 * torsion / (DENSITY * polar)) / (4 * LENGTH)
    assert np.abs(hertz / twisting - 1).min() < 5e-4
    # deflection and slopes of the first mode, half way, by the same place's neighbours
    shape = np.concatenate([np.zeros(3), vectors[:, 0]])
    at, step = mesh.places[10] + 0.4 * (mesh.places[11] - mesh.places[10]), 1e-5
    w = [
        mesh.reads(np.array([at + d]), "w")[0] @ shape for d in ([step, 0], [-step, 0], [0, step], [0, -step])
    ]
    slopes = [mesh.reads(at[None], q)[0] @ shape for q in ("slope_x", "slope_y")]
    assert slopes == pytest.approx([(w[0] - w[1]) / (2 * step), (w[2] - w[3]) / (2 * step)], rel=1e-4)


def predictor_of(trial: Trial, folder: Path) -> Predictor:
    """Return the modeller's model, seen from the test's points by as many modes as the band was chosen for."""
    setup = trial.scene.setup
    spec = read_study(write_trial(trial, folder)).spec()
    points = np.column_stack([setup.places, np.zeros(len(setup.points))])
    nothing = np.full(setup.modes, np.nan)
    n = len(points)
    test = Measured(
        frequency=np.array(setup.nominal_hz[: setup.modes]), frequency_sigma=np.zeros(setup.modes),
        damping=nothing, damping_sigma=nothing, points=points, nodes=tuple(range(1, n + 1)),
        seen=np.full(n, setup.sensor), hit=np.arange(n), constants=np.ones((n, setup.modes)),
        constants_sigma=np.ones((n, setup.modes)), absolute=True,
        directions=np.tile([0.0, 0.0, 1.0], (n, 1)),
    )  # fmt: skip
    return Predictor(spec, test)


def test_the_modellers_matrices_are_the_frame_as_drawn_on_fewer_bars(tmp_path: Path) -> None:
    trial = draw_trial(5, 0, plan=PLAN)
    setup = trial.scene.setup
    found = predictor_of(trial, tmp_path).predict(count=setup.modes).frequency
    assert found == pytest.approx(setup.nominal_hz[: setup.modes], rel=3e-4)
    coarse = replace(setup.nominal, elements=setup.elements[0])  # type: ignore[type-var]
    omega, _ = coarse.real_modes(setup.modes)
    assert found == pytest.approx(omega / (2 * np.pi), rel=1e-7)


@pytest.mark.parametrize(
    "name", ["local_stiffness", "local_mass", "joint", "clamp_rotation", "lumped_mass", "ground_spring"]
)
def test_what_is_hidden_is_what_the_library_says_at_its_values(name: str, tmp_path: Path) -> None:
    """The rig changes its bars, springs and bodies, the library the matrices that it was handed."""
    trial = draw_trial(5, 0, plan=PLAN)
    setup, hidden = trial.scene.setup, effects_of("frame")[name]
    rng = np.random.default_rng(3)
    values = hidden.draw(rng, setup, 1.0)
    body = hidden.act(nominal_scene(setup).with_body(elements=setup.elements[0]), values).body
    assert isinstance(body, Frame)
    omega, _ = body.real_modes(setup.modes)
    predictor = predictor_of(trial, tmp_path)
    more = {
        "clamp_rotation": {"direction": "ry"},
        "lumped_mass": {"z": 0.0, "bulk": 1.0},
        "ground_spring": {"z": 0.0, "extent": 0.0, "damping": 0.0},
    }.get(name, {})
    state = LIBRARY[name].state(predictor, {**values, **more})
    found, nominal = predictor.predict(state, count=setup.modes), predictor.predict(count=setup.modes)
    shift = np.log(omega / (2 * np.pi) / nominal.frequency)
    assert np.abs(shift).max() > 2e-3
    # a place without a test point has no static answer in the basis: within the effect's own idealisation
    allowed = np.abs(shift).max() * (0.04 if name in ("lumped_mass", "ground_spring") else 0.005)
    assert np.log(found.frequency / nominal.frequency) == pytest.approx(shift, abs=allowed)
    places = hidden.places(setup, values)
    assert len(places) == 1


@pytest.mark.long
def test_a_trial_repeats_and_its_files_tell_nothing_of_what_is_hidden(tmp_path: Path) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    for folder in (first, second):
        folder.mkdir()
        write_trial(draw_trial(5, 1, plan=PLAN), folder)
    names = sorted(path.name for path in first.iterdir())
    assert names == sorted(path.name for path in second.iterdir())
    for name in names:
        assert (first / name).read_bytes() == (second / name).read_bytes()
    truth = draw_trial(5, 1, plan=PLAN).truth
    other = draw_trial(6, 1, plan=PLAN)
    assert truth.kind == "frame"
    assert other.truth != truth
