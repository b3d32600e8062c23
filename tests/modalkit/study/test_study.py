"""Study files: what is left out, what is understood, and one line for what is wrong."""

import re
from pathlib import Path

import numpy as np
import pytest

from acquisition.errors import StudyError
from modalkit.study.read import Study, read_study

BEAM = """
[model]
type = "beam"
length = 0.376
width = 0.0305
thickness = 0.0047625
[model.material]
E = 210e9
density = 7850.0
"""
PLATE = BEAM.replace("beam", "plate").replace("0.0305", "0.2")
MASS = "[[model.mass]]\nat = {}\nmass = 0.01\n"
REGION = "[[model.region]]\nname = 'a'\nx = [0.0, 0.1]\n"
TEST = '[test]\nfiles = ["a.uff"]\n'


def study(folder: Path, text: str) -> Study:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return read_study(path)


def complaint(folder: Path, text: str) -> str:
    """What a wrong study file is told, reading and using it."""
    with pytest.raises(StudyError) as caught:
        found = study(folder, text)
        found.spec()
        found.axes(found.test)
        found.accepted()
    message = str(caught.value)
    assert "\n" not in message
    assert "study.toml" in message
    return message


def test_defaults_are_those_of_the_contract(tmp_path: Path) -> None:
    found = study(tmp_path, TEST)
    assert found.test.band is None
    assert (found.test.exponential_window, found.test.calibration) == (0.0, 0.02)
    assert (found.test.repeatability, found.test.position_sigma) == (0.0005, 0.001)
    axes = found.axes(found.test)
    assert (axes.origin, axes.x, axes.y) == ((0, 0, 0), (1, 0, 0), (0, 1, 0))
    doubts = found.doubts()
    assert dict(doubts.factors) == {
        "E": 0.01,
        "density": 0.003,
        "thickness": 0.005,
        "length": 0.002,
        "width": 0.002,
    }
    assert doubts.damping == 0.3
    around = found.surroundings()
    assert (around.fluid_density, around.free_surface, around.bottom, around.walls) == (
        None,
        None,
        None,
        None,
    )
    assert found.accepted() == ()
    assert found.update.method == "eigenvalue"
    assert found.name == tmp_path.name


@pytest.mark.parametrize("place", ['"350 mm"', "0.35", "[0.35]", '["350 mm"]'])
def test_a_mass_on_a_beam_is_at_a_number_or_at_a_point(tmp_path: Path, place: str) -> None:
    assert study(tmp_path, TEST + BEAM + MASS.format(place)).spec().masses[0].at == (0.35,)


def test_modes_that_cannot_be_dropped_say_what_leaves_them_out(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"lines of the table.*or set `band`"):
        study(tmp_path, '[test]\nmodes = "m.csv"\ndrop = [30.0]\n')


def test_a_beam_with_everything(tmp_path: Path) -> None:
    text = (
        'title = "T"\n[test]\nmodes = "m.csv"\nband = [5.0, 100.0]\ncalibration = 0.1\n'
        "axes = { origin = [1.0, 0.0, 0.0], x = [0.0, 1.0, 0.0], y = [-1.0, 0.0, 0.0] }\n"
        + BEAM.replace(
            "[model.material]", 'elements = 12\nclamped = ["x0"]\ntheory = "timoshenko"\n[model.material]'
        )
        + "poisson = 0.25\n[model.damping]\nalpha = 1.0\nbeta = 5e-7\n"
        "[[model.mass]]\nat = [0.376]\nmass = 0.01\ninertia = 1e-6\n"
        '[[model.region]]\nname = "root"\nx = [0.0, 0.1]\nE = 2e11\n'
        '[[model.region]]\nname = "rest"\nx = [0.1, 0.376]\narea = 1e-4\ninertia = 1e-10\nloss_factor = 0.01\n'
        '[[model.effect]]\nname = "clamp_rotation"\nstiffness = 4000\n'
        "[tolerances]\nE = 0.0\n[environment]\nfluid_density = 998.0\nwalls = [-0.1, 0.5, -0.1, 0.1]\n"
    )
    found = study(tmp_path, text)
    spec = found.spec()
    assert (spec.kind, spec.elements, spec.clamped, spec.theory) == ("beam", (12,), ("x0",), "timoshenko")
    assert (spec.length, spec.width, spec.thickness) == (0.376, 0.0305, 0.0047625)
    assert (spec.material.E, spec.material.density, spec.material.poisson) == (210e9, 7850.0, 0.25)
    assert (spec.damping.alpha, spec.damping.beta, spec.damping.known) == (1.0, 5e-7, True)
    assert (spec.masses[0].at, spec.masses[0].mass, spec.masses[0].inertia) == ((0.376,), 0.01, 1e-6)
    assert [r.name for r in spec.regions] == ["root", "rest"]
    assert (spec.regions[0].E, spec.regions[1].area, spec.regions[1].loss_factor) == (2e11, 1e-4, 0.01)
    assert found.accepted() == (("clamp_rotation", {"stiffness": 4000.0}),)
    assert found.doubts().factors["E"] == 0.0
    assert found.surroundings().walls == (-0.1, 0.5, -0.1, 0.1)
    assert found.name == "T"
    assert found.file("a/b.uff") == tmp_path / "a" / "b.uff"
    np.testing.assert_allclose(found.axes(found.test).to_model(np.array([[1.0, 0.3, 0.0]]))[0], [0.3, 0, 0])


