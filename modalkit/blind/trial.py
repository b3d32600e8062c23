"""One blind trial: draw it, and write what the diagnosis may see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.errors import StudyError
from modalkit.blind.draw import draw_setup
from modalkit.blind.record import record
from modalkit.blind.scene import Scene, draw_scene
from modalkit.blind.setup import Setup
from modalkit.blind.study import study_text
from modalkit.blind.truths import MILD, SECRETS, Secret, theory_is_fit
from modalkit.blind.visibility import visibility

NONE_SHARE = 0.12
MILD_SHARE = 0.2
_ATTEMPTS = 2000


@dataclass(frozen=True)
class Truth:
    """What is hidden in one trial.

    Parameters
    ----------
    effect : str
        Name of the effect; ``none`` where there is none.
    parameters : dict
        Its parameters under the contract's names [SI].
    accepted : tuple of str
        Names that are right; empty for ``none`` and for effects that the library does not have.
    in_library : bool
        Whether the diagnosis is expected to know the effect.
    level : {"none", "mild", "clear"}
        Drawn severity.
    visibility : float
        Standard deviations by which the effect moves the data off what the tolerances allow [-].
    length : float
        Length of the model, for errors of place [m].
    """

    effect: str
    parameters: dict[str, float]
    accepted: tuple[str, ...]
    in_library: bool
    level: str
    visibility: float
    length: float

    def to_json(self) -> dict[str, Any]:
        """Return the truth as JSON can carry it."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}


@dataclass(frozen=True, eq=False)
class Trial:
    """A trial ready to be measured; it never leaves the process that drew it.

    Parameters
    ----------
    index : int
        Number of the trial [-].
    truth : Truth
        What is hidden.
    scene, before : Scene
        The rig with the effect, and before it was there.
    rng : numpy.random.Generator
        For the tests on it.
    """

    index: int
    truth: Truth
    scene: Scene
    before: Scene
    rng: np.random.Generator


def draw_trial(seed: int, index: int, *, effects: Sequence[str] | None = None) -> Trial:
    """Draw a trial; the same seed and index always give the same one.

    Parameters
    ----------
    seed, index : int
        Of the run, and of the trial in it.
    effects : sequence of str, optional
        Names to draw from instead of all; ``none`` among them keeps its share.

    Returns
    -------
    Trial
        The effect is drawn first, then specimens and tests until one can have it.

    Raises
    ------
    StudyError
        If a name is not one of the rig's.
    """
    choose, build, measure = np.random.default_rng([seed, index]).spawn(3)
    secret = _choose(choose, _pool(effects))
    strength = MILD if secret.graded and choose.random() < MILD_SHARE else 1.0
    setup = _fitting_setup(build, secret)
    parameters = secret.draw(build, setup, strength)
    before = draw_scene(setup, build)
    scene = secret.act(before, parameters)
    plain = before.with_beam(shear=False) if secret.name == "shear" else before
    truth = Truth(
        effect=secret.name,
        parameters={f"{secret.name}.{key}": float(value) for key, value in parameters.items()},
        accepted=secret.accepted,
        in_library=secret.in_library,
        level="none" if secret.name == "none" else "mild" if strength < 1.0 else "clear",
        visibility=visibility(scene, plain),
        length=setup.length,
    )
    return Trial(index, truth, scene, before, measure)


def _pool(effects: Sequence[str] | None) -> tuple[Secret, ...]:
    if effects is None:
        return SECRETS
    known = {secret.name: secret for secret in SECRETS}
    missing = [name for name in effects if name not in known]
    if missing or not effects:
        raise StudyError(f"the rig cannot hide {missing or 'nothing at all'}; it has: {', '.join(known)}")
    return tuple(known[name] for name in effects)


def _choose(rng: np.random.Generator, pool: tuple[Secret, ...]) -> Secret:
    others = [secret for secret in pool if secret.name != "none"]
    none = [secret for secret in pool if secret.name == "none"]
    if none and (not others or rng.random() < NONE_SHARE):
        return none[0]
    return others[int(rng.integers(len(others)))]


def _fitting_setup(rng: np.random.Generator, secret: Secret) -> Setup:
    for _ in range(_ATTEMPTS):
        setup = draw_setup(rng)
        if secret.name != "shear" and not theory_is_fit(setup, secret):
            setup = replace(setup, theory="timoshenko")
        if secret.applies(setup):
            return setup
    raise StudyError(f"no specimen for {secret.name!r} in {_ATTEMPTS} draws; widen the drawn range")


def write_trial(trial: Trial, folder: Path) -> Path:
    """Measure a trial and write study and test files.

    Parameters
    ----------
    trial : Trial
        What is on the rig.
    folder : Path
        An existing empty folder.

    Returns
    -------
    Path
        The study file. Nothing in the folder tells seed, index or truth.
    """
    setup = trial.scene.setup
    first, second = trial.rng.spawn(2)
    record(trial.scene, folder / "test.uff", rng=first)
    if setup.baseline:
        record(trial.before, folder / "baseline.uff", rng=second)
    study = folder / "study.toml"
    study.write_text(study_text(setup, test_file="test.uff", baseline_file="baseline.uff"), encoding="utf-8")
    return study
