"""Frequency response functions of one test, with what is known of their quality."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray, FloatArray, IntArray, frozen_array
from acquisition.display import Displayed, counted
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.form import FORMS, UNITS, Form
from acquisition.frfs.line_shape import FRF_WINDOWS, FrfWindow, LineShape
from acquisition.frfs.scatter import HitScatter, complex_type
from acquisition.geometry import Geometry


@dataclass(frozen=True)
class Record:
    """The records that FRFs were estimated from, whose end cuts off what still rings.

    Parameters
    ----------
    duration : float
        Length of a record [s].
    trigger : float
        Mean time of the hit in it, the centroid of the force [s].
    form : {"receptance", "mobility", "accelerance"}
        What the responses recorded were.
    rate : float, optional
        Sampling rate, where it is known [Hz].
    """

    duration: float
    trigger: float
    form: Form
    rate: float | None = None


@dataclass(frozen=True, eq=False)
class FrfSet(Displayed):
    """A set of FRFs on one frequency axis, each between a response and a reference.

    Parameters
    ----------
    frequency : (n_lines,) array
        Evenly spaced frequency lines [Hz].
    values : (n_frf, n_lines) complex array
        FRFs [m/N, m/(N s) or 1/kg, by ``form``]; single precision stays single precision, see `double`.
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
    record : Record, optional
        The records the FRFs come from, where these are known to be cut at their ends; lines must then be
        multiples of 1 / duration.
    window : {"none", "hann"}, optional
        Window on the blocks that were averaged to FRFs, beside an exponential one; None where it is not known.
    line_shape : LineShape, optional
        How a pole shows in FRFs of such blocks, where an identification has found it.
    geometry : Geometry
        Nodes of the test.
    source : str
        Where the FRFs came from, for messages.
    scatter : HitScatter, optional
        Covariance of the FRFs from the repeated hits. It goes with ``variance``, which is its diagonal: where
        that is None, so is this.

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
    record: Record | None = None
    window: FrfWindow | None = None
    line_shape: LineShape | None = None
    geometry: Geometry = field(default_factory=Geometry.empty)
    source: str = "arrays"
    scatter: HitScatter | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency", frozen_array(self.frequency))
        object.__setattr__(self, "values", frozen_array(self.values, complex_type(self.values)))
        object.__setattr__(self, "responses", tuple(self.responses))
        object.__setattr__(self, "references", tuple(self.references))
        n_frf, n_lines = len(self.responses), len(self.frequency)
        for name, dtype in (("coherence", np.float64), ("variance", np.float64), ("averages", np.int64)):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen_array(value, dtype))
        if self.variance is None:
            object.__setattr__(self, "scatter", None)
        self._check(n_frf, n_lines)

    def _check(self, n_frf: int, n_lines: int) -> None:
        if self.form not in FORMS:
            raise InputError(f"{self.source}: unknown FRF form {self.form!r}; use one of {', '.join(FORMS)}")
        if self.window is not None and self.window not in FRF_WINDOWS:
            raise InputError(
                f"{self.source}: unknown window {self.window!r}; use one of {', '.join(FRF_WINDOWS)}"
            )
        if n_frf == 0 or n_lines < 2:
            raise InputError(f"{self.source}: {n_frf} FRFs of {n_lines} lines; the set is empty")
        if len(self.references) != n_frf or self.values.shape != (n_frf, n_lines):
            raise InputError(
                f"{self.source}: values have shape {self.values.shape} but there are {n_frf} responses, "
                f"{len(self.references)} references and {n_lines} frequency lines"
            )
        for name in ("coherence", "variance"):
            value = getattr(self, name)
            if value is not None and value.shape != self.values.shape:
                raise InputError(f"{self.source}: {name} has shape {value.shape}, not {self.values.shape}")
        if self.scatter is not None:
            last = max(int(rows.max()) for rows in self.scatter.hit_groups)
            if self.scatter.n_lines != n_lines or last >= n_frf:
                raise InputError(
                    f"{self.source}: scatter of {self.scatter.n_lines} lines and {last + 1} FRFs does not "
                    f"belong to {n_lines} lines and {n_frf} FRFs; give the set's own, or variance=None"
                )
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
                f"the band {low:g} to {high:g} Hz is invalid: give the lower limit first, not below 0"
            )
        keep = (self.frequency >= low - 1e-9) & (self.frequency <= high + 1e-9)
        if keep.sum() < 2:
            raise InputError(
                f"{self.source}: the band {low:g}-{high:g} Hz holds {int(keep.sum())} lines; the data run "
                f"from {self.frequency[0]:g} to {self.frequency[-1]:g} Hz"
            )
        kept = np.flatnonzero(keep)
        return self._lines(slice(int(kept[0]), int(kept[-1]) + 1))

    def _lines(self, keep: slice) -> FrfSet:
        cut: dict[str, Any] = {
            name: None if getattr(self, name) is None else getattr(self, name)[:, keep]
            for name in ("values", "coherence", "variance")
        }
        scatter = None if self.scatter is None else self.scatter.lines(keep)
        return replace(self, frequency=self.frequency[keep], scatter=scatter, **cut)

    def select(self, index: list[int] | IntArray) -> FrfSet:
        """Return some of the FRFs, by their row numbers."""
        rows = [range(len(self.responses))[int(i)] for i in index]
        cut: dict[str, Any] = {
            name: None if getattr(self, name) is None else getattr(self, name)[rows]
            for name in ("values", "coherence", "variance", "averages")
        }
        return replace(
            self,
            responses=tuple(self.responses[i] for i in rows),
            references=tuple(self.references[i] for i in rows),
            scatter=None if self.scatter is None else self.scatter.select(rows),
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
        first = int(np.flatnonzero(np.abs(self.laplace) > 0)[0]) if power < 0 else 0
        whole = self._lines(slice(first, None)) if first else self
        return replace(whole._times(whole.laplace**power), form=form)

    def scaled(self, factor: float | FloatArray) -> FrfSet:
        """Return the set multiplied by a calibration factor, its variance and scatter with it.

        Parameters
        ----------
        factor : float or (n_frf,) array
            One factor for all FRFs or one for each; negative turns a transducer round [-].

        Raises
        ------
        InputError
            If a factor is zero or not finite, or their number is not that of the FRFs.
        """
        wide = np.asarray(factor, dtype=np.float64)
        if wide.shape not in ((), (len(self.responses),)) or not np.all(np.isfinite(wide) & (wide != 0)):
            raise InputError(
                f"{self.source}: factor {factor} for {len(self.responses)} FRFs; give one number other than "
                "zero, or one for each FRF"
            )
        return self._times(wide if wide.ndim == 0 else wide[:, None])

    def _times(self, factor: Any) -> FrfSet:
        return replace(
            self,
            values=(self.values * factor).astype(self.values.dtype),
            variance=None if self.variance is None else self.variance * np.abs(factor) ** 2,
            scatter=None if self.scatter is None else self.scatter.times(factor),
        )

    def double(self) -> FrfSet:
        """Return the set with values in double precision, as fits need them; itself if they are already."""
        if self.values.dtype == np.complex128:
            return self
        return replace(self, values=self.values.astype(np.complex128))

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

    def _headline(self) -> str:
        span = f"{self.frequency[0]:g} to {self.frequency[-1]:g} Hz in steps of {self.df:g} Hz"
        window = f", window of {self.decay:g} 1/s" if self.decay else ""
        return f"{counted(len(self.responses), 'FRF')} ({self.form}), {span}{window}; from {self.source}"
