"""One blind trial: draw it, and write what the diagnosis may see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np

from acquisition.errors import StudyError
from modalkit.blind.visibility import shown
from modalkit.simulator.block_model import write_block_model
from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.drawing.specimen import draw_setup, lacks_shear
from modalkit.simulator.frame_model import write_frame_model
from modalkit.simulator.hidden import HiddenEffect, Values
from modalkit.simulator.hidden.choose import (
    checked,
    choose_hidden_effects,
    choose_sort,
    draw_strength,
    right_answers,
)
from modalkit.simulator.matching import log_ratios
from modalkit.simulator.measurement import record
from modalkit.simulator.scene import Scene, draw_scene, nominal_scene
from modalkit.simulator.setup import Setup
from modalkit.simulator.study_file import study_text

_ATTEMPTS = 5000
_EVERYTHING = DrawRanges()


@dataclass(frozen=True, kw_only=True)
class Truth:
    """What is hidden in one trial.

    Parameters
    ----------
    kind : {"beam", "plate", "solid", "frame", "ribbed", "bracket"}
        Of the specimen.
    effects : tuple of str
        Hidden effects; empty for none.
    parameters : dict
        Their parameters as ``effect.parameter``, under the contract's names [SI]; lists of nodes for polarity
        and swapped_points.
    accepted : tuple of tuple of str
        Every set of names that is a right answer, each sorted; empty for none, and where the right answer is
        ``unknown``.
    in_library : bool
        Whether the diagnosis is expected to know every hidden effect.
    without : tuple of str
        Effects taken out of the library for this trial.
    severity : float
        Drawn strength, 1 for a clear effect; 0 for none [-].
    level : {"none", "mild", "clear", "strong"}
        The same in words.
    visibility : float
        Standard deviations by which the effect moves the data off what the tolerances allow [-].
    size : tuple of float
        Extents of the model [m].
    places : tuple of tuple of float
        Where the effects sit, in model axes [m].
    baseline : bool
        Whether there is a baseline.
    calibrated : bool
        Whether the FRFs have an absolute level.
    gap_percent : float
        R.m.s. gap between the frequencies of the nominal model and of the specimen [%].
    left_visible : float or None
        Standard deviations of the change that the best single effect of the library leaves, linearised; None where
        the library has all that is hidden [-].
    beside : tuple of float
        Where several effects are hidden, the standard deviations by which each of them moves the data off what the
        tolerances allow once the others are there; empty for one [-].
    """

    kind: str
    effects: tuple[str, ...]
    parameters: dict[str, Any]
    accepted: tuple[tuple[str, ...], ...]
    in_library: bool
    without: tuple[str, ...]
    severity: float
    level: str
    visibility: float
    size: tuple[float, ...]
    places: tuple[tuple[float, ...], ...]
    baseline: bool
    calibrated: bool
    gap_percent: float
    left_visible: float | None = None
    beside: tuple[float, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Return the truth as JSON can carry it."""
        document = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return {name: _listed(value) for name, value in document.items()}

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Self:
        """Return the truth that ``to_json`` gave."""
        fields = dict(document)
        for name in ("effects", "without", "size", "beside"):
            fields[name] = tuple(fields.get(name, ()))
        for name in ("accepted", "places"):
            fields[name] = tuple(tuple(entry) for entry in fields[name])
        return cls(**fields)


def _listed(value: Any) -> Any:
    return [_listed(entry) for entry in value] if isinstance(value, (list, tuple)) else value


@dataclass(frozen=True, eq=False)
class Trial:
    """A trial ready to be measured; it never leaves the process that drew it.

    Parameters
    ----------
    seed, index : int
        Of the run, and of the trial in it.
    truth : Truth
        What is hidden.
    scene, before : Scene
        The rig with the effect, and before it was there.
    """

    seed: int
    index: int
    truth: Truth
    scene: Scene
    before: Scene


def draw_trial(seed: int, index: int, *, plan: DrawRanges = _EVERYTHING) -> Trial:
    """Draw a trial; the same arguments always give the same one.

    Parameters
    ----------
    seed, index : int
        Of the run, and of the trial in it.
    plan : DrawRanges, optional
        What may be drawn.

    Returns
    -------
    Trial
        Specimen and test are drawn first, then an effect that they can have.

    Raises
    ------
    StudyError
        If the rig does not have a name of the plan, or no specimen can have it.
    """
    choose, build, specimen = np.random.default_rng([seed, index]).spawn(3)
    sort = choose_sort(choose, checked(plan))
    setup, hidden_effects = _setup_and_hidden_effects(build, choose, sort, plan)
    level, severity = draw_strength(choose, plan) if hidden_effects else ("none", 0.0)
    values = [hidden_effect.draw(choose, setup, severity) for hidden_effect in hidden_effects]
    if hidden_effects and not any(hidden_effect.graded for hidden_effect in hidden_effects):
        level, severity = "clear", 1.0
    before = draw_scene(setup, specimen)
    scene = before
    for hidden_effect, drawn in zip(hidden_effects, values, strict=True):
        scene = hidden_effect.act(scene, drawn)
    truth = _truth(plan, hidden_effects, values, scene, before, (level, severity))
    return Trial(seed, index, truth, scene, before)


