"""The tables of a study file, read strictly: a misspelt key is an error and not a default."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

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
"""Points known no better than this say nothing of any structure [m]."""

LARGEST_SHAPE_ERROR = 10.0
"""Shapes known no better than this say nothing [-]."""

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


def _of_part(name: str, value: Any) -> bool:
    """Tell whether a key of ``[tolerances]`` names a single parameter."""
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
    """Where the model's origin lies, in the coordinates of the test [m]."""
    x: Vector = (1.0, 0.0, 0.0)
    """Direction of the model's x axis there [-]."""
    y: Vector = (0.0, 1.0, 0.0)
    """Direction of its y axis [-]; z completes them right-handed."""


class MeasurementTable(Strict):
    """``[test]`` and ``[baseline]``: where the data are and how they were taken."""

    files: list[str] = []
    """UFF files of raw hits or FRFs, or column text; several are one test."""
    modes: str | None = None
    """In their place, modes: a CSV table, UFF 55 or 2414, the JSON of ``identify --json``, or a ``.mat`` file
    with its ``layout``.
    """
    band: tuple[Annotated[float, in_unit("Hz"), Field(ge=0)], Hertz] | None = None
    """Band looked at [Hz]. Left out: all; of hits, to where the force is 20 dB down. Cut, with a warning, to
    where force and coherence leave information.
    """
    exponential_window: Rate = 0.0
    """Decay rate of a window applied before the file was written [1/s]; another one stated in the file is an
    error.
    """
    window_on: Literal["both", "responses"] | None = None
    """What that window was applied to. Left out: what the noise of the force shows."""
    window: Rate = 0.0
    """Decay rate of a further window, applied here [1/s]."""
    estimator: Literal["H1", "H2", "Hv"] = "H1"
    """How FRFs are averaged from hits."""
    use: list[tuple[str, int]] = []
    """Hits to use against the proposal, as ``[["12+Z", 3]]``; a point's hits are numbered through all runs
    and files.
    """
    leave: list[tuple[str, int]] = []
    """Hits to leave out, in the same form."""
    add: list[Hertz] = []
    """Modes to keep whatever the statistics say [Hz]."""
    drop: list[Hertz] = []
    """Modes that are none [Hz]."""
    order: Annotated[int, Field(ge=2, le=400)] | None = None
    """Highest model order [-]. Left out: 60."""
    references: list[str] = []
    """Degrees of freedom hit whose FRFs are used, as ``["1+Z"]``. Left out: all."""
    pairs: list[tuple[Hertz, Annotated[int, Field(ge=0)]]] = []
    """Partners stated by hand, as ``[[153.9, 3]]``: the mode measured at 153.9 Hz is the model's third; 0: it
    has none.
    """
    layout: str | None = None
    """Layout of column text, or of a ``.mat`` file."""
    sensor_masses: dict[str, Mass] = {}
    """Accelerometers whose mass is taken out of the FRFs [kg], as ``{ "25+Z" = 0.0086 }``; each must have
    been hit at its own place.
    """
    calibration: Annotated[float, in_unit(""), Field(gt=0.0)] = 0.02
    """Relative 1-sigma of the level of the FRFs [-]."""
    repeatability: Share = 0.0005
    """Relative 1-sigma of the frequencies from one mounting to the next [-]. From re-mounting, never from
    what a fit leaves.
    """
    position_sigma: Annotated[float, in_unit("m"), Field(ge=0.0, lt=LARGEST_ASTRAY)] = 0.001
    """1-sigma of the points hit, and of where a sensor sits [m]."""
    shape_sigma: Annotated[float, in_unit(""), Field(gt=0.0, lt=LARGEST_SHAPE_ERROR)] | None = None
    """Of modes: error of every component of a shape over the shape's r.m.s. [-], in place of what the table says. Left
    out where the table says nothing either: an update estimates it, a diagnosis takes 2 % times an unknown scale.
    """
    places: dict[Annotated[str, Field(pattern=r"^\d{1,9}$")], Place] = {}
    """Where points are whose file does not say so, or says it wrongly, in the coordinates of the test [m], as
    ``{ 12 = [0.1, 0.0, 0.3] }``. Left out of a model with nodes: those of the same numbers.
    """
    directions: dict[str, Vector] = {}
    """Which way sensors or hits point that point along no axis, in the coordinates of the test, as
    ``{ "12+X" = [0.7, 0.7, 0.0] }``: what is written 12+X is measured along that.
    """
    match_tolerance: Size | None = None
    """How far from the nodes (or elements) of matrices or a deck a point may lie [m]; farther off than nodes are apart
    it is put on the nearest. Left out: as far as nodes are apart.
    """
    points: list[PlannedPoint] = []
    """Of a test that is only planned: where it will be hit. Along a beam [m]; on a plate ``[x, y]`` [m]; on matrices
    and decks a node and its direction as ``"12+Z"``, or ``[x, y, z, "+z"]`` in model axes [m]. Left out: of beams
    eight, of plates 5 x 4, evenly.
    """
    sensor: PlannedPoint | None = None
    """Of a test that is only planned: where the sensor will sit, written likewise. Left out: of a beam the free end,
    else the point hit at which the faintest mode is strongest.
    """
    hits: int | None = Field(None, ge=1)
    """Of a test that is only planned: how often each point is hit. Left out: 5."""
    axes: AxesTable = AxesTable()
    """The model's axes in the coordinates of the test."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """See that the band is one, and that modes come without what is said of records and FRFs."""
        rising("band", self.band)
        if self.modes is None:
            if self.shape_sigma is not None:
                raise ValueError(
                    "shape_sigma is of modes; of files the identification says how well shapes are known: leave it out"
                )
            return self
        if self.files:
            raise ValueError("files and modes are both given; modes stand in place of files: leave one out")
        of_mat = self.modes.lower().endswith(".mat")
        if of_mat and self.layout is None:
            raise ValueError(
                f'modes = {self.modes!r} is a MATLAB file: layout = "layout.toml" has to say which of its variables is '
                "what (docs/howto/matlab.md)"
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
    """Damping ratio of each mode [-]. All left out: unknown."""


class MassTable(Strict):
    """``[[model.mass]]``."""

    at: Annotated[list[Length], Field(min_length=1, max_length=3)]
    """Where it sits; of beams and plates in doubt by `position_sigma` [m]."""
    mass: Mass
    """A mass that the modeller knows of; of beams and plates in doubt by 2 % [kg]."""
    inertia: Inertia = 0.0
    """Its rotary inertia [kg m2]."""


class RegionTable(Strict):
    """``[[model.region]]``."""

    name: str = Field(min_length=1)
    """Its name; regions of one name are updated as one."""
    set: str | None = None
    """``calculix``: the element set or material, where that has another name."""
    x: Span | None = None
    """From, to along x [m]."""
    y: Span | None = None
    """From, to across, of plates [m]."""
    E: Modulus | None = None
    """Its own, in place of the model's [Pa]."""
    density: Density | None = None
    """Likewise [kg/m3]."""
    thickness: Size | None = None
    """Likewise [m]."""
    area: Area | None = None
    """Of beams [m2]."""
    inertia: SecondMoment | None = None
    """Second moment of area, of beams [m4]."""
    shear_coefficient: ShearCoefficient | None = None
    """Shear coefficient of the section, of beams; left out, that of a rectangle: 0.5 a thin tube, 0.9 a rod [-]."""
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
    """What matrices or deck are written in. Left out: ``m-kg-s``."""
    length: Length | None = None
    """Along x [m]."""
    width: Length | None = None
    """Along y [m]."""
    thickness: Length | None = None
    """Along z, the direction of hitting [m]."""
    elements: int | list[int] | None = None
    """Of beams a number (40), of plates two (38, 20); refined until the model stands."""
    clamped: list[str] = []
    """Of ``x0``, ``x1``, and for plates ``y0``, ``y1``."""
    theory: str | None = None
    """Beams: ``euler-bernoulli`` (taken if left out), ``rayleigh``, ``timoshenko``; plates: ``kirchhoff``,
    ``mindlin``.
    """
    deck: str | None = None
    """``calculix``: the input deck."""
    stiffness: str | None = None
    """``matrices``: file of the stiffness matrix."""
    mass_matrix: str | None = None
    """``matrices``: file of the mass matrix; may be written ``mass`` where there is no ``[[model.mass]]``."""
    stiffness_parts: list[str] = []
    """``matrices``: one file for each region, in their order."""
    mass_parts: list[str] = []
    """``matrices``: likewise."""
    nodes: str | None = None
    """``matrices``: node table (CSV), or the deck they come from."""
    material: MaterialTable | None = None
    damping: DampingTable = DampingTable()
    mass: list[MassTable] = []
    region: list[RegionTable] = []
    effect: list[dict[str, Any]] = []
    """Accepted effects, each with ``name`` and its parameters: put into the model, the rest is diagnosed."""


