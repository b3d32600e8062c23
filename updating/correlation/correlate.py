"""Test beside model: paired frequencies, MAC, what has no partner, FRAC."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from acquisition import Dof, FrfSet
from acquisition.arrays import FloatArray, IntArray
from acquisition.display import Displayed, counted
from acquisition.quantities import percent
from updating.case import Case
from updating.correlation.frfs import CorrelatedFrfs, correlate_frfs
from updating.nominal import predictor_of
from updating.prediction.assignment import frac_of_constants, mac_of_constants
from updating.prediction.matching import pair_modes
from updating.prediction.prediction import Prediction
from updating.simulation.identified import partners
from updating.test_data.measured import Measured
from updating.test_data.same_places import ALIGNED


@dataclass(frozen=True, eq=False)
class Correlation(Displayed):
    """How far a test and a model agree.

    Parameters
    ----------
    table : DataFrame
        One row per pair: test mode, model mode (from 1), their frequencies [Hz], error and sigma [%], MAC [-].
    mac : DataFrame
        MAC of every measured mode (rows) with every model mode (columns), numbered from 1; empty without
        shapes [-].
    unpaired_test : DataFrame
        Measured modes without a partner: mode and frequency [Hz].
    unpaired_model : DataFrame
        Model modes in the range of the test without a partner: mode and frequency [Hz].
    frac : DataFrame
        One row per FRF: nodes and directions of response and force, those of the force None where modes do not say
        it, and FRAC [-]: of the FRFs where these were given, else of the modal constants over the paired modes; empty
        where these have no level.
    warnings : tuple of str
        What the user should know.
    frfs : CorrelatedFrfs, optional
        The FRFs themselves, measured and the model's.
    """

    table: pd.DataFrame
    mac: pd.DataFrame
    unpaired_test: pd.DataFrame
    unpaired_model: pd.DataFrame
    frac: pd.DataFrame
    warnings: tuple[str, ...]
    frfs: CorrelatedFrfs | None = None

    @property
    def rms_percent(self) -> float:
        """R.m.s. frequency error over the pairs [%]."""
        return float(np.sqrt(np.mean(self.table["error [%]"] ** 2)))

    def _headline(self) -> str:
        return f"{percent(self.rms_percent)} r.m.s. frequency error over {counted(len(self.table), 'pair')}"


def correlate(case: Case, frfs: FrfSet | None = None) -> Correlation:
    """Compare a test with the nominal model, accepted effects included.

    Parameters
    ----------
    case : Case
        Test beside model.
    frfs : FrfSet, optional
        Measured FRFs; the model's are computed beside them, with the identified damping where the model gives none.

    Returns
    -------
    Correlation

    Raises
    ------
    EstimationError
        If no measured mode has a partner.
    StudyError
        If the FRFs are none of the case's.
    """
    predictor = predictor_of(case)
    prediction = predictor.predict()
    paired = pair_modes(case.measured, prediction)
    test, partner = paired.rows, partners(paired, prediction)
    both = None if frfs is None else correlate_frfs(frfs, case.measured, predictor, prediction, paired)
    return Correlation(
        _table(case.measured, prediction, test, partner),
        _mac_matrix(case.measured, prediction),
        _alone(case.measured.frequency, test, case.measured.frequency.max()),
        _alone(prediction.frequency, partner, prediction.frequency[partner].max()),
        _frac_table(_ends(paired.measured), frac_of_constants(paired.measured, prediction.select(partner)))
        if both is None
        else _frac_table([(*_end(r), *_end(f)) for r, f in _dofs(both.measured)], both.frac),
        (*case.measured.warnings, *paired.warnings),
        both,
    )


def _dofs(frfs: FrfSet) -> list[tuple[Dof, Dof]]:
    return list(zip(frfs.responses, frfs.references, strict=True))


def _table(measured: Measured, prediction: Prediction, test: IntArray, partner: IntArray) -> pd.DataFrame:
    f, model = measured.frequency[test], prediction.frequency[partner]
    sigma = np.sqrt((measured.frequency_sigma[test] / f) ** 2 + measured.repeatability**2)
    mac = np.full(len(test), np.nan)
    if measured.has_shapes:
        mac = mac_of_constants(measured, prediction)[test, partner]
    columns = {
        "test mode": test + 1,
        "model mode": partner + 1,
        "test [Hz]": f,
        "model [Hz]": model,
        "error [%]": 100 * (model / f - 1),
        "sigma [%]": 100 * sigma,
        "MAC": mac,
    }
    return pd.DataFrame(columns)


def _mac_matrix(measured: Measured, prediction: Prediction) -> pd.DataFrame:
    if not measured.has_shapes:
        return pd.DataFrame()
    matrix = mac_of_constants(measured, prediction)
    rows = pd.RangeIndex(1, matrix.shape[0] + 1, name="test mode")
    return pd.DataFrame(matrix, rows, pd.RangeIndex(1, matrix.shape[1] + 1, name="model mode"))


def _alone(frequency: FloatArray, paired: IntArray, top: float) -> pd.DataFrame:
    left = np.setdiff1d(np.flatnonzero(frequency <= top), paired)
    return pd.DataFrame({"mode": left + 1, "frequency [Hz]": frequency[left]})


def _end(dof: Dof) -> tuple[int, str]:
    return dof.node, str(dof).removeprefix(str(dof.node))


def _ends(measured: Measured) -> list[tuple[int, str, int | None, str | None]]:
    """Return nodes and directions of response and force of every FRF; None for the force of a mere shape."""
    every = [(n, _axis(measured, i)) for i, n in enumerate(measured.nodes)]
    pairs = zip(measured.seen.tolist(), measured.hit.tolist(), strict=True)
    return [(*every[s], *((None, None) if h < 0 else every[h])) for s, h in pairs]


def _axis(measured: Measured, point: int) -> str:
    """Return the model's axis along which a point is measured, ``+Z``; nothing of a skew one."""
    if measured.directions is None:
        return "+Z"
    along = measured.directions[point]
    axis = int(np.argmax(np.abs(along)))
    if abs(along[axis]) < ALIGNED:
        return ""
    return f"{'+' if along[axis] > 0 else '-'}{'XYZ'[axis]}"


def _frac_table(ends: Sequence[tuple[int, str, int | None, str | None]], values: FloatArray) -> pd.DataFrame:
    """Return one row per FRF; none where there are no values."""
    rows = [(*end, value) for end, value in zip(ends, values, strict=False)]
    columns = ["response", "response direction", "force", "force direction", "FRAC"]
    return pd.DataFrame(rows, columns=columns)
