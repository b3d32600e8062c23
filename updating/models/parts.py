"""What a beam or a plate has at some places: regions with properties of their own, and masses."""

from __future__ import annotations

import math
from dataclasses import dataclass

from acquisition.errors import StudyError

POSITIVE = ("E", "density", "thickness", "area", "inertia")
"""A region's own properties that are above zero."""

DAMPERS = ("alpha", "beta", "loss_factor")
"""A region's own damping, which is not negative."""


@dataclass(frozen=True)
class Region:
    """A macro-element: a stretch of the beam or a rectangle of the plate with properties of its own.

    Parameters
    ----------
    name : str
        Name used in parameters such as ``root.E``.
    x, y : tuple of float
        Lower and upper limit [m]; ``y`` is None for a beam or for the whole width.
    E, density, thickness, area, inertia : float, optional
        Own values, in place of the model's [Pa, kg/m^3, m, m^2, m^4]; area and inertia for beams only.
    shear_coefficient : float, optional
        Shear coefficient of the section, of beams; left out, that of a rectangle [-].
    alpha, beta, loss_factor : float, optional
        Own damping: C = alpha M + beta K [1/s, s], structural loss factor [-].
    """

    name: str
    x: tuple[float, float]
    y: tuple[float, float] | None = None
    E: float | None = None
    density: float | None = None
    thickness: float | None = None
    area: float | None = None
    inertia: float | None = None
    shear_coefficient: float | None = None
    alpha: float | None = None
    beta: float | None = None
    loss_factor: float | None = None

    def check(self, kind: str) -> None:
        """See that the region has properties that can be, on a model of that kind.

        Raises
        ------
        StudyError
            If it has not.
        """
        whose = f"region {self.name!r}"
        for name in POSITIVE + DAMPERS:
            value, least = getattr(self, name), "above zero" if name in POSITIVE else "not negative"
            if value is not None and not (0 < value < math.inf or (value == 0 and name in DAMPERS)):
                raise StudyError(f"model: {whose} has {name} = {value:g}; it must be finite and {least}")
        if kind == "beam" and self.y is not None:
            raise StudyError(f"model: {whose} has y, but a beam has x only")
        if kind == "plate" and (self.area, self.inertia, self.shear_coefficient) != (None, None, None):
            raise StudyError(f"model: {whose} has area or inertia; those are of beams")
        for axis, ends in {"x": self.x, "y": self.y or ()}.items():
            if ends and not ends[0] < ends[1]:
                raise StudyError(
                    f"model: {whose}: {axis} = {list(ends)} ends before it begins; give [low, high]"
                )


@dataclass(frozen=True)
class PointMass:
    """A mass stated by the modeller.

    Parameters
    ----------
    at : tuple of float
        Position (x,) or (x, y) [m].
    mass : float
        Mass [kg].
    inertia : float
        Rotary inertia about the in-plane axes [kg m^2].
    """

    at: tuple[float, ...]
    mass: float
    inertia: float = 0.0

    def check(self, dim: int, called: str) -> None:
        """See that the mass can be.

        Parameters
        ----------
        dim : int
            How many coordinates a place on the model has.
        called : str
            The kind of model in a sentence.

        Raises
        ------
        StudyError
            If it is negative, or has another number of coordinates.
        """
        at = list(self.at)
        if len(at) != dim:
            many = "s" if dim > 1 else ""
            raise StudyError(f"model: mass at {at} needs {dim} coordinate{many} on {called}, found {len(at)}")
        if not (0 <= self.mass < math.inf and 0 <= self.inertia < math.inf):
            raise StudyError(
                f"model: mass at {at} of {self.mass:g} kg, {self.inertia:g} kg m2; neither is negative"
            )
