"""The tables of a study file, read strictly: a misspelt key is an error and not a default."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, field_validator, model_validator

from modalkit.study.planned_points import PlannedPoint
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
"""Points with larger uncertainty than this are not informative for any structure [m]."""

LARGEST_SHAPE_ERROR = 10.0
"""Shapes with larger uncertainty than this are not informative [-]."""

LossFactor = Annotated[float, in_unit(""), Field(ge=0, lt=LARGEST_LOSS)]
Fluid = Annotated[float, in_unit("kg/m^3"), Field(gt=0, lt=30e3)]
Alpha = Annotated[float, in_unit("1/s"), Field(ge=0, lt=1e9)]
Beta = Annotated[float, in_unit("s"), Field(ge=0, lt=1e3)]
Area = Annotated[float, in_unit("m^2"), Field(gt=0)]
SecondMoment = Annotated[float, in_unit("m^4"), Field(gt=0)]
ShearCoefficient = Annotated[float, in_unit("-"), Field(gt=0, le=1)]
Inertia = Annotated[float, in_unit("kg m^2"), Field(ge=0)]
Weight = Annotated[float, Field(ge=0, lt=1e50)]
Doubt = Annotated[float, in_unit(""), Field(ge=0)]

MATRICES_ONLY = (
    "units", "stiffness", "mass_matrix", "stiffness_name", "mass_name", "stiffness_parts", "mass_parts", "nodes",
)  # fmt: skip
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


def _of_part(name: str, value: Any) -> bool:
    """Return whether a key of ``[tolerances]`` names a single parameter."""
    return "." in name or isinstance(value, dict)


def _flat(table: dict[str, Any], before: str = "") -> dict[str, Any]:
    """Return a table of tables as one, names joined by points."""
    found: dict[str, Any] = {}
    for name, value in table.items():
        found |= _flat(value, f"{before}{name}.") if isinstance(value, dict) else {before + name: value}
    return found


class AxesTable(Strict):
    """Model axes in test coordinates."""

    origin: Place = (0.0, 0.0, 0.0)
    """Origin of the model, in test coordinates [m]."""
    x: Vector = (1.0, 0.0, 0.0)
    """Direction of the model's x axis, in test coordinates [-]."""
    y: Vector = (0.0, 1.0, 0.0)
    """Direction of its y axis [-]; z completes a right-handed system."""


