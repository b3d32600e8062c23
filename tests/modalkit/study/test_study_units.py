"""Quantities with units in a study, and numbers that look like another unit's."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from acquisition.errors import StudyError
from acquisition.si_units import si_value
from modalkit.study.read import Study, read_study
from updating import LIBRARY
from updating.effects.specimens import example, unit_of
from updating.models.parts import PointMass

WITH_UNITS = """
[test]
files = ["a.uff"]
band = ["5 Hz", "1 kHz"]
exponential_window = "2 1/s"
window = "0.1 / ms"
add = ["0.1 kHz"]
sensor_masses = { "25+Z" = "8.6 g" }
calibration = "2 %"
repeatability = "0.05 %"
position_sigma = "1 mm"
points = ["50 mm", 0.1]
sensor = "14 in"
axes = { origin = ["1 cm", 0, 0] }
[model]
type = "beam"
length = "376 mm"
width = "30.5 mm"
thickness = "4.7625 mm"
clamped = ["x0"]
[model.material]
E = "210 GPa"
density = "7.85 g/cm3"
poisson = "30 %"
[model.damping]
alpha = "1 /s"
beta = "0.5 us"
loss_factor = "1 %"
ratios = ["1 %"]
[[model.mass]]
at = ["376 mm"]
mass = "10 g"
inertia = "3 g*m^2"
[[model.region]]
name = "root"
x = [0, "37.6 mm"]
E = "200 kN/mm^2"
density = "7.8 kg/dm^3"
thickness = "0.5 cm"
area = "1.5 cm^2"
inertia = "270 mm^4"
alpha = "2 Hz"
beta = "1 us"
loss_factor = "2 %"
[[model.effect]]
name = "clamp_rotation"
stiffness = "4 kN m/rad"
[[model.effect]]
name = "lumped_mass"
mass = "10 g"
x = "100 mm"
[tolerances]
E = "1 %"
[environment]
fluid_density = "0.998 kg/l"
free_surface = "20 cm"
walls = ["-10 cm", "50 cm", -0.1, 0.1]
[update]
lines = ["0.1 kHz"]
"""

IN_SI = """
[test]
files = ["a.uff"]
band = [5.0, 1000.0]
exponential_window = 2.0
window = 100.0
add = [100.0]
sensor_masses = { "25+Z" = 0.0086 }
calibration = 0.02
repeatability = 0.0005
position_sigma = 0.001
points = [0.05, 0.1]
sensor = 0.3556
axes = { origin = [0.01, 0, 0] }
[model]
type = "beam"
length = 0.376
width = 0.0305
thickness = 0.0047625
clamped = ["x0"]
[model.material]
E = 210e9
density = 7850.0
poisson = 0.3
[model.damping]
alpha = 1.0
beta = 5e-7
loss_factor = 0.01
ratios = [0.01]
[[model.mass]]
at = [0.376]
mass = 0.01
inertia = 0.003
[[model.region]]
name = "root"
x = [0, 0.0376]
E = 200e9
density = 7800.0
thickness = 0.005
area = 1.5e-4
inertia = 2.7e-10
alpha = 2.0
beta = 1e-6
loss_factor = 0.02
[[model.effect]]
name = "clamp_rotation"
stiffness = 4000.0
[[model.effect]]
name = "lumped_mass"
mass = 0.01
x = 0.1
[tolerances]
E = 0.01
[environment]
fluid_density = 998.0
free_surface = 0.2
walls = [-0.1, 0.5, -0.1, 0.1]
[update]
lines = [100.0]
"""


def study(folder: Path, text: str) -> Study:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return read_study(path)


def numbers(value: object) -> object:
    """Every number of a study, to nine digits."""
    if isinstance(value, dict):
        return {k: numbers(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [numbers(v) for v in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value


def test_a_study_with_units_is_the_one_in_si(tmp_path: Path) -> None:
    one, other = study(tmp_path, WITH_UNITS), study(tmp_path, IN_SI)
    assert one.spec() == other.spec()
    assert numbers(one.accepted()) == numbers(other.accepted())
    assert numbers({**one.model_dump(), "model": None}) == numbers({**other.model_dump(), "model": None})


@pytest.mark.parametrize(
    ("value", "unit", "says"),
    [
        ("376,5 mm", "m", "decimal point"),
        ("3 kg", "m", "not a quantity in m"),
        ("3 furlongs_", "m", "no unit 'furlongs_'"),
        ("300 rpm", "Hz", "angular"),
        ("20 rad/s", "1/s", "angular"),
        ("20 degC", "m", "not a quantity in m"),
        ("nan", "m", "not a quantity"),
        ("1e999 m", "m", "finite"),
        ("9**9**9 m", "m", "no unit"),
        ("1 m" + "*m" * 100, "m", "no unit"),
        ("1 __import__('os')", "m", "no unit"),
        ("1 dB", "", "a ratio is asked for"),
        ("1 m*s*", "m", "no unit"),
        ("", "m", "not a quantity"),
    ],
)
def test_what_is_no_quantity_is_refused(value: str, unit: str, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        si_value(value, unit)


def test_a_number_without_a_unit_is_in_the_unit_asked_for() -> None:
    assert si_value("376", "Pa s") == 376.0


@pytest.mark.parametrize("kind", ["beam", "plate"])
def test_effects_take_values_in_the_units_they_state(kind: str) -> None:
    predictor = example(kind)
    examined = [effect for effect in LIBRARY.values() if effect.why_not(predictor) is None]
    assert len(examined) > 15
    for effect in examined:
        for parameter in effect.parameters(predictor):
            unit = unit_of(effect, parameter.name, kind)
            assert (unit or "-") == parameter.unit, (effect.name, parameter.name)
            assert si_value(f"1 {unit}", unit) == 1.0


@pytest.mark.long
def test_the_table_of_units_is_loaded_only_where_a_unit_is_written(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    for text, loaded in ((IN_SI, "False"), (WITH_UNITS, "True")):
        path.write_text(text, encoding="utf-8")
        code = (
            "import sys; from pathlib import Path; from modalkit.study.read import read_study; "
            "read_study(Path(sys.argv[1])); print('pint' in sys.modules)"
        )
        done = subprocess.run(
            [sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True
        )
        assert done.stdout.strip() == loaded


BODY = """
[test]
files = ["a.uff"]
[model]
type = "{kind}"
length = {length}
width = {width}
thickness = {thickness}
[model.material]
E = {E}
density = {density}
"""
STEEL = {"kind": "beam", "length": 0.376, "width": 0.03, "thickness": 0.005, "E": 210e9, "density": 7850.0}


@pytest.mark.parametrize(
    ("wrong", "meant"),
    [
        ({"E": 210}, 'E = "210 GPa"'),
        ({"E": 210e3}, 'E = "210000 MPa"'),
        ({"density": 7.85}, 'density = "7.85 g/cm^3"'),
        ({"density": 7.85e-9}, 'density = "7.85e-09 t/mm^3"'),
        ({"E": 210e3, "density": 7.85e-9}, 'E = "210000 MPa" and density = "7.85e-09 t/mm^3"'),
        ({"E": 70, "density": 2.7}, 'E = "70 GPa" and density = "2.7 g/cm^3"'),
        ({"thickness": 5}, 'thickness = "5 mm"'),
        ({"kind": "plate", "thickness": 5}, 'thickness = "5 mm"'),
        ({"thickness": 1e300}, "this is implausible for a"),
        ({"thickness": 2e-7}, "that thin"),
        ({"length": 1e-300, "thickness": 1e-301}, "this is implausible for a"),
        ({"E": 1e-300}, "no solid"),
        ({"E": 1e300, "density": 1e300}, "no solid"),
    ],
)
def test_numbers_in_other_units_are_refused_with_the_unit_meant(
    tmp_path: Path, wrong: dict[str, object], meant: str
) -> None:
    with pytest.raises(StudyError) as caught:
        study(tmp_path, BODY.format(**(STEEL | wrong))).spec()
    assert meant in str(caught.value)


@pytest.mark.parametrize(
    ("modulus", "density"),
    [
        (210e9, 7850.0),
        (1.2e12, 3510.0),
        (16e9, 11340.0),
        (1e6, 1100.0),
        (1e5, 1000.0),
        (4e9, 160.0),
        (1e8, 30.0),
    ],
)
def test_every_solid_is_taken_as_it_is(tmp_path: Path, modulus: float, density: float) -> None:
    """Steel, diamond, lead, rubber, soft silicone, balsa, foam."""
    spec = study(tmp_path, BODY.format(**(STEEL | {"E": modulus, "density": density}))).spec()
    assert (spec.material.E, spec.material.density) == (modulus, density)


def test_a_mass_in_millimetres_is_named_so(tmp_path: Path) -> None:
    text = BODY.format(**STEEL) + "[[model.mass]]\nat = [376]\nmass = 0.01\n"
    with pytest.raises(StudyError, match=r'off the beam.*if it is in mm, write "376 mm"'):
        study(tmp_path, text).spec()
    text = text.replace("[376]", '["376 mm"]')
    assert study(tmp_path, text).spec().masses == (PointMass((0.376,), 0.01),)


def test_a_tolerance_may_be_free(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(WITH_UNITS.replace('E = "1 %"', 'E = "free"\ndensity = "1 %"'))
    stated = read_study(path).doubts()
    assert stated.free == {"E"}
    assert stated.of("E", "E") == 0.0
    assert stated.factors["E"] > 1.0
    assert stated.factors["density"] == 0.01


@pytest.mark.parametrize("value", ["1", "-0.1", '"open"'])
def test_a_tolerance_is_a_share_or_free(tmp_path: Path, value: str) -> None:
    path = tmp_path / "study.toml"
    path.write_text(WITH_UNITS.replace('E = "1 %"', f"E = {value}"))
    with pytest.raises(StudyError, match=r"tolerances.E: "):
        read_study(path)
