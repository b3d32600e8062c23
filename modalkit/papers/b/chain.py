"""The chain behind paper B's tables: FRFs, modes, update by FRFs in two stages, and the updated model's own FRFs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from acquisition import FrfSet, InputError
from acquisition.arrays import ComplexArray, FloatArray
from acquisition.form import FORMS
from identification import ModalModel, frac, identify
from modalkit.papers.b.printed import FREQUENCY, STUDY
from modalkit.study.read import read_study
from modalkit.workflow.case import Session, open_study
from updating.models.state import State
from updating.nominal import predictor_of
from updating.prediction.assignment import mac_of_constants
from updating.prediction.predict import Predictor


@dataclass(frozen=True, eq=False)
class Taped:
    """The taped beam's test beside its model.

    Parameters
    ----------
    session : Session
        The study, without its baseline.
    """

    session: Session

    @cached_property
    def predictor(self) -> Predictor:
        """The study's model, observed from the points of the test."""
        return predictor_of(self.session.case)

    @property
    def regions(self) -> tuple[str, ...]:
        """Names of the model's regions."""
        return tuple(region.name for region in self.session.case.spec.regions)

    @property
    def frfs(self) -> FrfSet:
        """Measured FRFs in the band."""
        assert self.session.identified is not None
        return self.session.identified.frfs

    @property
    def identified(self) -> tuple[FloatArray, FloatArray]:
        """Identified frequencies [Hz] and damping ratios [-] of the published modes.

        Raises
        ------
        InputError
            If they were not all found.
        """
        measured = self.session.case.measured
        rows = _nearest(measured.frequency, np.array(FREQUENCY), str(self.session.study.path))
        return measured.frequency[rows], measured.damping[rows]

    def values(self, state: State) -> ComplexArray:
        """Return the model's FRFs beside the measured ones, (n_frf, n_lines) [unit of `frfs`]."""
        laplace = self.frfs.laplace
        return self.predictor.receptance(laplace, state) * laplace ** FORMS.index(self.frfs.form)

    def frac_of(self, state: State) -> FloatArray:
        """Return the FRAC of every receptance (n_frf,) [-]: Eq. 6 with the conjugate transpose."""
        back = self.frfs.laplace ** FORMS.index(self.frfs.form)
        return frac(self.frfs.values / back, self.values(state) / back)

    def modes_of(self, state: State) -> ModalModel:
        """Identify a model from its own FRFs at the points of the test, as the paper does."""
        own = replace(
            self.frfs,
            values=self.values(state),
            coherence=None,
            variance=None,
            scatter=None,
            averages=None,
            source="the model's own FRFs",
        )
        return identify(own)

    def damping_of(self, state: State) -> FloatArray:
        """Return the damping ratios of a model, identified from its own FRFs (n_modes,) [-]."""
        modal = self.modes_of(state).modal
        frequency = self.predictor.predict(state, count=len(FREQUENCY)).frequency
        found = np.asarray(modal.damping, dtype=np.float64)
        return np.asarray(found[_nearest(modal.frequency, frequency, "the model's own FRFs")])

    def frequency_of(self, state: State) -> FloatArray:
        """Return the natural frequencies of a model (n_modes,) [Hz]."""
        return self.predictor.predict(state, count=len(FREQUENCY)).frequency

    def mac_of(self, state: State) -> FloatArray:
        """Return the MAC of every published mode with its partner (n_modes,) [-]."""
        measured = self.session.case.measured
        rows = _nearest(measured.frequency, np.array(FREQUENCY), str(self.session.study.path))
        matrix = mac_of_constants(measured, self.predictor.predict(state, count=len(FREQUENCY)))
        return np.diag(matrix[rows]).copy()


def _nearest(found: FloatArray, wanted: FloatArray, source: str) -> np.ndarray:
    """Return which of the frequencies found stand for those wanted."""
    rows = np.array([int(np.argmin(np.abs(found - f))) for f in wanted])
    if len(set(rows.tolist())) < len(rows) or np.abs(found[rows] / wanted - 1).max() > 0.05:
        raise InputError(
            f"{source}: the modes at {', '.join(f'{f:.1f}' for f in wanted)} Hz were not all found"
        )
    return rows


def open_taped(folder: Path) -> Taped:
    """Identify the taped beam's test; the baseline has no part in the paper's tables."""
    study = read_study(folder / STUDY / "study.toml")
    return Taped(open_study(study, with_baseline=False))