class TolerancesTable(Strict):
    """``[tolerances]``: the modeller's own doubts, relative standard deviations."""

    E: Share = 0.01
    """The modeller's own doubt [-]."""
    density: Share = 0.003
    """Likewise [-]."""
    thickness: Share = 0.005
    """Likewise [-]."""
    length: Share = 0.002
    """Likewise [-]."""
    width: Share = 0.002
    """Likewise [-]."""
    damping: Doubt = Field(0.3, ge=1e-6)
    """Doubt in the expected damping of each mode; half of its variance again is common to all modes [-]."""
    parts: dict[str, Doubt] = {}
    """Of single parameters, written ``web.E = 0.2`` or ``"web.E" = 0.2``: of a region, beside what all have in
    common (in an update in its place); and of numbers of a deck that an update turns [-].
    """
    bounds: dict[str, tuple[float, float]] = {}
    """Between which parameters lie, as ``{ "web.E" = [0.8, 1.1] }``: as factors, others in their unit. Without a
    tolerance of its own such a one lies anywhere between them.
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
    """Of a fluid around the structure [kg/m3]. Left out: a broad prior."""
    free_surface: Size | None = None
    """Above the structure (+z) [m]."""
    bottom: Size | None = None
    """Below it [m]."""
    walls: tuple[Length, Length, Length, Length] | None = None
    """``[x0, x1, y0, y1]`` in model axes [m]. Left out: unbounded, beside the wall of a clamp."""

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
    """What is turned. Left out: ``["E"]``."""
    weights: Literal["covariance", "relative", "eigenvalue"] | list[Weight] = "covariance"
    """Of ``eigenvalue``: a rule, or a weight for each mode."""
    lines: Annotated[int, Field(ge=1)] | list[Hertz] | None = None
    """Of ``frf``: how many frequency lines a stage compares, or which [Hz]. Left out: 100."""
    stages: list[list[str]] | None = None
    """Of ``frf``: lists of parameters settled one after the other, in place of ``parameters``. Left out: mass
    and stiffness, then damping.
    """
    data: list[Literal["frequencies", "shapes", "constants"]] = ["frequencies"]
    """Of ``eigenvalue``: add ``"shapes"``, or ``"constants"`` for shapes with their level."""

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
