"""A trial on the rig: a specimen that fits the case, what is hidden in it, and what is written of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cases.trial import Cause, Trial
from modalkit.blind.reading import FREQUENCY_SIGMA
from modalkit.blind.scoring.trials import VISIBLE
from modalkit.blind.visibility import shown
from modalkit.simulator.drawing.common import two_digits
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.drawing.specimen import draw_setup, lacks_shear
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.measurement import record, remounting
from modalkit.simulator.scene import Scene, draw_scene
from modalkit.simulator.setup import Setup
from modalkit.simulator.study_file import study_text

Values = Mapping[str, Any]
Record = Callable[[Scene, Path, np.random.Generator], str]
"""Measures a scene into a folder and returns the name of the file."""

TRIES = 20
"""So often specimen and effect are drawn anew where the rig's own model does not see the effect: what is no question of
the blind score is none here [-]."""

CLEAR = 1.0
"""Strength at which the rig draws what a case does not state: that of its clear effects [-]."""

SIZES = {
    "E": ("factor",),
    "orthotropy": ("ratio", "shear_ratio"),
    "lumped_mass": ("mass",),
    "sensor_mass": ("mass",),
    "local_stiffness": ("compliance",),
    "local_mass": ("mass",),
    "ground_spring": ("stiffness",),
    "joint_nonlinearity": ("slope",),
    "fluid_added_mass": ("fluid_density",),
    "damping_patch": ("loss_factor", "alpha", "beta"),
    "uniform_damping": ("alpha", "beta", "loss_factor"),
}
"""Of each effect what says how strong it is; those that are nothing in a trial do not count."""


def specimen(
    rng: np.random.Generator, *kinds: str, fits: Callable[[Setup], bool] = lambda setup: True
) -> Setup:
    """Draw a specimen and its test until one fits; no baseline, and a theory that lacks nothing that shows."""
    while True:
        setup = draw_setup(rng, plan=DrawRanges(kinds=kinds, baseline=0.0))
        if fits(setup):
            return replace(setup, theory="timoshenko") if lacks_shear(setup) else setup


def banded(setup: Setup, hertz: Sequence[float]) -> Setup:
    """Return a setup with the band for its first modes, whose frequencies are no longer those of the drawing [Hz]."""
    first, last = float(hertz[0]), float(hertz[setup.modes - 1])
    return replace(setup, band=(two_digits(0.25 * first), two_digits(1.1 * last)))


def hidden_values(rng: np.random.Generator, setup: Setup, name: str, stated: Values) -> dict[str, Any]:
    """Return what the rig draws of an effect, and in its place what a case states."""
    return {**HIDDEN_EFFECTS[name].draw(rng, setup, CLEAR), **stated}


def hits(scene: Scene, folder: Path, rng: np.random.Generator) -> str:
    """Hit the specimen; return the file of raw hits."""
    record(scene, folder / "test.uff", rng=rng)
    return "test.uff"


def frequencies_alone(scene: Scene, folder: Path, rng: np.random.Generator) -> str:
    """Measure frequencies and nothing else; return the table of those in the band."""
    true = scene.elastic().frequency
    true = true * remounting(scene.setup, len(true), rng)
    read = true * (1 + FREQUENCY_SIGMA * rng.standard_normal(len(true)))
    low, high = scene.setup.band
    rows = [f"{f:.6f},{FREQUENCY_SIGMA * f:.6f}" for f in read if low < f < high]
    (folder / "modes.csv").write_text("\n".join(["frequency,sigma", *rows]) + "\n", encoding="utf-8")
    return "modes.csv"


def on_rig(
    rng: np.random.Generator,
    folder: Path,
    setup: Setup,
    hidden: Mapping[str, Values],
    *,
    measured: Record = hits,
    equals: bool = True,
) -> Trial:
    """Put a specimen on the rig, hide what the case says, measure, and write the study.

    Parameters
    ----------
    rng : numpy.random.Generator
        Draws the specimen within its tolerances, what is not stated of the hidden effects, and all noise.
    folder : Path
        Takes the study and the test.
    setup : Setup
        What is stated.
    hidden : mapping
        Effects of the rig, in the order in which they act, to their parameters as far as the case states them.
    measured : callable
        How it is measured.
    equals : bool
        Whether a name that the rig takes for the same change of the data is as right.
    """
    for _ in range(TRIES):
        before = draw_scene(setup, rng)
        scene, causes = changed(rng, before, hidden, equals=equals)
        visible = shown(scene, before).length if hidden else 0.0
        if not hidden or visible >= VISIBLE:
            break
    file = measured(scene, folder, rng)
    text = study_text(setup, test_file=file, baseline_file="")
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return Trial(folder / "study.toml", causes, visible)


def changed(
    rng: np.random.Generator, before: Scene, hidden: Mapping[str, Values], *, equals: bool
) -> tuple[Scene, tuple[Cause, ...]]:
    """Return the specimen with what is hidden, and that as a right answer states it."""
    scene, causes = before, []
    for name, stated in hidden.items():
        effect, values = HIDDEN_EFFECTS[name], hidden_values(rng, before.setup, name, stated)
        scene = effect.act(scene, values)
        others = effect.equals(before.setup, values) if equals else ()
        sizes = {size: float(values[size]) for size in SIZES.get(name, ()) if values.get(size)}
        causes.append(Cause((name, *others), sizes))
    return scene, tuple(causes)
