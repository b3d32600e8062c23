"""The study file: a test, a model, doubts. Read strictly, so that a misspelt key is an error and not a default."""

from __future__ import annotations

import tomllib
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from acquisition.errors import StudyError
from modalkit.matrices import matrices_of, matrices_spec
from updating.axes import Axes
from updating.effects import LIBRARY
from updating.environment import Environment
from updating.models import Damping, Material, PointMass, Region, Spec
from updating.models.imported import Imported
from updating.tolerances import Tolerances

Vector = tuple[float, float, float]

MATRICES_ONLY = ("stiffness", "mass_matrix", "stiffness_parts", "mass_parts", "nodes")
"""Keys of ``[model]`` that are of imported matrices alone; ``mass = "file"`` is read as ``mass_matrix``."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class AxesTable(_Strict):
    """Model axes in test coordinates."""

    origin: Vector = (0.0, 0.0, 0.0)
    x: Vector = (1.0, 0.0, 0.0)
    y: Vector = (0.0, 1.0, 0.0)


class MeasurementTable(_Strict):
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
    axes: AxesTable = AxesTable()


class MaterialTable(_Strict):
    """``[model.material]``."""

    E: float = Field(gt=0)
    density: float = Field(gt=0)
    poisson: float = Field(0.3, ge=0.0, lt=0.5)


class DampingTable(_Strict):
    """``[model.damping]``."""

    alpha: float | None = None
    beta: float | None = None
    loss_factor: float | None = None
    ratios: list[float] | None = None


class MassTable(_Strict):
    """``[[model.mass]]``."""

    at: list[float]
    mass: float = Field(ge=0)
    inertia: float = Field(0.0, ge=0)


class RegionTable(_Strict):
    """``[[model.region]]``."""

    name: str
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


class ModelTable(_Strict):
    """``[model]``."""

    type: Literal["beam", "plate", "matrices"]
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


class TolerancesTable(_Strict):
    """``[tolerances]``: the modeller's own doubts, relative standard deviations."""

    E: float = Field(0.01, ge=0)
    density: float = Field(0.003, ge=0)
    thickness: float = Field(0.005, ge=0)
    length: float = Field(0.002, ge=0)
    width: float = Field(0.002, ge=0)
    damping: float = Field(0.3, gt=0)


class EnvironmentTable(_Strict):
    """``[environment]``."""

    fluid_density: float | None = Field(None, gt=0)
    free_surface: float | None = Field(None, gt=0)
    bottom: float | None = Field(None, gt=0)
    walls: tuple[float, float, float, float] | None = None


class UpdateTable(_Strict):
    """``[update]``."""

    method: Literal["eigenvalue", "frf"] = "eigenvalue"
    parameters: list[str] | None = None
    weights: Literal["covariance", "relative", "eigenvalue"] | list[float] = "covariance"
    lines: int | list[float] | None = None
    stages: list[list[str]] | None = None
    data: list[Literal["frequencies", "shapes"]] = ["frequencies"]

    @property
    def named(self) -> list[str]:
        """Parameters to update: as listed; left out and without stages, the modulus."""
        if self.parameters is None:
            return [] if self.stages is not None else ["E"]
        return self.parameters


