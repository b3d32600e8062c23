"""The tables of a study file, read strictly: a misspelt key is an error and not a default."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from modalkit.study.units import (
    Density,
    Hertz,
    Length,
    Mass,
    Modulus,
    Rate,
    Share,
    Size,
    in_unit,
)

Place = tuple[Length, Length, Length]
Vector = tuple[float, float, float]
Span = tuple[Length, Length]

LARGEST_LOSS = 5.0
"""Above the loss factor of any material: rubbers reach some 3 where they turn to glass [-]."""

LARGEST_ASTRAY = 100.0
"""Points known no better than this say nothing of any structure [m]."""

LossFactor = Annotated[float, in_unit(""), Field(ge=0, lt=LARGEST_LOSS)]
Fluid = Annotated[float, in_unit("kg/m^3"), Field(gt=0, lt=30e3)]
Alpha = Annotated[float, in_unit("1/s"), Field(ge=0, lt=1e9)]
Beta = Annotated[float, in_unit("s"), Field(ge=0, lt=1e3)]
Area = Annotated[float, in_unit("m^2"), Field(gt=0)]
SecondMoment = Annotated[float, in_unit("m^4"), Field(gt=0)]
Inertia = Annotated[float, in_unit("kg m^2"), Field(ge=0)]
Weight = Annotated[float, Field(ge=0, lt=1e50)]
Doubt = Annotated[float, in_unit(""), Field(ge=0)]

MATRICES_ONLY = ("units", "stiffness", "mass_matrix", "stiffness_parts", "mass_parts", "nodes")
"""Keys of ``[model]`` that are of imported matrices alone; ``mass = "file"`` is read as ``mass_matrix``."""


class Strict(BaseModel):
    """A table without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _no_switches(cls, table: Any) -> Any:
        """See that no key is ``true`` or ``false``, which would count as 1 or 0."""
        for key, value in table.items() if isinstance(table, dict) else ():
            if any(isinstance(v, bool) for v in (value if isinstance(value, list) else [value])):
                raise ValueError(f"{key} is true or false; no key of a study is a switch")
        return table


def rising(name: str, ends: tuple[float, float] | None) -> None:
    """See that the ends of a range stand in order.

    Raises
    ------
    ValueError
        If they do not.
    """
    if ends is not None and not ends[0] < ends[1]:
        raise ValueError(f"{name} = [{ends[0]:g}, {ends[1]:g}] ends before it begins; give [low, high]")


class AxesTable(Strict):
    """Model axes in test coordinates."""

    origin: Place = (0.0, 0.0, 0.0)
    x: Vector = (1.0, 0.0, 0.0)
    y: Vector = (0.0, 1.0, 0.0)


class MeasurementTable(Strict):
    """``[test]`` and ``[baseline]``: where the data are and how they were taken."""

    files: list[str] = []
    modes: str | None = None
    band: tuple[Annotated[float, in_unit("Hz"), Field(ge=0)], Hertz] | None = None
    exponential_window: Rate = 0.0
    window_on: Literal["both", "responses"] | None = None
    window: Rate = 0.0
    estimator: Literal["H1", "H2", "Hv"] = "H1"
    use: list[tuple[str, int]] = []
    leave: list[tuple[str, int]] = []
    add: list[Hertz] = []
    drop: list[Hertz] = []
    order: Annotated[int, Field(ge=2, le=400)] | None = None
    references: list[str] = []
    pairs: list[tuple[Hertz, Annotated[int, Field(ge=0)]]] = []
    layout: str | None = None
    sensor_masses: dict[str, Mass] = {}
    calibration: Annotated[float, in_unit(""), Field(gt=0.0)] = 0.02
    repeatability: Share = 0.0005
    position_sigma: Annotated[float, in_unit("m"), Field(ge=0.0, lt=LARGEST_ASTRAY)] = 0.001
    points: list[Length] = []
    sensor: Length | None = None
    hits: int | None = Field(None, ge=1)
    axes: AxesTable = AxesTable()

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """See that the band is one, and that modes come without what is said of records and FRFs."""
        rising("band", self.band)
        if self.modes is None:
            return self
        if self.files:
            raise ValueError("files and modes are both given; modes stand in place of files: leave one out")
        of_mat = self.modes.lower().endswith(".mat")
        if of_mat and self.layout is None:
            raise ValueError(
                f'modes = {self.modes!r} is a MATLAB file: layout = "layout.toml" has to say which of its variables is '
                "what (docs/readers.md)"
            )
        useless = [key for key in OF_RECORDS if not (of_mat and key == "layout")]
        stated = [key for key in useless if getattr(self, key) != type(self).model_fields[key].default]
        if stated:
            raise ValueError(
                f"{', '.join(stated)}: said of records or FRFs, but modes = {self.modes!r} are modes already; leave "
                "it out, and change the modes themselves if they need it"
            )
        return self