def test_a_plate_and_what_is_left_out_of_models(tmp_path: Path) -> None:
    plate = study(
        tmp_path, TEST + PLATE.replace("[model.material]", "elements = [10, 6]\n[model.material]")
    ).spec()
    assert (plate.kind, plate.elements, plate.clamped, plate.theory) == ("plate", (10, 6), (), "kirchhoff")
    assert len(plate.regions) == 15
    assert plate.regions[0].y == pytest.approx((0.0, 0.2 / 3))
    beam = study(tmp_path, TEST + BEAM).spec()
    assert (beam.theory, len(beam.regions), beam.material.poisson) == ("euler-bernoulli", 10, 0.3)
    assert beam.regions[-1].x == pytest.approx((0.9 * 0.376, 0.376))
    assert not beam.damping.known


def test_a_baseline_has_the_keys_of_a_test(tmp_path: Path) -> None:
    found = study(tmp_path, TEST + '[baseline]\nfiles = ["dry.uff"]\ncalibration = 0.05\n')
    assert found.baseline is not None
    assert (found.baseline.files, found.baseline.calibration) == (["dry.uff"], 0.05)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[test]\nfile = ['a']\n", r"unknown key test\.file; known here: files, modes, band"),
        (TEST + "[tolerance]\nE = 0.1\n", r"unknown key tolerance; known here: .*tolerances"),
        (TEST + BEAM.replace("length", "lenght"), r"unknown key model\.lenght; known here: .*length"),
        (TEST + BEAM + "rho = 3.0\n", r"unknown key model\.material\.rho; known here: E, density, poisson"),
        (TEST + "axes = { z = [0, 0, 1] }\n", r"unknown key test\.axes\.z; known here: origin, x, y"),
        (TEST + BEAM + "[[model.region]]\nname='a'\nx=[0.0,0.1]\nrho=1\n", r"model\.region\.0\.rho"),
        (TEST + "band = 5.0\n", r"test\.band"),
        (TEST + 'calibration = "good"\n', r"test\.calibration"),
        (TEST + "calibration = 0.0\n", r"test\.calibration: input should be greater than 0"),
        (TEST + "exponential_window = -1.0\n", r"test\.exponential_window"),
        ("title = 'x'\n", r"test: field required"),
        (TEST + BEAM.replace("beam", "shell"), r"model\.type"),
        (TEST + BEAM.replace("210e9", "-1.0"), r"model\.material\.E"),
        (TEST + BEAM + "poisson = 0.5\n", r"model\.material\.poisson"),
        (TEST + "[update]\nmethod = 'magic'\n", r"update\.method"),
        (TEST + "[environment]\nfree_surface = -0.1\n", r"environment\.free_surface"),
        (TEST, r"needs a \[model\]"),
        (TEST + BEAM.replace("width = 0.0305\n", ""), r"\[model\] of type beam needs width"),
        (TEST + "[model]\ntype = 'matrices'\n", r"\[model\]"),
        (
            TEST + BEAM + "[[model.effect]]\nname = 'gremlin'\nfactor = 1.0\n",
            r"unknown effect 'gremlin'.*modalkit effects",
        ),
        (TEST + BEAM + "[[model.effect]]\nfactor = 1.0\n", r"model\.effect"),
        ("[test\n", r"not a valid TOML"),
        ("path = 'b.toml'\n" + TEST, r"unknown key path"),
        (TEST + BEAM.replace("length = 0.376", "length = -1.0"), r"length must be positive"),
        (TEST + BEAM.replace("[model.material]", "clamped=['y0']\n[model.material]"), r"no edge"),
        (TEST + BEAM.replace("[model.material]", "elements=[3, 4]\n[model.material]"), r"elements"),
        (TEST + BEAM.replace("[model.material]", "theory='kirchhoff'\n[model.material]"), r"theory"),
        (TEST + "axes = { x = [1, 1, 0] }\n" + BEAM, r"not perpendicular"),
        (TEST + BEAM + "[[model.effect]]\nname = 'E'\nfactor = 'big'\n", r"factor"),
        (
            TEST + BEAM.replace("[model.material]", "elements=1000000000\n[model.material]"),
            r"more than 20000",
        ),
        (TEST + BEAM + MASS.format("[99.0]"), r"x = 99 m is off the beam, which reaches from 0 to 0\.376"),
        (TEST + BEAM + MASS.format("[-5]"), r"x = -5 m is off the beam"),
        (TEST + PLATE + MASS.format("[0.1, 0.9]"), r"y = 0\.9 m is off the plate"),
        (TEST + BEAM + MASS.format("[0.1, 0.0]"), r"needs 1 coordinate on a beam, found 2"),
        (TEST + BEAM + MASS.format("[0.1, 0.0, 0.0, 0.0, 0.0]"), r"model\.mass\.0\.at"),
        (TEST + BEAM + MASS.format("[]"), r"model\.mass\.0\.at"),
        (TEST + BEAM + MASS.format("[true]"), r"at cannot be true or false"),
        (TEST + BEAM + MASS.format("[0.1]") + "inertia = -1.0\n", r"model\.mass\.0\.inertia.*found -1"),
        (TEST + BEAM + REGION + "E = -210e9\n", r"model\.region\.0\.E: .*greater than 0, found -2"),
        (TEST + BEAM + REGION + "density = 0.0\n", r"model\.region\.0\.density"),
        (TEST + BEAM + REGION + "thickness = -0.01\n", r"model\.region\.0\.thickness"),
        (TEST + BEAM + REGION + "area = 0\n", r"model\.region\.0\.area"),
        (TEST + BEAM + REGION + "inertia = -1\n", r"model\.region\.0\.inertia"),
        (TEST + BEAM + REGION + "loss_factor = -1\n", r"model\.region\.0\.loss_factor"),
        (TEST + BEAM + REGION + "alpha = -1\n", r"model\.region\.0\.alpha"),
        (TEST + BEAM + REGION + "thickness = 1e300\n", r"thickness = 1e\+300 is .* times that of the beam"),
        (TEST + BEAM + REGION + "density = 1e-300\n", r"density = 1e-300 is .* times that of the beam"),
        (TEST + BEAM + MASS.format("[0.1]").replace("0.01", "1e300"), r"mass = 1e\+300 is .* times that of"),
        (TEST + BEAM + "[model.damping]\nbeta = 1e300\n", r"model\.damping\.beta: .*less than 1000"),
        (TEST + "[environment]\nfluid_density = 1e300\n", r"environment\.fluid_density: .*less than 30000"),
        (TEST + "position_sigma = 1e300\n", r"test\.position_sigma"),
        (TEST + BEAM + REGION + "y = [0.0, 0.1]\n", r"region 'a' has y, but a beam has x only"),
        (TEST + PLATE + REGION + "area = 1e-4\n", r"area or inertia; those are of beams"),
        (TEST + BEAM + REGION.replace("0.1]", "0.1, 0.2, 0.3, 0.4]"), r"model\.region\.0\.x"),
        (TEST + BEAM + REGION.replace("0.1]", "0.7]"), r"region 'a': x = 0\.7 m is off the beam"),
        (TEST + BEAM + REGION.replace("0.0,", "0.3,"), r"x = \[0\.3, 0\.1\] ends before it begins"),
        (TEST + BEAM + "[model.damping]\nratios = [-1, 5]\n", r"model\.damping\.ratios\.0.*found -1"),
        (TEST + BEAM + "[model.damping]\nratios = []\n", r"model\.damping\.ratios"),
        (TEST + BEAM + "[model.damping]\nloss_factor = 30\n", r"model\.damping\.loss_factor: .*less than 5"),
        (TEST + BEAM + "[model.damping]\nalpha = -2\n", r"model\.damping\.alpha"),
        (TEST + "band = [100.0, 5.0]\n", r"band = \[100, 5\] ends before it begins"),
        (TEST + "band = [-1.0, 5.0]\n", r"test\.band\.0"),
        (TEST + "add = [0.0]\n", r"test\.add\.0"),
        (TEST + "sensor_masses = { '1+Z' = -0.1 }\n", r"test\.sensor_masses"),
        (TEST + "repeatability = 2.0\n", r"test\.repeatability: .*less than 1"),
        (TEST + "hits = true\n", r"hits cannot be true or false"),
        (TEST + "[tolerances]\nE = 5\n", r"tolerances\.E: 5 must be at least 0 and below 1"),
        (TEST + "[tolerances]\nE = -0.1\n", r"tolerances\.E"),
        (TEST + "[environment]\nwalls = [1.0, 0.0, 0.0, 1.0]\n", r"walls x0, x1 = \[1, 0\]"),
        (TEST + "[update]\nlines = 0\n", r"update\.lines"),
        (TEST + "[update]\nweights = [-1.0]\n", r"update\.weights"),
        (TEST.replace("files", "modes = 'm.csv'\nfiles"), r"files and modes are both given"),
        ("[test]\nmodes = 'm.csv'\ndrop = [3.0]\n", r"drop: is for records or FRFs, but modes = 'm.csv'"),
        ("[test]\nmodes = 'm.csv'\nexponential_window = 3.0\n", r"exponential_window: is for records"),
        (TEST + BEAM.replace("length", "lenght"), r"is 'length' meant\?"),
        (TEST + BEAM + "[[model.effect]]\nname = 'sensor_mas'\nmass = 1.0\n", r"is 'sensor_mass' meant\?"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path: Path, text: str, says: str) -> None:
    assert re.search(says, complaint(tmp_path, text))