def _setup_and_hidden_effects(
    build: np.random.Generator, choose: np.random.Generator, sort: str, plan: DrawRanges
) -> tuple[Setup, tuple[HiddenEffect, ...]]:
    for _ in range(_ATTEMPTS):
        setup = draw_setup(build, plan=plan)
        if lacks_shear(setup) and (
            sort not in ("single", "pair", "triple") or "shear" not in (plan.effects or ("shear",))
        ):
            setup = replace(setup, theory="timoshenko")
        hidden_effects = choose_hidden_effects(choose, setup, sort, plan)
        if hidden_effects is not None:
            return setup, hidden_effects
    raise StudyError(
        f"no specimen in {_ATTEMPTS} draws can have {', '.join(plan.effects)}; name more effects"
    )


def _truth(
    plan: DrawRanges,
    hidden_effects: Sequence[HiddenEffect],
    values: Sequence[Values],
    scene: Scene,
    before: Scene,
    strength: tuple[str, float],
) -> Truth:
    setup = scene.setup
    seen = shown(scene, _plain(before, hidden_effects))
    in_library = all(s.in_library for s in hidden_effects)
    named = list(zip(hidden_effects, values, strict=True))
    without = tuple(s.known_as for s in hidden_effects if s.known_as is not None) if plan.leave_out else ()
    return Truth(
        kind=setup.kind,
        effects=tuple(s.name for s in hidden_effects),
        parameters={
            f"{s.known_as or s.name}.{key}": float(value) if isinstance(value, np.floating) else value
            for s, drawn in named
            for key, value in s.stated(setup, drawn).items()
            if not isinstance(value, str)
        },
        accepted=right_answers(hidden_effects, values, setup, without),
        in_library=in_library,
        without=without,
        severity=strength[1],
        level=strength[0],
        visibility=seen.length,
        size=setup.size,
        places=tuple(place for s, drawn in named for place in s.places(setup, drawn)),
        baseline=setup.baseline,
        calibrated=setup.calibrated,
        gap_percent=gap_percent(scene),
        left_visible=None if in_library and not without else seen.left(without),
        beside=_each_beside_the_others(scene, before, named),
    )


def _each_beside_the_others(
    scene: Scene, before: Scene, named: Sequence[tuple[HiddenEffect, Values]]
) -> tuple[float, ...]:
    """Return how plainly each of several effects stands in the data beside the others [-]."""
    if len(named) < 2:
        return ()
    without = []
    for i, one in enumerate(named):
        rest = _plain(before, [one[0]])
        for effect, drawn in (*named[:i], *named[i + 1 :]):
            rest = effect.act(rest, drawn)
        without.append(rest)
    return tuple(shown(scene, rest).length for rest in without)


def _plain(before: Scene, hidden_effects: Sequence[HiddenEffect]) -> Scene:
    """Return the specimen as the model would have it if nothing were hidden."""
    return before.with_body(shear=False) if any(s.name == "shear" for s in hidden_effects) else before


def gap_percent(scene: Scene) -> float:
    """Return the r.m.s. gap of the nominal model's frequencies over a specimen's [%].

    Parameters
    ----------
    scene : Scene
        With whatever is hidden; the modes are those that the band was chosen for.
    """
    setup = scene.setup
    nominal = nominal_scene(setup)
    if setup.theory not in ("timoshenko", ""):
        nominal = nominal.with_body(shear=False)
    model = nominal.elastic().take(slice(0, setup.modes))
    return float(100 * np.sqrt(np.mean(np.expm1(-log_ratios(model, scene.elastic())) ** 2)))


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
        The study file. Nothing in the folder reveals seed, index or truth; the same trial gives the same files.
    """
    setup = trial.scene.setup
    first, second = np.random.default_rng([trial.seed, trial.index, 1]).spawn(2)
    record(trial.scene, folder / "test.uff", rng=first)
    if setup.baseline:
        record(trial.before, folder / "baseline.uff", rng=second)
    study = folder / "study.toml"
    model = None
    if isinstance(setup.nominal, Frame):
        model = write_frame_model(setup.nominal, setup.elements[0], folder)
    if isinstance(setup.nominal, Block):
        model = write_block_model(setup.nominal, setup.elements[0], folder)
    text = study_text(setup, test_file="test.uff", baseline_file="baseline.uff", model=model)
    study.write_text(text, encoding="utf-8")
    return study
