"""Measured FRFs in the coordinates of the model: the data side of updating by FRFs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.display import Displayed
from acquisition.errors import StudyError
from acquisition.form import FORMS
from acquisition.frfs.frf import FrfSet
from identification import ModalModel
from identification.arrangement import signs
from identification.fit.noise.levels import from_statistics, scatter
from updating.test_data.measured import Measured


@dataclass(frozen=True, eq=False)
class MeasuredFrfs(Displayed):
    """Receptances of a test between points of the model, along its axes.

    Parameters
    ----------
    laplace : (n_lines,) complex array
        Where in the Laplace plane the lines lie, i omega + the decay of a window that is still in them [1/s].
    values : (n_frf, n_lines) complex array
        Receptances [m/N].
    variance : (n_frf, n_lines) array
        Variance E|dH|^2 of each value: from the hits or the coherence, else from what the modal fit leaves
        [m^2/N^2].
    seen, hit : (n_frf,) int arrays
        Point of the response and of the force of each FRF, numbered as in the test's :class:`Measured`.
    source : str
        Where they came from, for messages.
    order : int
        How often the measured motion was integrated to a displacement, by the window that is stated [-].
    """

    laplace: ComplexArray
    values: ComplexArray
    variance: FloatArray
    seen: IntArray
    hit: IntArray
    source: str = ""
    order: int = 0

    @property
    def frequency(self) -> FloatArray:
        """Frequency of the lines [Hz]."""
        return np.asarray(self.laplace.imag / (2 * np.pi))

    def pairs(self) -> list[tuple[int, int]]:
        """Return the points of response and force of every FRF."""
        return list(zip(self.seen.tolist(), self.hit.tolist(), strict=True))

    def select(self, rows: IntArray) -> MeasuredFrfs:
        """Return some of the FRFs."""
        return replace(
            self,
            values=self.values[rows],
            variance=self.variance[rows],
            seen=self.seen[rows],
            hit=self.hit[rows],
        )

    def lines(self, keep: BoolArray | IntArray) -> MeasuredFrfs:
        """Return the same FRFs on some of their lines."""
        return replace(
            self,
            laplace=self.laplace[keep],
            values=self.values[:, keep],
            variance=self.variance[:, keep],
        )


def measured_frfs(identified: ModalModel, measured: Measured) -> MeasuredFrfs:
    """Take the FRFs that were identified to the model's axes, as receptances.

    Parameters
    ----------
    identified : ModalModel
        With the FRFs in its band.
    measured : Measured
        What :func:`updating.measured_from_identified` made of it.

    Returns
    -------
    MeasuredFrfs
        A line at s = 0, where receptances of a free structure do not exist, is left out.

    Raises
    ------
    StudyError
        If the modes are none that were identified from these FRFs.
    """
    frfs, fit = identified.frfs, identified.synthesise()
    variance = from_statistics(frfs, fit.values)
    if variance is None:
        variance = np.tile(scatter(frfs.values - fit.values)[:, None], frfs.values.shape[1])
    rows, fine, turned = _to_model(identified, measured)
    return MeasuredFrfs(
        frfs.laplace[fine],
        frfs.values[rows][:, fine] * turned,
        variance[rows][:, fine] * np.abs(turned) ** 2,
        measured.seen,
        measured.hit,
        frfs.source,
        FORMS.index(frfs.form),
    )


def _to_model(identified: ModalModel, measured: Measured) -> tuple[IntArray, BoolArray, ComplexArray]:
    """Return which FRFs and lines are kept, and what takes a value to a receptance along the model's axes."""
    if measured.rows is None or measured.signs is None:
        raise StudyError(
            f"{measured.title or 'test'}: updating by FRFs needs measured FRFs; give files in [test]"
        )
    frfs = identified.frfs
    fine = np.abs(frfs.laplace) > 0
    to_receptance = 1 / frfs.laplace[fine] ** FORMS.index(frfs.form)
    return measured.rows, fine, (signs(frfs)[measured.rows] * measured.signs)[:, None] * to_receptance


def redrawn(frfs: MeasuredFrfs, identified: ModalModel, measured: Measured, drawn: FrfSet) -> MeasuredFrfs:
    """Return the FRFs of hits drawn anew in place of the measured ones.

    Parameters
    ----------
    frfs, identified, measured : MeasuredFrfs, ModalModel, Measured
        The test, as for :func:`measured_frfs`.
    drawn : FrfSet
        FRFs between the same degrees of freedom, in the same form and on lines that hold those identified.

    Raises
    ------
    StudyError
        If a degree of freedom or a line is missing.
    """
    names = {pair: i for i, pair in enumerate(zip(drawn.responses, drawn.references, strict=True))}
    own = list(zip(identified.frfs.responses, identified.frfs.references, strict=True))
    first = int(np.argmin(np.abs(drawn.frequency - identified.frfs.frequency[0])))
    last = first + len(identified.frfs.frequency)
    if not set(own) <= set(names) or last > len(drawn.frequency) or drawn.form != identified.frfs.form:
        raise StudyError(f"{drawn.source}: the FRFs of this draw are not those that were identified")
    kept, fine, turned = _to_model(identified, measured)
    rows = [names[pair] for pair in own]
    values = drawn.values[rows][:, first:last][kept]
    return replace(frfs, values=values[:, fine] * turned)