def test_a_mass_on_a_plate_needs_two_coordinates(tmp_path: Path) -> None:
    assert "mass" in complaint(tmp_path, TEST + PLATE + "[[model.mass]]\nat = [0.3]\nmass = 0.01\n")


def test_a_place_may_miss_the_edge_by_digits_that_are_not_written_out(tmp_path: Path) -> None:
    text = TEST + BEAM + MASS.format("[0.3761]") + REGION.replace("0.1]", "0.37605]")
    assert study(tmp_path, text).spec().masses[0].at == (0.3761,)


def test_constants_may_be_data(tmp_path: Path) -> None:
    text = TEST + '[update]\ndata = ["frequencies", "constants"]\n'
    assert study(tmp_path, text).update.data == ["frequencies", "constants"]


def test_a_file_that_is_not_there_or_is_no_text(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"nowhere\.toml: cannot be read \(No such file"):
        read_study(tmp_path / "nowhere.toml")
    with pytest.raises(StudyError, match="cannot be read"):
        read_study(tmp_path)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(StudyError, match=r"binary\.toml: not a valid TOML"):
        read_study(tmp_path / "binary.toml")


def test_a_study_file_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    """As editors on some systems write it."""
    path = tmp_path / "study.toml"
    path.write_bytes(b"\xef\xbb\xbf" + TEST.encode())
    assert read_study(path).test.files == ["a.uff"]


