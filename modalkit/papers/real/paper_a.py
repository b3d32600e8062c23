"""Paper A: a cantilever beam and a cantilever plate of steel, dry and in a tank of water."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from modalkit.papers.real.case import PUBLISHED, SYNTHETIC, Case, Fact, Source, sets

_WATER = Fact("fluid_added_mass.fluid_density", 990.0, 1000.0, "water, 990 to 1000 kg/m3")
_VISCOUS = Fact("fluid_damping.viscosity", 0.9e-3, 1.1e-3, "water, 1 mPa s")
_CLAMP = Fact("length.extension", 0.011, 0.018, "11 to 18 mm inside the clamp")
_SENSOR = Fact("sensor_mass.mass", 0.002, 0.011, "2 to 11 g")
_SAME = "a uniform cantilever's frequencies rise and fall by one factor with E, density, thickness and length"
_UNIFORM = "on a slender beam the water is a mass per length, nearly the same for all modes: a density"
_MASS_AT_CORNER = "a lumped mass at the free corner is the sensor's mass under another name"


def _published(specimen: str, *, drop: tuple[str, ...] = ()) -> Source:
    return Source(Path(specimen) / "published.toml", drop=drop)


_BEAM_WET = Case(
    name="beam in water",
    kind=PUBLISHED,
    sources=(_published("beam_wet"),),
    withheld="the water; the dry test is the baseline",
    known="water (998 kg/m3 at 20 C)",
    source="180 mm of water above, 190 mm below; paper A, section 4 and Tables 1 and 2",
    accepted=sets("fluid_added_mass"),
    stands_in=sets("density", "E"),
    why=_UNIFORM,
    facts=(_WATER,),
)
_PLATE_WET = replace(
    _BEAM_WET,
    name="plate in water",
    sources=(_published("plate_wet"),),
    source="180 mm of water above, 190 mm below; paper A, section 4 and Tables 3 and 4",
    stands_in=(),
    why="none: one factor of mass leaves 12.8 % on the plate",
)
_DRY_CAUSES = ("length", "sensor_mass", "E", "density", "thickness")
_WET_ALONE = sets(*(f"fluid_added_mass + {name}" for name in _DRY_CAUSES))
_BEAM_WET_ALONE = replace(
    _BEAM_WET,
    name="beam in water, no baseline",
    sources=(_published("beam_wet", drop=("baseline",)),),
    withheld="the water, and the dry test",
    known="water, and what the dry one lacks",
    accepted=_WET_ALONE,
    equivalent=sets("E", "density", "thickness", "length"),
    why=_SAME + "; so does a mass per length",
)
_PLATE_WET_ALONE = replace(
    _BEAM_WET_ALONE,
    name="plate in water, no baseline",
    sources=(_published("plate_wet", drop=("baseline",)),),
    source=_PLATE_WET.source,
    equivalent=(),
    why="none: one factor of mass leaves 14.3 % on the plate",
)
_PLATE_DRY = Case(
    name="dry plate",
    kind=PUBLISHED,
    sources=(_published("plate_dry"),),
    withheld="how deep it bends inside its clamp, and the accelerometer's mass",
    known="bends 11 to 18 mm inside its clamp; accelerometer, 2 to 11 g",
    source="an accelerometer in a free corner (the plate) or at the free end (the beam), clamped in a wall; neither "
    "depth nor mass was measured, the ranges are those that earlier fits to all 15 dry frequencies allow; "
    "paper A, section 4, Tables 1 and 3",
    accepted=sets("length + sensor_mass"),
    equivalent=sets("length + lumped_mass"),
    stands_in=sets("clamp_rotation + lumped_mass", "clamp_rotation + clamp_translation"),
    why=f"{_MASS_AT_CORNER}; a soft clamp is what a deep one comes near to",
    facts=(_CLAMP, _SENSOR),
)
_BEAM_DRY = replace(
    _PLATE_DRY,
    name="dry beam",
    sources=(_published("beam_dry"),),
    accepted=sets("length", "length + sensor_mass"),
    equivalent=sets("E", "density", "thickness"),
    stands_in=sets("E", "density", "thickness"),
    why=f"{_SAME}: 0.20 % with either, on three frequencies",
    facts=(),
)
_BOTH_DRY = replace(
    _PLATE_DRY,
    name="dry beam and dry plate",
    sources=(_published("beam_dry"), _published("plate_dry")),
    shared=("length", "sensor_mass"),
)
_BEAM_WET_FILE = replace(
    _BEAM_WET,
    name="beam in water, FRFs",
    kind=SYNTHETIC,
    sources=(Source(Path("beam_wet/study.toml")),),
    source="made with potential flow of 998 kg/m3 in the tank and a viscous layer, then moved to the printed "
    "frequencies; sample_data/README.md",
    accepted=sets("fluid_added_mass", "fluid_added_mass + fluid_damping"),
    facts=(_WATER, _VISCOUS),
)
_PLATE_WET_FILE = replace(
    _BEAM_WET_FILE,
    name="plate in water, FRFs",
    sources=(Source(Path("plate_wet/study.toml")),),
    stands_in=(),
    why=_PLATE_WET.why,
)

PAPER_A: tuple[Case, ...] = (
    _BEAM_WET,
    _PLATE_WET,
    _BEAM_WET_ALONE,
    _PLATE_WET_ALONE,
    _BEAM_DRY,
    _PLATE_DRY,
    _BOTH_DRY,
    _BEAM_WET_FILE,
    _PLATE_WET_FILE,
)
"""The library is whole."""

PAPER_A_LEFT_OUT: tuple[Case, ...] = (
    _BEAM_WET.left_out(),
    _PLATE_WET.left_out(),
    _BEAM_DRY.left_out(),
    _PLATE_DRY.left_out(),
    _BOTH_DRY.left_out(),
)
"""The true effects are taken out of it."""
