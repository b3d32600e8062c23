"""Ribbed plates and brackets on the rig, against modes of CalculiX and the library's effects at the hidden values."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from modalkit.blind.trial import Trial, draw_trial, write_trial
from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.bodies.block.shape import SHAPES
from modalkit.simulator.bodies.solid.deck import Bricks, deck, run
from modalkit.simulator.bodies.solid.solid import available
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.hidden import effects_of
from modalkit.simulator.scene import nominal_scene
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from updating import LIBRARY, Predictor, diagnose
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.goodness import p_value
from updating.diagnosis.search.points import evaluate
from updating.problem.candidate import Candidate
from updating.test_data.measured import Measured
from updating.thresholds import REGION_MESH_DOUBT

pytestmark = pytest.mark.skipif(not available(), reason="needs CalculiX")

KINDS = ("ribbed", "bracket")
SIZES = {"ribbed": (0.4, 0.28, 0.005, 0.015, 0.008), "bracket": (0.3, 0.2, 0.008, 0.08, 0.010)}
E, DENSITY, POISSON = 210e9, 7850.0, 0.3


def body(kind: str, elements: int = 6) -> Block:
    length, width, thickness, height, breadth = SIZES[kind]
    return Block(
        kind=kind,
        start=0.0,
        end=length,
        width=width,
        thickness=thickness,
        height=height,
        breadth=breadth,
        E=E,
        density=DENSITY,
        poisson=POISSON,
        elements=elements,
    )


@cache
def trial(kind: str, *effects: str) -> Trial:
    plan = DrawRanges(kinds=(kind,), effects=effects, none=0.0, pairs=0.0, outside=0.0, mild=0.0, strong=0.0)
    return draw_trial(5, 0, plan=plan)


def test_a_ribbed_plate_has_the_modes_that_calculix_finds_itself() -> None:
    plate = body("ribbed")
    mesh = plate.bricks.mesh
    cut = np.all([bricks.cut for bricks in mesh.bricks.values()], axis=0)
    numbers = mesh.nodes[0]
    held = [(int(numbers[n]), d) for nodes in plate.bricks.feet.values() for n in nodes for d in (1, 2, 3)]
    text = deck(
        Bricks(mesh.x, mesh.y, mesh.z, cut), E=E, density=DENSITY, poisson=POISSON, held=held, points=[],
        count=8,
    )  # fmt: skip
    tip = numbers[plate.bricks.top[-1]]
    omega, moved = run(
        text.replace("NSET=READ\n", "NSET=READ\n" + "".join(f"{n},\n" for n in tip), 1), read=tip
    )
    found, shapes = plate.real_modes(8)
    assert found == pytest.approx(omega[:8], rel=1e-5)
    here = shapes[3 * plate.bricks.top[-1] + 2]
    signs = np.sign(np.sum(here * moved[:8, :, 2].T, axis=0))
    assert here * signs == pytest.approx(moved[:8, :, 2].T, abs=2e-3 * np.abs(here).max())


@pytest.mark.parametrize("kind", KINDS)
def test_its_mass_and_its_slopes_are_those_of_the_shape(kind: str) -> None:
    whole = body(kind)
    boxes = [np.ptp(np.array(box), axis=1) for _, box, _ in SHAPES[kind](*SIZES[kind]).parts]
    assert whole.mass == pytest.approx(DENSITY * sum(float(np.prod(sides)) for sides in boxes), rel=1e-9)
    _, shapes = whole.real_modes(3)
    at, step = np.array([0.71 * whole.end, 0.37 * whole.width]), 1e-6
    for quantity, away in (("slope_x", [step, 0.0]), ("slope_y", [0.0, step])):
        ahead, behind = (whole.rows((at + side * np.array(away))[None], "w") @ shapes for side in (1, -1))
        slope = (ahead - behind) / (2 * step)
        assert whole.rows(at[None], quantity) @ shapes == pytest.approx(slope, rel=1e-5)


def predictor_of(drawn: Trial, folder: Path) -> Predictor:
    """Return the modeller's model, seen from the test's points by as many modes as the band was chosen for."""
    setup = drawn.scene.setup
    spec = read_study(write_trial(drawn, folder)).spec()
    points = np.column_stack([setup.places, np.zeros(len(setup.points))])
    nothing, n = np.full(setup.modes, np.nan), len(points)
    test = Measured(
        frequency=np.array(setup.nominal_hz[: setup.modes]), frequency_sigma=np.zeros(setup.modes),
        damping=nothing, damping_sigma=nothing, points=points, nodes=tuple(range(1, n + 1)),
        seen=np.full(n, setup.sensor), hit=np.arange(n), constants=np.ones((n, setup.modes)),
        constants_sigma=np.ones((n, setup.modes)), absolute=True,
        directions=np.tile([0.0, 0.0, 1.0], (n, 1)),
    )  # fmt: skip
    return Predictor(spec, test)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_hidden_is_what_the_library_says_at_its_values(kind: str, tmp_path: Path) -> None:
    """The rig changes parts, bolts, feet and bodies, the library the matrices of the same mesh that it was handed."""
    drawn = trial(kind, "E")
    setup, predictor = drawn.scene.setup, predictor_of(drawn, tmp_path)
    nominal = predictor.predict(count=setup.modes).frequency
    assert nominal == pytest.approx(setup.nominal_hz[: setup.modes], rel=1e-5)
    tried = [name for name, hidden in effects_of(kind).items() if hidden.fits(setup)]
    assert {"local_stiffness", "local_mass", "lumped_mass", "clamp_translation"} <= set(tried)
    assert ("joint" in tried) == (kind == "bracket")
    for name in ("local_stiffness", "local_mass", "joint", "clamp_translation", "lumped_mass"):
        if name not in tried:
            continue
        hidden = effects_of(kind)[name]
        values = hidden.draw(np.random.default_rng(3), setup, 3.0 if name == "joint" else 1.0)
        changed = hidden.act(nominal_scene(setup), values).body
        omega, _ = changed.real_modes(setup.modes)
        more = {"clamp_translation": {"direction": "z"}, "lumped_mass": {"z": 0.0, "bulk": 0.0}}.get(name, {})
        found = predictor.predict(LIBRARY[name].state(predictor, {**values, **more}), count=setup.modes)
        shift = np.log(omega / (2 * np.pi) / nominal)
        assert np.abs(shift).max() > 2e-3, name
        # the mass of a foot's rows, which the matrices have lost, is estimated
        allowed = np.abs(shift).max() * (0.06 if name == "clamp_translation" else 2e-3)
        assert np.log(found.frequency / nominal) == pytest.approx(shift, abs=allowed), name
        assert len(hidden.places(setup, values)) == 1


@pytest.mark.long
@pytest.mark.parametrize(("kind", "effect"), [("ribbed", "clamp_translation"), ("bracket", "joint")])
def test_a_trial_is_drawn_written_and_diagnosed(kind: str, effect: str, tmp_path: Path) -> None:
    drawn = trial(kind, effect)
    assert (drawn.truth.kind, drawn.truth.accepted) == (kind, ((effect,),))
    for name in ("first", "again"):
        (tmp_path / name).mkdir()
        write_trial(drawn if name == "first" else replace(drawn), tmp_path / name)
    for path in (tmp_path / "first").iterdir():
        assert path.read_bytes() == (tmp_path / "again" / path.name).read_bytes()
    case = open_study(read_study(tmp_path / "first" / "study.toml")).case
    found = diagnose(case, library=[LIBRARY[name] for name in (effect, "E", "sensor_mass")])
    first, *more = found.sets
    assert first == (effect,), found.table()
    # whether a second foot gives way a little, too, may stay open: one in ten, as chance has it
    assert all(effect in one for one in more), found.table()
    stiffness = found.ranking[0].parameters[f"{effect}.stiffness"] if effect == "clamp_translation" else None
    if stiffness is not None:
        hidden = drawn.truth.parameters[f"{effect}.stiffness"]
        assert stiffness.low95 < hidden < stiffness.high95
    named = {value for key, value in found.ranking[0].forms[0].items() if key in ("joint", "support")}
    at = np.array(found.where.locations[0][:2])
    assert len(named) == 1
    assert np.linalg.norm(at - drawn.truth.places[0]) < 0.1 * drawn.scene.setup.length


@pytest.mark.long
def test_that_the_mesh_is_coarser_than_the_structure_is_no_gap(tmp_path: Path) -> None:
    """The rig's bracket has sixteen bricks where the modeller has twelve: 0.6 % in one mode, where noise is 0.1 %."""
    plan = DrawRanges(kinds=("ribbed", "bracket"), none=1.0, pairs=0.0, outside=0.0, baseline=0.0)
    drawn = draw_trial(98201, 3, plan=plan)
    assert drawn.truth.kind == "bracket"
    problem, _ = pose(open_study(write_trial(drawn, tmp_path)).case)
    assert p_value(evaluate(problem, Candidate(), np.zeros(0))) > 0.05
    beside = replace(
        problem.measured, frequency=problem.measured.frequency * np.where(np.arange(9) == 4, 1.05, 1.0)
    )
    assert p_value(evaluate(replace(problem, measured=beside), Candidate(), np.zeros(0))) < 1e-4


@pytest.mark.long
def test_the_mesh_leaves_the_stiffness_of_each_region_in_doubt(tmp_path: Path) -> None:
    """An angle of coarse bricks is too stiff where it bends most: in a region, not in each mode by itself."""
    write_trial(trial("bracket", "lumped_mass"), tmp_path)
    problem, _ = pose(open_study(tmp_path / "study.toml").case)
    meshed = [f"{region.name}.E" for region in problem.predictor.spec.regions]
    assert set(meshed) <= set(problem.names)
    rows = [problem.names.index(name) for name in meshed]
    assert problem.sigmas[rows] == pytest.approx(REGION_MESH_DOUBT)
    bounded = replace(problem.doubted, tolerances=replace(problem.tolerances, bounds={meshed[0]: (0.5, 2.0)}))
    assert bounded.sigmas[bounded.names.index(meshed[0])] == pytest.approx(
        np.log(4.0) / np.sqrt(12.0), rel=2e-3
    )
    corrected = replace(problem.doubted, corrected=True)
    assert not set(meshed) & set(corrected.names)