@pytest.mark.parametrize("text", ["x = " + "[" * 20_000, "x = " + "{a=" * 20_000, "x = " + "9" * 6000])
def test_toml_deeper_than_a_stack_or_longer_than_a_number(tmp_path: Path, text: str) -> None:
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(StudyError, match="not a valid TOML file"):
        read_study(tmp_path / "study.toml")


def test_doubts_by_part_are_written_as_names_or_as_tables(tmp_path: Path) -> None:
    text = TEST + BEAM + REGION + "[tolerances]\nE = 0.02\na.E = '20 %'\n'a.density' = 0.1\n"
    found = study(tmp_path, text + "bounds.a.E = [0.5, 1.5]\n").doubts()
    assert found.factors["E"] == 0.02
    assert found.parts == {"a.E": 0.2, "a.density": 0.1}
    assert found.bounds == {"a.E": (0.5, 1.5)}
    assert study(tmp_path, text + "bounds = { 'a.E' = [0.5, 1.5] }\n").doubts() == found
    for wrong, message in (
        ("a.E = -0.1\n", r"tolerances\.parts\.a\.E"),
        ("bounds.a.E = [1.5, 0.5]\n", r"bounds of a\.E = \[1\.5, 0\.5\] ends before it begins"),
        ("densty = 0.1\n", r"unknown key tolerances\.densty.*is 'density' meant"),
    ):
        with pytest.raises(StudyError, match=message):
            study(tmp_path, TEST + BEAM + REGION + "[tolerances]\n" + wrong)
