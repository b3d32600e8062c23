"""A synthetic hammer test of a study's model, with effects in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from acquisition import FrfSet, HammerTest, estimate_frfs, hammer_test, judge_hits, write_uff
from acquisition.arrays import ComplexArray, FloatArray
from acquisition.display import Displayed
from acquisition.errors import InputError
from modalkit.simulation.damping import damped_spec
from modalkit.simulation.measured import rig_of_data
from modalkit.simulation.planned import rig_of_model
from modalkit.simulation.setup import SAMPLING, MeasurementSetup, Options
from modalkit.simulation.systems import drifting, known_sensors, remounted, systems
from modalkit.study.named_effects import EffectValues, check_effect, departure, effects_text
from modalkit.study.read import Study, read_study
from modalkit.workflow.case import Session, open_study
from modalkit.workflow.joining import together
from updating import Predictor, Spec
from updating.models.state import State
from updating.prediction.stretch import is_placed
from updating.simulation import damped_modes, simulated
from updating.test_data.chain import measurement_chain


@dataclass(frozen=True, eq=False)
class SimulatedTest(Displayed):
    """A synthetic hammer test, with what stands behind it.

    Parameters
    ----------
    title : str
        What was simulated, in one line.
    tests : tuple of HammerTest
        Raw hits; points that share their responses are one test.
    effects : tuple of (name, values)
        What is in the model beyond the study's own.
    test_setup : MeasurementSetup
        How it was tested.
    poles : (n_modes,) complex array
        Poles in the band as a test without noise would find them: unknown windows included [rad/s].
    notes : tuple of str
        What was not the study's, and what the user should know.
    """

    title: str
    tests: tuple[HammerTest, ...]
    effects: tuple[EffectValues, ...]
    test_setup: MeasurementSetup
    poles: ComplexArray
    notes: tuple[str, ...]

    def table(self) -> pd.DataFrame:
        """Return one row per mode of the band: frequency [Hz] and damping ratio [%]."""
        size = np.abs(self.poles)
        columns = {"frequency [Hz]": size / (2 * np.pi), "damping [%]": -100 * self.poles.real / size}
        return pd.DataFrame(columns, index=pd.RangeIndex(1, len(size) + 1, name="mode"))

    def frfs(self) -> FrfSet:
        """Average the hits to FRFs, as the program does with any, up to the end of the usable lines."""
        sets = [estimate_frfs(test, verdicts=judge_hits(test)) for test in self.tests]
        return together(sets).band(0.0, self.test_setup.plan.rate / SAMPLING)

    def write(self, path: Path | str, *, as_frfs: bool = False) -> None:
        """Write a universal file of raw hits, or of FRFs with their coherence; whole or not at all."""
        if as_frfs:
            write_uff(
                path,
                frfs=self.frfs(),
                geometry=self.test_setup.geometry,
                title=self.title,
                precision="single",
            )
        else:
            write_uff(
                path,
                tests=self.tests,
                geometry=self.test_setup.geometry,
                title=self.title,
                precision="single",
            )

    def _headline(self) -> str:
        return f"{self.title}: {'; '.join(test._headline() for test in self.tests)}"


@dataclass(frozen=True, eq=False)
class Prepared(Displayed):
    """A study made ready to be hit on a computer, as often as one likes.

    Parameters
    ----------
    study : Study
        The study.
    nominal : Predictor
        Its model with some damping, seen from the points of the rig; accepted effects are not in it yet.
    test_setup : MeasurementSetup
        How it is hit.
    options : Options
        What the user stated in place of the study.
    notes : tuple of str
        What was not the study's.
    """

    study: Study
    nominal: Predictor
    test_setup: MeasurementSetup
    options: Options
    notes: tuple[str, ...]


def prepare(study: Study, options: Options | None = None) -> Prepared:
    """Work out how a study's structure is hit, and what damps its model.

    Parameters
    ----------
    study : Study
        Where its test has hits or FRFs, these determine points, directions, band, hits, records, window and noise; its
        baseline is left aside.
    options : Options, optional
        What the user states in place of the study.

    Raises
    ------
    StudyError
        If the study has no model.
    """
    given = options or Options()
    session = None
    if study.test.files or study.test.modes is not None:
        session = open_study(study, with_baseline=False)
    spec, notes = damped_spec(study, session)
    test_setup = _rig(study, spec, session, given)
    nominal = Predictor(spec, test_setup.measured, study.surroundings())
    return Prepared(study, nominal, test_setup, given, (*test_setup.notes, *notes))


def simulate_test(
    study: Study | Prepared | Path | str,
    effects: Sequence[EffectValues] = (),
    *,
    seed: int = 0,
    options: Options | None = None,
) -> SimulatedTest:
    """Hit a study's model on a computer, with effects in it, as the study's own test hit the structure.

    Parameters
    ----------
    study : Study, Prepared or path
        Its model is hit, accepted effects included.
    effects : sequence of (name, values)
        Effects put into the model and into the measurement; values in the units of ``modalkit effects``.
    seed : int
        Seed of all scatter and noise.
    options : Options, optional
        What the user states in place of the study; a prepared one has its own.

    Raises
    ------
    StudyError
        If the study has no model, or an effect does not fit it.
    """
    study = read_study(study) if isinstance(study, Path | str) else study
    ready = study if isinstance(study, Prepared) else prepare(study, options)
    test_setup, nominal, rng = ready.test_setup, ready.nominal, np.random.default_rng(seed)
    whole: tuple[EffectValues, ...] = (*ready.study.accepted(), *effects)
    for i, (name, values) in enumerate(whole):
        own = i < len(whole) - len(effects)
        check_effect(nominal, name, values, where="[[model.effect]]" if own else "--effect")
    departures = [
        *known_sensors(ready.study, test_setup),
        *(departure(name, values) for name, values in sorted(whole, key=lambda entry: is_placed(entry[1]))),
    ]
    state = nominal.for_test(nominal.measured, (*nominal.additions, *departures)).base
    model = simulated(nominal, *departures, points=_places(test_setup, state))
    modes = damped_modes(model.hung())
    factors, level = np.ones(len(modes.poles)), 1.0
    if ready.options.remount:
        factors, level = _mounting(ready.study, len(factors), rng)
    plan = replace(
        test_setup.plan,
        decay=test_setup.plan.decay + model.decay,
        gain=test_setup.plan.gain * model.gain * level,
    )
    title = f"simulated, {ready.study.name}: {effects_text(effects)}; seed {seed}"
    hit = [remounted(system, factors) for system in systems(model.hung(), test_setup, state)]
    tests = [
        hammer_test(system, plan, rng=rng, geometry=test_setup.geometry, at_hit=at_hit)
        for system, at_hit in zip(hit, drifting(hit, state.drift), strict=True)
    ]
    poles = modes.poles * factors - model.decay
    inside = (poles.imag > 2 * np.pi * test_setup.band[0]) & (poles.imag < 2 * np.pi * test_setup.band[1])
    notes = ready.notes
    if model.rigid:
        notes = (*notes, f"free: hung on cords, rigid-body modes at {_listed(poles[: model.rigid])} Hz")
    stated = tuple(replace(test, decay=test_setup.plan.decay, source=title) for test in tests)
    return SimulatedTest(title, stated, tuple(effects), replace(test_setup, plan=plan), poles[inside], notes)


def _places(test_setup: MeasurementSetup, state: State) -> FloatArray | None:
    """Return all places from which the model is seen where some are not those stated [m]."""
    return measurement_chain(test_setup.measured, state).points if state.moved else None


def _mounting(study: Study, count: int, rng: np.random.Generator) -> tuple[FloatArray, float]:
    """Draw the factors of the frequencies and of the level that one mounting and one calibration make."""
    scatter = 1.0 + study.test.repeatability * rng.standard_normal(count)
    return scatter, float(np.exp(study.test.calibration * rng.standard_normal()))


def _rig(study: Study, spec: Spec, session: Session | None, options: Options) -> MeasurementSetup:
    if session is not None and session.processed is not None:
        if options.points is not None:
            raise InputError(
                f"--points {options.points}: the study's own test states which points; leave it out"
            )
        return rig_of_data(session, options)
    return rig_of_model(study, spec, None if session is None else session.case.measured, options)


def _listed(poles: ComplexArray) -> str:
    return ", ".join(f"{abs(p) / (2 * np.pi):.3g}" for p in poles)
