"""Write the files of a test on the user's own rig, with something hidden in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from modalkit.planning.cases import Case
from modalkit.planning.known import KnownTest
from modalkit.planning.responses import hidden
from modalkit.simulator.measurement import record
from modalkit.simulator.scene import Scene, draw_scene
from modalkit.simulator.setup import Setup
from modalkit.simulator.study_file import study_text


def write_case(case: Case | None, known_test: KnownTest, folder: Path, *, seed: list[int]) -> Path:
    """Draw a specimen within the tolerances, hide a case in it, and write raw hits and study.

    Parameters
    ----------
    case : Case or None
        What is hidden; None for nothing.
    known_test : KnownTest
        The test.
    folder : Path
        An empty one.
    seed : list of int
        Of all draws.

    Returns
    -------
    Path
        The study file.
    """
    build, first, second = np.random.default_rng(seed).spawn(3)
    before = draw_scene(known_test.setup, build)
    scene = before if case is None else hidden(case.family, before, case.q, case.place)
    return write_scene(scene, before, known_test, folder, rngs=(first, second))


def write_scene(
    scene: Scene,
    before: Scene,
    known_test: KnownTest,
    folder: Path,
    *,
    rngs: tuple[np.random.Generator, np.random.Generator],
) -> Path:  # fmt: skip
    """Write the files of a test, with modes alone where the user's data are no more.

    Parameters
    ----------
    scene, before : Scene
        The rig with and without what is hidden.
    known_test : KnownTest
        The test.
    folder : Path
        An empty one.
    rngs : two of numpy.random.Generator
        For the test and its baseline.
    """
    setup = known_test.setup
    ending = "uff" if known_test.shapes else "csv"
    names = {"test": (scene, rngs[0])} | ({"baseline": (before, rngs[1])} if setup.baseline else {})
    for name, (one, rng) in names.items():
        if known_test.shapes:
            record(one, folder / f"{name}.uff", rng=rng)
        else:
            _write_modes(one, known_test, folder / f"{name}.csv", rng)
    study = folder / "study.toml"
    text = study_text(
        setup,
        test_file=f"test.{ending}",
        baseline_file=f"baseline.{ending}",
        expects_damping=known_test.damping_known,
    )
    study.write_text(text, encoding="utf-8")
    return study


def _write_modes(scene: Scene, known_test: KnownTest, path: Path, rng: np.random.Generator) -> None:
    """Write frequencies as they would be identified after mounting anew."""
    setup = known_test.setup
    modes = scene.elastic().take(slice(0, setup.modes))
    known = np.resize(known_test.frequency, setup.modes)
    off = np.hypot(known, setup.repeatability) * rng.standard_normal(setup.modes)
    hertz = modes.frequency * (1 + off)
    lines = [f"{f:.8g},{f * s:.3g}" for f, s in zip(hertz, known, strict=True)]
    path.write_text("\n".join(["frequency,sigma", *lines]) + "\n", encoding="utf-8")


def noise_for(wanted: float, found: float, setup: Setup) -> float:
    """Return the channels' noise that makes constants as uncertain as wanted.

    Parameters
    ----------
    wanted, found : float
        Standard deviation wanted, and that found with the setup's own noise [-].
    setup : Setup
        With the noise that made ``found``.
    """
    return float(np.clip(setup.noise * wanted / found, 1e-5, 3e-2))