class MeasurementTable(Strict):
    """``[test]`` and ``[baseline]``: where the data are and how they were taken."""

    files: list[str] = []
    """UFF files of raw hits or FRFs, or column text; several files are one test."""
    modes: str | None = None
    """Modes instead of ``files``: a CSV table, UFF 55 or 2414, the JSON of ``identify --json``, or a ``.mat``
    file with its ``layout``.
    """
    band: tuple[Annotated[float, in_unit("Hz"), Field(ge=0)], Hertz] | None = None
    """Frequency band [Hz]. Default: all; for hits, up to where the force is 20 dB down. Reduced, with a warning,
    to where force and coherence carry information.
    """
    exponential_window: Rate = 0.0
    """Decay rate of a window applied before the file was written [1/s]; another one stated in the file is an
    error.
    """
    window_on: Literal["both", "responses"] | None = None
    """What that window was applied to. Default: detected from the noise of the force."""
    window: Rate = 0.0
    """Decay rate of a further window, applied here [1/s]."""
    frf_window: Literal["none", "hann"] | None = None
    """Window on the blocks that FRFs in the files were averaged over: its line shape is fitted, a random force assumed.
    Default: detected from the FRFs.
    """
    estimator: Literal["H1", "H2", "Hv"] = "H1"
    """How FRFs are averaged from hits."""
    use: list[tuple[str, int]] = []
    """Rejected hits to use anyway, as ``[["12+Z", 3]]``; a point's hits are numbered through all runs and
    files.
    """
    leave: list[tuple[str, int]] = []
    """Hits to leave out, in the same form."""
    add: list[Hertz] = []
    """Modes to keep regardless of the statistics, by frequency [Hz]."""
    drop: list[Hertz] = []
    """Modes to leave out of the result, by frequency [Hz]."""
    order: Annotated[int, Field(ge=2, le=400)] | None = None
    """Highest model order [-]. Default: 60."""
    references: list[str] = []
    """Reference degrees of freedom whose FRFs are used, as ``["1+Z"]``. Default: all."""
    pairs: list[tuple[Hertz, Annotated[int, Field(ge=0)]]] = []
    """Pairs of modes set by hand, as ``[[153.9, 3]]``: the mode measured at 153.9 Hz is the model's third; 0:
    it has no counterpart.
    """
    layout: str | None = None
    """Layout of column text, or of a ``.mat`` file."""
    sensor_masses: dict[str, Mass] = {}
    """Accelerometers whose mass is removed from the FRFs [kg], as ``{ "25+Z" = 0.0086 }``; each place must have
    been hit too.
    """
    calibration: Annotated[float, in_unit(""), Field(gt=0.0)] = 0.02
    """Relative 1-sigma of the absolute level of the FRFs [-]."""
    repeatability: Share = 0.0005
    """Relative 1-sigma of the frequencies from one mounting to the next [-]. Measure it by re-mounting; do not
    take it from the residual of a fit.
    """
    position_sigma: Annotated[float, in_unit("m"), Field(ge=0.0, lt=LARGEST_ASTRAY)] = 0.001
    """1-sigma of the places of hits and sensors [m]."""
    shape_sigma: Annotated[float, in_unit(""), Field(gt=0.0, lt=LARGEST_SHAPE_ERROR)] | None = None
    """With ``modes``: error of every component of a shape over the shape's r.m.s. [-], instead of the table's.
    If neither is given, an update estimates it and a diagnosis takes 2 % times an unknown factor.
    """
    places: dict[Annotated[str, Field(pattern=r"^\d{1,9}$")], Place] = {}
    """Coordinates of test points that the file lacks or has wrong, in test coordinates [m], as
    ``{ 12 = [0.1, 0.0, 0.3] }``. Default with matrices and decks: the nodes of the same numbers.
    """
    directions: dict[str, Vector] = {}
    """Directions of sensors or hits that are along no axis, in test coordinates, as
    ``{ "12+X" = [0.7, 0.7, 0.0] }``: 12+X was measured along that vector.
    """
    match_tolerance: Size | None = None
    """Largest distance of a test point from the nodes (or elements) of matrices or a deck [m]; beyond the node
    spacing a point is put on the nearest node. Default: the node spacing.
    """
    points: list[PlannedPoint] = []
    """Planned tests only: the points to hit. Beams: x [m]; plates: ``[x, y]`` [m]; matrices and decks: a node and
    its direction as ``"12+Z"``, or ``[x, y, z, "+z"]`` in model axes [m]. Default: eight even points on beams,
    5 x 4 on plates.
    """
    sensor: PlannedPoint | None = None
    """Planned tests only: the place of the sensor, written like ``points``. Default: a beam's free end, else the
    hit point at which the weakest mode is strongest.
    """
    hits: int | None = Field(None, ge=1)
    """Planned tests only: hits per point. Default: 5."""
    axes: AxesTable = AxesTable()
    """The model's axes in test coordinates."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """See that the band is one, and that modes come without what is stated about records and FRFs."""
        rising("band", self.band)
        if self.modes is None:
            if self.shape_sigma is not None:
                instead = (
                    "for files the identification gives the uncertainty of shapes"
                    if self.files
                    else "a planned test takes none, its forecast states the assumed uncertainty of shapes"
                )
                raise ValueError(f"shape_sigma is of modes; {instead}: leave it out")
            return self
        if self.files:
            raise ValueError("files and modes are both given; modes stand in place of files: leave one out")
        of_mat = self.modes.lower().endswith(".mat")
        if of_mat and self.layout is None:
            raise ValueError(
                f'modes = {self.modes!r} is a MATLAB file: layout = "layout.toml" must state the meaning '
                "of its variables (docs/howto/matlab.md)"
            )
        useless = [key for key in OF_RECORDS if not (of_mat and key == "layout")]
        stated = [key for key in useless if getattr(self, key) != type(self).model_fields[key].default]
        if stated:
            rows = {"add", "drop"} & {*stated}
            way = " (lines of the table), or set `band`, which leaves out the modes beyond it" if rows else ""
            raise ValueError(
                f"{', '.join(stated)}: given for records or FRFs, but modes = {self.modes!r} are modes "
                f"already; leave it out, and change the modes themselves if they need it{way}"
            )
        return self


OF_RECORDS = (
    "exponential_window",
    "window_on",
    "window",
    "frf_window",
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


class TolerancesTable(Strict):
    """``[tolerances]``: the modeller's own doubts, relative standard deviations."""

    E: Share = 0.01
    """Of Young's modulus [-]."""
    density: Share = 0.003
    """Of the density [-]."""
    thickness: Share = 0.005
    """Of the thickness [-]."""
    length: Share = 0.002
    """Of the length [-]."""
    width: Share = 0.002
    """Of the width [-]."""
    damping: Doubt = Field(0.3, ge=1e-6)
    """Of the expected damping of each mode; half of its variance again is common to all modes [-]."""
    parts: dict[str, Doubt] = {}
    """Of single parameters, written ``web.E = 0.2`` or ``"web.E" = 0.2``: of a region, in addition to the common
    one (in an update instead of it), and of numbers of a deck [-].
    """
    bounds: dict[str, tuple[float, float]] = {}
    """Limits of parameters, as ``{ "web.E" = [0.8, 1.1] }``: factors, others in their unit. A parameter without
    its own tolerance may lie anywhere between them.
    """

    @model_validator(mode="before")
    @classmethod
    def _by_part(cls, table: Any) -> Any:
        """Gather what is stated of single parameters: dotted names, and tables that TOML makes of them."""
        if not isinstance(table, dict):
            return table
        plain = {n: v for n, v in table.items() if n in cls.model_fields or not _of_part(n, v)}
        own = {n: v for n, v in table.items() if n not in plain}
        plain["bounds"] = (
            _flat(plain["bounds"]) if isinstance(plain.get("bounds"), dict) else plain.get("bounds", {})
        )
        return {**plain, "parts": {**_flat(plain.get("parts", {})), **_flat(own)}}

    @model_validator(mode="after")
    def _rising(self) -> Self:
        """See that bounds stand in order."""
        for name, ends in self.bounds.items():
            rising(f"bounds of {name}", ends)
        return self


