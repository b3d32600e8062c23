"""The tables of a study file, read strictly: a misspelt key is an error and not a default."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from modalkit.study.planned_points import PlannedPoint
from modalkit.study.strict import Strict, rising
from modalkit.study.units import (
    Hertz,
    Length,
    Mass,
    Rate,
    Share,
    Size,
    in_unit,
    share_or,
)

Place = tuple[Length, Length, Length]
Vector = tuple[float, float, float]


LARGEST_ASTRAY = 100.0
"""Points with larger uncertainty than this are not informative for any structure [m]."""

LARGEST_SHAPE_ERROR = 10.0
"""Shapes with larger uncertainty than this are not informative [-]."""

Fluid = Annotated[float, in_unit("kg/m^3"), Field(gt=0, lt=30e3)]
Weight = Annotated[float, Field(ge=0, lt=1e50)]
Doubt = Annotated[float, in_unit(""), Field(ge=0)]
Tolerance = Annotated[float | Literal["free"], share_or("free")]


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
    """Relative 1-sigma of the absolute level of the FRFs [-]. A test and a baseline with the same value are taken to be
    measured through one chain, whose level repeats to 2 %.
    """
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
    lines: list[tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]]] = []
    """Points joined by lines in drawings and exports, as ``[[1, 2], [2, 3]]``. Default: those of the file, else
    the neighbours in the rows of a grid.
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
                    "with files, the identification gives the uncertainty of shapes"
                    if self.files
                    else "for a planned test, the forecast states the uncertainty that it assumes"
                )
                raise ValueError(f"shape_sigma is for modes only. Leave it out: {instead}")
            return self
        if self.files:
            raise ValueError("files and modes are both given, but modes replace files: leave one out")
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
                f"{', '.join(stated)}: is for records or FRFs, but modes = {self.modes!r} names modes; "
                f"leave it out, and change the modes themselves if needed{way}"
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


class TolerancesTable(Strict):
    """``[tolerances]``: the modeller's own doubts, relative standard deviations."""

    E: Tolerance = 0.01
    """Of Young's modulus [-]; "free" where nothing is known of it: an update is not pulled to the nominal value."""
    density: Tolerance = 0.003
    """Of the density [-], or "free"."""
    thickness: Tolerance = 0.005
    """Of the thickness [-], or "free"."""
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
