"""A plain record of modes, as files carry them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, frozen_array
from acquisition.display import Animated, Shown, counted
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.geometry import Geometry

DOUBTFUL_DAMPING = 0.2
"""From this ratio on damping is doubted: hardly a structure has it, and 0.2 per cent is usual [-]."""


@dataclass(frozen=True, eq=False)
class ModalData(Shown, Animated):
    """Frequencies, damping ratios and shapes with their standard deviations.

    Parameters
    ----------
    frequency : (n_modes,) array
        Undamped natural frequencies |lambda| / 2 pi [Hz].
    frequency_sigma : (n_modes,) array
        Their standard deviations [Hz]; nan where unknown.
    damping, damping_sigma : (n_modes,) arrays, optional
        Damping ratios and their standard deviations [-]; nan where unknown.
    dofs : tuple of Dof, length n_dofs
        Degrees of freedom of the shapes; signs of directions are already in the shapes (every direction is
        positive).
    shapes : (n_dofs, n_modes) complex array, optional
        Mode shapes [kg^-1/2 where scaled, else -].
    shape_sigma : (n_dofs, n_modes) array, optional
        Standard deviation of each component [as ``shapes``].
    scaled : bool
        Whether the shapes are mass-normalised.
    geometry : Geometry
        Nodes of the test.

    Raises
    ------
    InputError
        If lengths disagree or a frequency is not positive.
    """

    frequency: FloatArray
    frequency_sigma: FloatArray
    damping: FloatArray | None = None
    damping_sigma: FloatArray | None = None
    dofs: tuple[Dof, ...] = ()
    shapes: ComplexArray | None = None
    shape_sigma: FloatArray | None = None
    scaled: bool = False
    geometry: Geometry = field(default_factory=Geometry.empty)

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency", frozen_array(self.frequency))
        object.__setattr__(self, "dofs", tuple(self.dofs))
        n_modes = len(self.frequency)
        for name in ("frequency_sigma", "damping", "damping_sigma"):
            value = getattr(self, name)
            column = frozen_array(np.full(n_modes, np.nan) if value is None else value)
            object.__setattr__(self, name, column)
            if column.shape != (n_modes,):
                raise InputError(f"{n_modes} frequencies but {name} has shape {column.shape}")
        if not np.all(self.frequency > 0):
            raise InputError(f"frequencies must be positive, found {self.frequency.min():g} Hz")
        for name, dtype in (("shapes", np.complex128), ("shape_sigma", np.float64)):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen_array(value, dtype))
                if value.shape != (len(self.dofs), n_modes):
                    raise InputError(
                        f"{name} has shape {value.shape}; there are {len(self.dofs)} DOFs and {n_modes} modes"
                    )

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.frequency)

    def modes(self, keep: BoolArray) -> ModalData:
        """Return some of the modes, those where ``keep`` (n_modes,) is true."""
        along = ("frequency", "frequency_sigma", "damping", "damping_sigma")
        columns = {name: getattr(self, name)[keep] for name in along}
        shapes = {
            name: getattr(self, name)[:, keep]
            for name in ("shapes", "shape_sigma")
            if getattr(self, name) is not None
        }
        return replace(self, **columns, **shapes)

    def doubts(self) -> tuple[str, ...]:
        """Return what in the numbers themselves looks like a mistake."""
        assert self.damping is not None
        most = float(np.nan_to_num(self.damping).max(initial=0.0))
        if most < DOUBTFUL_DAMPING:
            return ()
        return (
            f"damping ratios of up to {most:.3g}, which is {100 * most:.3g} %: if they are in per cent, "
            "name the column damping_percent, or divide them by 100",
        )

    def table(self) -> pd.DataFrame:
        """Return one row per mode: frequency [Hz], damping ratio [%], and their standard deviations."""
        assert self.damping is not None
        assert self.damping_sigma is not None
        columns = {
            "frequency [Hz]": self.frequency,
            "sigma [Hz]": self.frequency_sigma,
            "damping [%]": 100 * self.damping,
            "sigma [%]": 100 * self.damping_sigma,
        }
        return pd.DataFrame(columns, index=pd.RangeIndex(1, len(self) + 1, name="mode"))

    def _headline(self) -> str:
        if not len(self):
            return "no modes"
        span = f"{counted(len(self), 'mode')}, {self.frequency.min():g} to {self.frequency.max():g} Hz"
        if self.shapes is None:
            return f"{span}, no shapes"
        scaled = "mass-normalised" if self.scaled else "not mass-normalised"
        return f"{span}, shapes at {counted(len(self.dofs), 'degree')} of freedom, {scaled}"
