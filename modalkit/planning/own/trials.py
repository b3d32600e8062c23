"""Trials on a study's own model: hits of the model with something in it, and the diagnosis of these."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from modalkit.blind.answer import Answer, read_answer
from modalkit.output.documents import diagnosis_document
from modalkit.output.whole import plain
from modalkit.planning.design import Design
from modalkit.simulation.setup import Options
from modalkit.simulation.simulate import Prepared, SimulatedTest, simulate_test
from modalkit.study.named_effects import EffectValues
from modalkit.study.read import Study
from modalkit.study.tables import MeasurementTable
from modalkit.workflow.diagnosis import diagnose_studies
from updating.effects import LIBRARY
from updating.problem.specimen import SpecimenProblem

if TYPE_CHECKING:
    from modalkit.planning.case import Case

SEED_BITS = 63

REMOUNTED = Options(remount=True)
"""The structure is mounted anew in every test."""

CHAIN_AS_STATED = 1e-12
"""Calibration of a prepared study whose chain is drawn with the specimen [-]."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A test that can be made as often as one likes.

    Parameters
    ----------
    study : Study
        As the user would have it.
    ready : Prepared
        The study made ready to be hit.
    design : Design
        What the test has.
    problem : SpecimenProblem
        Doubts in the specimen, and how well its frequencies are identified.
    """

    study: Study
    ready: Prepared
    design: Design
    problem: SpecimenProblem

    def diagnosed(self, case: Case, seed: list[int]) -> Answer:
        """Hit a specimen with a case in it, and have the hits, or the modes, diagnosed.

        Parameters
        ----------
        case : Case
            What is hidden.
        seed : list of int
            Of the specimen, all scatter and noise.
        """
        with tempfile.TemporaryDirectory(prefix="test-", ignore_cleanup_errors=True) as folder:
            study = self.write([(case.family.cause, case.values)], Path(folder), seed=seed)
            return read_answer(plain(diagnosis_document(diagnose_studies([study]))))

    def write(self, hidden: Sequence[EffectValues], folder: Path, *, seed: list[int]) -> Study:
        """Draw a specimen within the tolerances, test it, and return the study of that test.

        Parameters
        ----------
        hidden : sequence of (name, values)
            What is in it in the test and was not in the baseline.
        folder : Path
            Where the data are written.
        seed : list of int
            Of all draws.
        """
        build, first, second = np.random.default_rng(seed).spawn(3)
        drawn = tuple(specimen(self.problem, self.design.calibration, build))
        study = self.study.model_copy(
            update={"test": self._tested("test", (*drawn, *hidden), folder, first), "baseline": None}
        )
        if self.design.baseline:
            study = study.model_copy(update={"baseline": self._tested("baseline", drawn, folder, second)})
        return study

    def _tested(
        self, name: str, effects: Sequence[EffectValues], folder: Path, rng: np.random.Generator
    ) -> MeasurementTable:
        """Return the table of a test whose data are written."""
        ready = self.ready if self.design.shapes else _unlimited(self.ready)
        made = simulate_test(ready, effects, seed=int(rng.integers(2**SEED_BITS)))
        table: dict[str, Any] = {"files": [], "modes": None, "layout": None, "points": [], "sensor": None}
        if self.design.shapes:
            path = (folder / f"{name}.uff").absolute()
            tests = tuple(replace(one, source=name) for one in made.tests)
            replace(made, title=self.study.name, tests=tests).write(path)
            table["files"] = [str(path)]
        else:
            path = (folder / f"{name}.csv").absolute()
            self._write_modes(made, path, rng)
            table["modes"] = str(path)
        return self.study.test.model_copy(update=table)

    def _write_modes(self, made: SimulatedTest, path: Path, rng: np.random.Generator) -> None:
        """Write the frequencies as they would be identified: so many from the lower edge of the band on."""
        test = self.problem.measured
        hertz = np.sort(np.abs(made.poles))[: self.design.modes] / (2 * np.pi)
        sigma = self.design.noise * (test.frequency_sigma / test.frequency)[: len(hertz)]
        hertz = hertz * (1 + sigma * rng.standard_normal(len(hertz)))
        lines = [f"{f:.8g},{f * s:.3g}" for f, s in zip(hertz, sigma, strict=True)]
        path.write_text("\n".join(["frequency,sigma", *lines]) + "\n", encoding="utf-8")


def _unlimited(ready: Prepared) -> Prepared:
    """Return a study whose modes are listed to any frequency.

    A test of frequencies alone states how many modes it has; a stiffer specimen lifts the last out of the band.
    """
    band = (ready.test_setup.band[0], np.inf)
    return replace(ready, test_setup=replace(ready.test_setup, band=band))


def drawn_chain(study: Study) -> Study:
    """Return a study whose level does not scatter from test to test: the chain is drawn with the specimen."""
    return study.model_copy(update={"test": study.test.model_copy(update={"calibration": CHAIN_AS_STATED})})


def specimen(
    problem: SpecimenProblem, calibration: float, rng: np.random.Generator
) -> Iterator[EffectValues]:
    """Draw what is off on a specimen and on the chain, within what the study doubts.

    Parameters
    ----------
    problem : SpecimenProblem
        Doubts of the study.
    calibration : float
        Relative standard deviation of the level [-].
    rng : numpy.random.Generator
        For the draws.
    """
    predictor = problem.predictor
    for doubted, sigma in zip(problem.names, problem.sigmas.tolist(), strict=True):
        drawn = sigma * float(rng.standard_normal())
        name = "section_scale" if doubted == "width" else doubted
        if name not in LIBRARY or LIBRARY[name].why_not(predictor) is not None:
            continue
        if name == "length":
            yield name, {"extension": predictor.spec.length * drawn}
        else:
            yield name, {"factor": float(np.exp(drawn))}
    yield "calibration_gain", {"gain": float(np.exp(calibration * rng.standard_normal()))}
