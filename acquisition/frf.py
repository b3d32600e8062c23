"""Frequency response functions of one test, with what is known of their quality."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
import pandas as pd

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen_array
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.geometry import Geometry

Form = Literal["receptance", "mobility", "accelerance"]
FORMS: tuple[Form, ...] = ("receptance", "mobility", "accelerance")
UNITS: dict[Form, str] = {"receptance": "m/N", "mobility": "m/(N s)", "accelerance": "1/kg"}


@dataclass(frozen=True, eq=False)
class FrfSet:
    """A set of FRFs on one frequency axis, each between a response and a reference.

    Parameters
    ----------
    frequency : (n_lines,) array
        Evenly spaced frequency lines [Hz].
    values : (n_frf, n_lines) complex array
        FRFs [m/N, m/(N s) or 1/kg, by ``form``].
    responses, references : tuple of Dof, length n_frf
        Where each FRF was measured and where it was excited. Signs of the directions are as in the file:
        they are *not* yet applied to ``values``.
    form : {"receptance", "mobility", "accelerance"}
        Displacement, velocity or acceleration per force.
    coherence : (n_frf, n_lines) array, optional
        Ordinary coherence [-].
    variance : (n_frf, n_lines) array, optional
        Variance E|dH|^2 of each mean FRF value, from the scatter of the hits [unit of ``values`` squared].
    averages : (n_frf,) int array, optional
        Number of hits averaged.
    decay : float
        Decay rate of an exponential window that is still in the FRFs [1/s]: they are samples of
        H(i omega + decay).
    geometry : Geometry
        Nodes of the test.
    source : str
        Where the FRFs came from, for messages.

    Raises
    ------
    InputError
        If shapes disagree, the frequency axis is uneven, or values are not finite.
    """

    frequency: FloatArray
    values: ComplexArray
    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    form: Form = "accelerance"
    coherence: FloatArray | None = None
    variance: FloatArray | None = None
    averages: IntArray | None = None
    decay: float = 0.0
    geometry: Geometry = field(default_factory=Geometry.empty)
    source: str = "arrays"

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency", frozen_array(self.frequency))
        object.__setattr__(self, "values", frozen_array(self.values, np.complex128))
        object.__setattr__(self, "responses", tuple(self.responses))
        object.__setattr__(self, "references", tuple(self.references))
        n_frf, n_lines = len(self.responses), len(self.frequency)
        for name, dtype in (("coherence", np.float64), ("variance", np.float64), ("averages", np.int64)):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen_array(value, dtype))
        self._check(n_frf, n_lines)

    def _check(self, n_frf: int, n_lines: int) -> None:
        if self.form not in FORMS:
            raise InputError(f"{self.source}: unknown FRF form {self.form!r}; use one of {', '.join(FORMS)}")
        if n_frf == 0 or n_lines < 2:
            raise InputError(f"{self.source}: {n_frf} FRFs of {n_lines} lines; nothing to work on")
        if len(self.references) != n_frf or self.values.shape != (n_frf, n_lines):
            raise InputError(
                f"{self.source}: values have shape {self.values.shape} but there are {n_frf} responses, "
                f"{len(self.references)} references and {n_lines} frequency lines"
            )
        for name in ("coherence", "variance"):
            value = getattr(self, name)
            if value is not None and value.shape != self.values.shape:
                raise InputError(f"{self.source}: {name} has shape {value.shape}, not {self.values.shape}")
        steps = np.diff(self.frequency)
        if steps.min() <= 0 or np.ptp(steps) > 1e-3 * steps.mean():
            raise InputError(f"{self.source}: the frequency axis is not evenly spaced; resample it first")
        bad = ~np.isfinite(self.values).all(axis=1)
        if bad.any():
            names = ", ".join(f"{self.responses[i]}/{self.references[i]}" for i in np.flatnonzero(bad)[:5])
            raise InputError(f"{self.source}: values that are not finite in FRF {names}; leave them out")

    @property
    def df(self) -> float:
        """Frequency spacing [Hz]."""
        return float((self.frequency[-1] - self.frequency[0]) / (len(self.frequency) - 1))

    @property
    def unit(self) -> str:
        """Unit of ``values``."""
        return UNITS[self.form]

    @property
    def laplace(self) -> ComplexArray:
        """Where in the Laplace plane the lines lie, i omega + decay, shape (n_lines,) [1/s]."""
        return np.asarray(2j * np.pi * self.frequency + self.decay, dtype=np.complex128)

    def band(self, low: float, high: float) -> FrfSet:
        """Return the lines with low <= f <= high [Hz].

        Raises
        ------
        InputError
            If the band holds fewer than two lines.
        """
        if not 0 <= low < high:
            raise InputError(
                f"the band {low:g} to {high:g} Hz is none: give its lower limit first, not below 0"
            )
        keep = (self.frequency >= low - 1e-9) & (self.frequency <= high + 1e-9)
        if keep.sum() < 2:
            raise InputError(
                f"{self.source}: the band {low:g}-{high:g} Hz holds {int(keep.sum())} lines; the data run "
                f"from {self.frequency[0]:g} to {self.frequency[-1]:g} Hz"
            )
        return self._lines(keep)

    def _lines(self, keep: BoolArray) -> FrfSet:
        cut: dict[str, Any] = {
            name: None if getattr(self, name) is None else getattr(self, name)[:, keep]
            for name in ("values", "coherence", "variance")
        }
        return replace(self, frequency=self.frequency[keep], **cut)

    def select(self, index: list[int] | IntArray) -> FrfSet:
        """Return some of the FRFs, by their row numbers."""
        rows = [int(i) for i in index]
        cut: dict[str, Any] = {
            name: None if getattr(self, name) is None else getattr(self, name)[rows]
            for name in ("values", "coherence", "variance", "averages")
        }
        return replace(
            self,
            responses=tuple(self.responses[i] for i in rows),
            references=tuple(self.references[i] for i in rows),
            **cut,
        )

    def to(self, form: Form) -> FrfSet:
        """Return the set in another form, dividing or multiplying by s = i omega + decay.

        The line at s = 0, where receptance and mobility do not exist, is dropped if the order of
        differentiation falls.

        Raises
        ------
        InputError
            If the form is unknown.
        """
        if form not in FORMS:
            raise InputError(f"unknown FRF form {form!r}; use one of {', '.join(FORMS)}")
        power = FORMS.index(form) - FORMS.index(self.form)
        if power == 0:
            return self
        whole = self._lines(np.abs(self.laplace) > 0) if power < 0 else self
        factor = whole.laplace**power
        variance = None if whole.variance is None else whole.variance * np.abs(factor) ** 2
        return replace(whole, values=whole.values * factor, variance=variance, form=form)

    def table(self) -> pd.DataFrame:
        """Return one row per FRF: response, reference, lines, averages, mean coherence."""
        rows = {
            "response": [str(d) for d in self.responses],
            "reference": [str(d) for d in self.references],
            "form": self.form,
            "lines": len(self.frequency),
        }
        table = pd.DataFrame(rows)
        if self.averages is not None:
            table["averages"] = self.averages
        if self.coherence is not None:
            table["mean coherence"] = self.coherence.mean(axis=1)
        return table
