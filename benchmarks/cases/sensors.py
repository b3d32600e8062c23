"""A beam with eleven accelerometers, hit at a few points; one of them is off."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from acquisition import Dof, Geometry, hammer_test, write_uff
from acquisition.synthetic import ModalSystem
from cases.rig import specimen
from cases.trial import Cause, Trial
from modalkit.simulator.conduct import draw_conduct
from modalkit.simulator.measurement import hammer_plan, remounting, scaled
from modalkit.simulator.scene import draw_scene
from modalkit.simulator.setup import Setup
from modalkit.simulator.study_file import study_text

SENSORS, HITS = 11, 2
OFF = 0.21
"""By how much one of them reads too little or too much [-]."""


def stretched(rng: np.random.Generator, setup: Setup) -> Setup:
    """Return a test with eleven points along the beam, unevenly, each with an accelerometer of no weight."""
    free = {"x0": "x0" not in setup.clamped, "x1": "x1" not in setup.clamped}
    even = np.arange(1 - free["x0"], SENSORS + 1 - free["x0"]) / (SENSORS + 1 - free["x0"] - free["x1"])
    inner = (even > 0) & (even < 1)
    places = setup.length * (even + inner * rng.uniform(-0.2, 0.2, SENSORS) / SENSORS)
    points = tuple((round(float(x), 3),) for x in places)
    return replace(setup, points=points, sensor=SENSORS - 1, sensor_mass=0.0, drive=True)


def one_off(rng: np.random.Generator, folder: Path) -> Trial:
    """Hit two of the points; the study states eleven sensors of one calibration."""
    setup = stretched(rng, specimen(rng, "beam"))
    scene = draw_scene(setup, rng)
    modes = scene.modes()
    modes = scaled(modes, remounting(setup, len(modes.poles), rng))
    hit = np.sort(rng.choice(SENSORS, HITS, replace=False))
    wrong, gain = int(rng.integers(SENSORS)), float(1 + rng.choice([-OFF, OFF]))
    seen = modes.points * np.where(np.arange(SENSORS) == wrong, gain, 1.0)[:, None]
    slopes = np.zeros((2, SENSORS, HITS, len(modes.poles)), complex)
    slopes[0] = seen[:, None] * modes.slopes[0, hit]
    nodes = tuple(Dof(i + 1, 3) for i in range(SENSORS))
    system = ModalSystem(
        modes.poles, seen[:, None] * modes.points[hit], nodes, tuple(nodes[i] for i in hit), slopes
    )
    plan = hammer_plan(scene, modes, rng, draw_conduct(HITS, rng))
    coordinates = np.zeros((SENSORS, 3))
    coordinates[:, 0] = setup.places[:, 0]
    geometry = Geometry(tuple(range(1, SENSORS + 1)), coordinates)
    plan = replace(plan, bad={at: fault for at, fault in plan.bad.items() if at[0] < HITS})
    test = replace(hammer_test(system, plan, rng=rng, geometry=geometry), decay=setup.window)
    write_uff(folder / "test.uff", tests=[test], geometry=geometry, title=setup.title, precision="single")
    text = study_text(setup, test_file="test.uff", baseline_file="")
    (folder / "study.toml").write_text(text, encoding="utf-8")
    places = (str(nodes[wrong]), (wrong + 1,))
    return Trial(folder / "study.toml", (Cause(("channel_gain",), {"gain": gain}, places),))