class Study(_Strict):
    """A whole study file.

    Use :func:`read_study`; paths are relative to ``folder``.
    """

    title: str = ""
    note: str = ""
    test: MeasurementTable
    baseline: MeasurementTable | None = None
    model: ModelTable | None = None
    tolerances: TolerancesTable = TolerancesTable()
    environment: EnvironmentTable = EnvironmentTable()
    update: UpdateTable = UpdateTable()
    path: Path = Path("study.toml")

    def file(self, name: str) -> Path:
        """Return a file of the study, relative to the study file."""
        return self.path.parent / name

    @property
    def name(self) -> str:
        """Title, or the folder's name."""
        return self.title or self.path.resolve().parent.name

    def spec(self) -> Spec:
        """Return the nominal model.

        Raises
        ------
        StudyError
            If there is no model, or one that cannot be.
        """
        try:
            return self._spec()
        except StudyError as error:
            raise StudyError(f"{self.path}: {error}") from error

    def _spec(self) -> Spec:
        model = self.model
        if model is None:
            raise StudyError("this command needs a [model]")
        damping = Damping(
            model.damping.alpha,
            model.damping.beta,
            model.damping.loss_factor,
            None if model.damping.ratios is None else tuple(model.damping.ratios),
        )
        if model.type == "matrices":
            return matrices_spec(model, self._imported, damping)
        if given := [key for key in MATRICES_ONLY if getattr(model, key)]:
            raise StudyError(
                f"[model] of type {model.type} takes no {', '.join(given)}; they are of type matrices"
            )
        if unplaced := [region.name for region in model.region if region.x is None]:
            raise StudyError(f"[[model.region]] {unplaced[0]!r} needs x")
        for key in ("length", "width", "thickness", "material"):
            if getattr(model, key) is None:
                raise StudyError(f"[model] of type {model.type} needs {key}")
        assert model.material is not None
        assert model.length is not None
        assert model.width is not None
        assert model.thickness is not None
        return Spec(
            model.type,
            model.length,
            model.width,
            model.thickness,
            self._elements(model),
            tuple(model.clamped),
            model.theory or ("euler-bernoulli" if model.type == "beam" else "kirchhoff"),  # type: ignore[arg-type]
            Material(model.material.E, model.material.density, model.material.poisson),
            tuple(Region(**region.model_dump()) for region in model.region),
            tuple(PointMass(tuple(mass.at), mass.mass, mass.inertia) for mass in model.mass),
            damping,
        )

    @cached_property
    def _imported(self) -> Imported:
        """The matrices of the model, read once."""
        assert self.model is not None
        return matrices_of(self.model, self.file)

    def _elements(self, model: ModelTable) -> tuple[int, ...]:
        if model.elements is None:
            return (40,) if model.type == "beam" else (38, 20)
        return (model.elements,) if isinstance(model.elements, int) else tuple(model.elements)

    def axes(self, table: MeasurementTable) -> Axes:
        """Return the model's axes in the coordinates of a test."""
        try:
            return Axes(table.axes.origin, table.axes.x, table.axes.y)
        except StudyError as error:
            raise StudyError(f"{self.path}: {error}") from error

    def doubts(self) -> Tolerances:
        """Return the tolerances."""
        values = self.tolerances.model_dump()
        damping = values.pop("damping")
        return Tolerances(values, damping)

    def accepted(self) -> tuple[tuple[str, dict[str, float]], ...]:
        """Return the effects put into the model, with the values of their parameters.

        Raises
        ------
        StudyError
            If one is unknown or a parameter is missing.
        """
        entries = [] if self.model is None else self.model.effect
        found = []
        for entry in entries:
            values = {k: v for k, v in entry.items() if k != "name"}
            name = entry.get("name")
            if name not in LIBRARY:
                raise StudyError(
                    f"{self.path}: [[model.effect]] knows no effect {name!r}; `modalkit effects` lists them"
                )
            if wrong := [k for k, v in values.items() if not isinstance(v, int | float)]:
                raise StudyError(f"{self.path}: [[model.effect]] {name}: {', '.join(wrong)} must be a number")
            found.append((name, {k: float(v) for k, v in values.items()}))
        return tuple(found)

    def surroundings(self) -> Environment:
        """Return the environment."""
        return Environment(**self.environment.model_dump())


def read_study(path: Path) -> Study:
    """Read a study file.

    Parameters
    ----------
    path : Path
        The TOML file.

    Returns
    -------
    Study

    Raises
    ------
    StudyError
        If the file cannot be read, is no TOML, or has a key or value that does not belong there.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise StudyError(
            f"{path}: cannot be read ({error.strerror}); give the path of a study file"
        ) from error
    except UnicodeDecodeError as error:
        raise StudyError(
            f"{path}: not a valid TOML file but binary data; give a study file that names it"
        ) from error
    except tomllib.TOMLDecodeError as error:
        raise StudyError(f"{path}: not a valid TOML file: {error}") from error
    if "path" in content:
        raise StudyError(f"{path}: unknown key path; known here: {', '.join(_known(()))}")
    model = content.get("model", {})
    if isinstance(model, dict) and isinstance(model.get("mass"), str):
        content["model"] = {"mass_matrix" if key == "mass" else key: value for key, value in model.items()}
    try:
        return Study(**content, path=path)
    except ValidationError as error:
        raise StudyError(f"{path}: {_explain(error)}") from error


def _explain(error: ValidationError) -> str:
    """Say in one line what is wrong and where."""
    parts = []
    for problem in error.errors()[:3]:
        place = ".".join(str(p) for p in problem["loc"])
        if problem["type"] == "extra_forbidden":
            known = _known(problem["loc"][:-1])
            parts.append(f"unknown key {place}" + (f"; known here: {', '.join(known)}" if known else ""))
        else:
            parts.append(f"{place}: {problem['msg'].lower()}")
    return "; ".join(parts)


def _known(place: tuple[int | str, ...]) -> list[str]:
    """Return the keys a table of the study may have."""
    tables: dict[tuple[str, ...], type[BaseModel]] = {
        (): Study,
        ("test",): MeasurementTable,
        ("baseline",): MeasurementTable,
        ("test", "axes"): AxesTable,
        ("baseline", "axes"): AxesTable,
        ("model",): ModelTable,
        ("model", "material"): MaterialTable,
        ("model", "damping"): DampingTable,
        ("model", "mass"): MassTable,
        ("model", "region"): RegionTable,
        ("tolerances",): TolerancesTable,
        ("environment",): EnvironmentTable,
        ("update",): UpdateTable,
    }
    table = tables.get(tuple(str(p) for p in place if not isinstance(p, int)))
    return [] if table is None else [n for n in table.model_fields if n != "path"]