class EnvironmentTable(Strict):
    """``[environment]``."""

    fluid_density: Fluid | None = None
    """Density of a fluid around the structure [kg/m3]. Default: a broad prior."""
    free_surface: Size | None = None
    """Height of a free surface above the structure (+z) [m]."""
    bottom: Size | None = None
    """Distance of the bottom below it [m]."""
    walls: tuple[Length, Length, Length, Length] | None = None
    """Walls ``[x0, x1, y0, y1]`` in model axes [m]. Default: unbounded, except for the wall of a clamp."""

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
    """By frequencies and shapes, or by FRFs."""
    parameters: list[str] | None = None
    """Parameters to update. Default: ``["E"]``."""
    weights: Literal["covariance", "relative", "eigenvalue"] | list[Weight] = "covariance"
    """With ``eigenvalue``: a rule, or a weight for each mode."""
    lines: Annotated[int, Field(ge=1)] | list[Hertz] | None = None
    """With ``frf``: number of frequency lines that a stage compares, or the lines [Hz]. Default: 100."""
    stages: list[list[str]] | None = None
    """With ``frf``: lists of parameters updated one after the other, instead of ``parameters``. Default: mass and
    stiffness, then damping.
    """
    data: list[Literal["frequencies", "shapes", "constants"]] = ["frequencies"]
    """With ``eigenvalue``: add ``"shapes"``, or ``"constants"`` for shapes with their level."""

    @field_validator("parameters", "stages")
    @classmethod
    def _once(cls, value: list[Any] | None) -> list[Any] | None:
        """See that no parameter is named twice in a list, or in a stage, and that no stage is empty."""
        for names in value if value and isinstance(value[0], list) else [value or []]:
            if twice := [name for i, name in enumerate(names) if name in names[:i]]:
                raise ValueError(f"{twice[0]!r} is given twice")
            if value and not names:
                raise ValueError("a stage without parameters; name some, or leave it out")
        return value

    @property
    def named(self) -> list[str]:
        """Parameters to update: as listed; left out and without stages, the modulus."""
        if self.parameters is None:
            return [] if self.stages is not None else ["E"]
        return self.parameters