OF_RECORDS = (
    "exponential_window",
    "window_on",
    "window",
    "estimator",
    "use",
    "leave",
    "add",
    "drop",
    "order",
    "references",
    "layout",
    "sensor_masses",
)
"""Keys of a measurement that modes as data leave without meaning."""


class MaterialTable(Strict):
    """``[model.material]``."""

    E: Modulus
    density: Density
    poisson: Annotated[float, in_unit(""), Field(ge=0.0, lt=0.5)] = 0.3


class DampingTable(Strict):
    """``[model.damping]``."""

    alpha: Alpha | None = None
    beta: Beta | None = None
    loss_factor: LossFactor | None = None
    ratios: Annotated[list[Share], Field(min_length=1)] | None = None


class MassTable(Strict):
    """``[[model.mass]]``."""

    at: Annotated[list[Length], Field(min_length=1, max_length=3)]
    mass: Mass
    inertia: Inertia = 0.0


class RegionTable(Strict):
    """``[[model.region]]``."""

    name: str = Field(min_length=1)
    set: str | None = None
    x: Span | None = None
    y: Span | None = None
    E: Modulus | None = None
    density: Density | None = None
    thickness: Size | None = None
    area: Area | None = None
    inertia: SecondMoment | None = None
    alpha: Alpha | None = None
    beta: Beta | None = None
    loss_factor: LossFactor | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        """See that the limits stand in order."""
        rising("x", self.x)
        rising("y", self.y)
        return self


class ModelTable(Strict):
    """``[model]``."""

    type: Literal["beam", "plate", "matrices", "calculix"]
    units: Literal["m-kg-s", "mm-t-s", "in-lbf-s"] | None = None
    length: Length | None = None
    width: Length | None = None
    thickness: Length | None = None
    elements: int | list[int] | None = None
    clamped: list[str] = []
    theory: str | None = None
    deck: str | None = None
    stiffness: str | None = None
    mass_matrix: str | None = None
    stiffness_parts: list[str] = []
    mass_parts: list[str] = []
    nodes: str | None = None
    material: MaterialTable | None = None
    damping: DampingTable = DampingTable()
    mass: list[MassTable] = []
    region: list[RegionTable] = []
    effect: list[dict[str, Any]] = []


class TolerancesTable(Strict):
    """``[tolerances]``: the modeller's own doubts, relative standard deviations."""

    E: Share = 0.01
    density: Share = 0.003
    thickness: Share = 0.005
    length: Share = 0.002
    width: Share = 0.002
    damping: Doubt = Field(0.3, ge=1e-6)


class EnvironmentTable(Strict):
    """``[environment]``."""

    fluid_density: Fluid | None = None
    free_surface: Size | None = None
    bottom: Size | None = None
    walls: tuple[Length, Length, Length, Length] | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        """See that the walls stand in order."""
        if self.walls is not None:
            rising("walls x0, x1", self.walls[:2])
            rising("walls y0, y1", self.walls[2:])
        return self


class UpdateTable(Strict):
    """``[update]``."""

    method: Literal["eigenvalue", "frf"] = "eigenvalue"
    parameters: list[str] | None = None
    weights: Literal["covariance", "relative", "eigenvalue"] | list[Weight] = "covariance"
    lines: Annotated[int, Field(ge=1)] | list[Hertz] | None = None
    stages: list[list[str]] | None = None
    data: list[Literal["frequencies", "shapes", "constants"]] = ["frequencies"]

    @field_validator("parameters", "stages")
    @classmethod
    def _once(cls, value: list[Any] | None) -> list[Any] | None:
        """See that no parameter is named twice in a list, or in a stage, and that no stage is empty."""
        for names in value if value and isinstance(value[0], list) else [value or []]:
            if twice := [name for i, name in enumerate(names) if name in names[:i]]:
                raise ValueError(f"{twice[0]!r} stands twice")
            if value and not names:
                raise ValueError("a stage without parameters; name some, or leave it out")
        return value

    @property
    def named(self) -> list[str]:
        """Parameters to update: as listed; left out and without stages, the modulus."""
        if self.parameters is None:
            return [] if self.stages is not None else ["E"]
        return self.parameters
