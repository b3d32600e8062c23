"""The tables of a study file that state the model."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from modalkit.study.strict import Strict, rising
from modalkit.study.units import (
    Density,
    Length,
    Mass,
    Modulus,
    Share,
    Size,
    in_unit,
)

Span = tuple[Length, Length]

LARGEST_LOSS = 5.0
"""Above the loss factor of any material: rubbers reach some 3 where they turn to glass [-]."""

LossFactor = Annotated[float, in_unit(""), Field(ge=0, lt=LARGEST_LOSS)]

Alpha = Annotated[float, in_unit("1/s"), Field(ge=0, lt=1e9)]

Beta = Annotated[float, in_unit("s"), Field(ge=0, lt=1e3)]

Area = Annotated[float, in_unit("m^2"), Field(gt=0)]

SecondMoment = Annotated[float, in_unit("m^4"), Field(gt=0)]

ShearCoefficient = Annotated[float, in_unit("-"), Field(gt=0, le=1)]

Inertia = Annotated[float, in_unit("kg m^2"), Field(ge=0)]

MATRICES_ONLY = (
    "units", "stiffness", "mass_matrix", "stiffness_name", "mass_name", "stiffness_parts", "mass_parts", "nodes",
)  # fmt: skip
"""Keys of ``[model]`` that are of imported matrices alone; ``mass = "file"`` is read as ``mass_matrix``."""


class MaterialTable(Strict):
    """``[model.material]``."""

    E: Modulus
    """Young's modulus [Pa]."""
    density: Density
    """Density [kg/m3]."""
    poisson: Annotated[float, in_unit(""), Field(ge=0.0, lt=0.5)] = 0.3
    """Poisson's ratio [-]."""


class DampingTable(Strict):
    """``[model.damping]``."""

    alpha: Alpha | None = None
    """C = alpha M [1/s]."""
    beta: Beta | None = None
    """C = beta K [s]."""
    loss_factor: LossFactor | None = None
    """K (1 + i eta) [-]."""
    ratios: Annotated[list[Share], Field(min_length=1)] | None = None
    """Damping ratio of each mode [-]. Without any of the four, the damping is unknown."""


def _listed(place: Any) -> Any:
    """Take a single coordinate for a place: a beam's points are plain numbers."""
    return [place] if isinstance(place, str | int | float) else place


class MassTable(Strict):
    """``[[model.mass]]``."""

    at: Annotated[list[Length], BeforeValidator(_listed), Field(min_length=1, max_length=3)]
    """Its place [m], on beams x alone; on beams and plates uncertain by `position_sigma`."""
    mass: Mass
    """A known mass on the structure [kg]; on beams and plates uncertain by 2 %."""
    inertia: Inertia = 0.0
    """Its rotary inertia [kg m2]."""


class RegionTable(Strict):
    """``[[model.region]]``."""

    name: str = Field(min_length=1)
    """Its name; regions of the same name are updated together."""
    set: str | None = None
    """``calculix``: the element set or material, if its name differs."""
    x: Span | None = None
    """Start and end along x [m]."""
    y: Span | None = None
    """Plates: start and end along y [m]."""
    E: Modulus | None = None
    """Young's modulus instead of the model's [Pa]."""
    density: Density | None = None
    """Density instead of the model's [kg/m3]."""
    thickness: Size | None = None
    """Thickness instead of the model's [m]."""
    area: Area | None = None
    """Beams: cross-section [m2]."""
    inertia: SecondMoment | None = None
    """Beams: second moment of area [m4]."""
    shear_coefficient: ShearCoefficient | None = None
    """Beams: shear coefficient of the section [-]; default that of a rectangle; 0.5 a thin tube, 0.9 a rod."""
    alpha: Alpha | None = None
    """As under damping [1/s]."""
    beta: Beta | None = None
    """As under damping [s]."""
    loss_factor: LossFactor | None = None
    """As under damping [-]."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        """See that the limits stand in order."""
        rising("x", self.x)
        rising("y", self.y)
        return self


class ModelTable(Strict):
    """``[model]``."""

    type: Literal["beam", "plate", "matrices", "calculix"]
    """``beam``, ``plate``, ``matrices``, or ``calculix``."""
    units: Literal["m-kg-s", "mm-t-s", "in-lbf-s"] | None = None
    """Units of matrices or deck. Default: ``m-kg-s``."""
    length: Length | None = None
    """Along x [m]."""
    width: Length | None = None
    """Along y [m]."""
    thickness: Length | None = None
    """Along z, the direction of hitting [m]."""
    elements: int | list[int] | None = None
    """Beams: a number (40); plates: two (38, 20). Refined until the model has converged."""
    clamped: list[str] = []
    """Clamped ends or edges: ``x0``, ``x1``, for plates also ``y0``, ``y1``. Default: a free structure."""
    theory: str | None = None
    """Beams: ``euler-bernoulli`` (default), ``rayleigh``, ``timoshenko``; plates: ``kirchhoff`` (default),
    ``mindlin``.
    """
    deck: str | None = None
    """``calculix``: the input deck."""
    stiffness: str | None = None
    """``matrices``: file of the stiffness matrix."""
    mass_matrix: str | None = None
    """``matrices``: file of the mass matrix; may be written ``mass`` if there is no ``[[model.mass]]``."""
    stiffness_name: str | None = None
    """``matrices``: name of the stiffness in files that have several matrices (``.op4``, ``.op2``, ``.pch``), those of
    parts and hypotheses too. Default: the square one whose name begins with K.
    """
    mass_name: str | None = None
    """``matrices``: name of the mass. Default: the square one whose name begins with M."""
    stiffness_parts: list[str] = []
    """``matrices``: the stiffness of each region, one file each, in their order."""
    mass_parts: list[str] = []
    """``matrices``: the mass of each region."""
    nodes: str | None = None
    """``matrices``: node table (CSV), or the deck that made them."""
    material: MaterialTable | None = None
    damping: DampingTable = DampingTable()
    mass: list[MassTable] = []
    region: list[RegionTable] = []
    effect: list[dict[str, Any]] = []
    """Accepted effects, each with ``name`` and its parameters: they become part of the model. Beside a baseline also
    ``before``: true (it was there, too; the default for effects of the structure) or false (it came afterwards)."""
