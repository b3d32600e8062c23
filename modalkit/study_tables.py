"""The tables of a study file, read strictly: a misspelt key is an error and not a default."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

Vector = tuple[float, float, float]

MATRICES_ONLY = ("units", "stiffness", "mass_matrix", "stiffness_parts", "mass_parts", "nodes")
"""Keys of ``[model]`` that are of imported matrices alone; ``mass = "file"`` is read as ``mass_matrix``."""


class Strict(BaseModel):
    """A table without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class AxesTable(Strict):
    """Model axes in test coordinates."""

    origin: Vector = (0.0, 0.0, 0.0)
    x: Vector = (1.0, 0.0, 0.0)
    y: Vector = (0.0, 1.0, 0.0)


class MeasurementTable(Strict):
    """``[test]`` and ``[baseline]``: where the data are and how they were taken."""

    files: list[str] = []
    modes: str | None = None
    band: tuple[float, float] | None = None
    exponential_window: float = Field(0.0, ge=0.0)
    window_on: Literal["both", "responses"] | None = None
    window: float = Field(0.0, ge=0.0)
    estimator: Literal["H1", "H2", "Hv"] = "H1"
    use: list[tuple[str, int]] = []
    leave: list[tuple[str, int]] = []
    add: list[float] = []
    drop: list[float] = []
    layout: str | None = None
    sensor_masses: dict[str, float] = {}
    calibration: float = Field(0.02, gt=0.0)
    repeatability: float = Field(0.0005, ge=0.0)
    position_sigma: float = Field(0.001, ge=0.0)
    points: list[float] = []
    sensor: float | None = None
    hits: int | None = Field(None, ge=1)
    axes: AxesTable = AxesTable()


class MaterialTable(Strict):
    """``[model.material]``."""

    E: float = Field(gt=0)
    density: float = Field(gt=0)
    poisson: float = Field(0.3, ge=0.0, lt=0.5)


class DampingTable(Strict):
    """``[model.damping]``."""

    alpha: float | None = None
    beta: float | None = None
    loss_factor: float | None = None
    ratios: list[float] | None = None


class MassTable(Strict):
    """``[[model.mass]]``."""

    at: list[float]
    mass: float = Field(ge=0)
    inertia: float = Field(0.0, ge=0)


class RegionTable(Strict):
    """``[[model.region]]``."""

    name: str = Field(min_length=1)
    x: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    E: float | None = None
    density: float | None = None
    thickness: float | None = None
    area: float | None = None
    inertia: float | None = None
    alpha: float | None = None
    beta: float | None = None
    loss_factor: float | None = None


class ModelTable(Strict):
    """``[model]``."""

    type: Literal["beam", "plate", "matrices"]
    units: Literal["m-kg-s", "mm-t-s", "in-lbf-s"] | None = None
    length: float | None = None
    width: float | None = None
    thickness: float | None = None
    elements: int | list[int] | None = None
    clamped: list[str] = []
    theory: str | None = None
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

    E: float = Field(0.01, ge=0)
    density: float = Field(0.003, ge=0)
    thickness: float = Field(0.005, ge=0)
    length: float = Field(0.002, ge=0)
    width: float = Field(0.002, ge=0)
    damping: float = Field(0.3, gt=0)


class EnvironmentTable(Strict):
    """``[environment]``."""

    fluid_density: float | None = Field(None, gt=0)
    free_surface: float | None = Field(None, gt=0)
    bottom: float | None = Field(None, gt=0)
    walls: tuple[float, float, float, float] | None = None


class UpdateTable(Strict):
    """``[update]``."""

    method: Literal["eigenvalue", "frf"] = "eigenvalue"
    parameters: list[str] | None = None
    weights: Literal["covariance", "relative", "eigenvalue"] | list[float] = "covariance"
    lines: int | list[float] | None = None
    stages: list[list[str]] | None = None
    data: list[Literal["frequencies", "shapes"]] = ["frequencies"]

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
