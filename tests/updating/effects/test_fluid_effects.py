"""The effects of the fluid, through the library: inertia, losses, what is wet, what is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from test_fluid_stokes import sader
from updating_cases import BEAM, PLATE, POINTS, blank

from modalkit.simulator.bodies.plate.plate import Plate
from updating import Damping, Environment, Material, Predictor
from updating.effects import accepted_state
from updating.effects.structure.fluid import WATER, FluidAddedMass, FluidDamping, fluid_density
from updating.effects.structure.wetted import OPEN, mass_within, surroundings, unit_mass
from updating.fluid import FluidDomain, added_mass, beam_added_mass, quadrature_grid
from updating.models import PointMass
from updating.models.state import State

INF = float("inf")
STRIP = replace(
    BEAM,
    length=2.0,
    width=0.03,
    thickness=2e-5,
    theory="euler-bernoulli",
    material=Material(5e16, 7850.0, 0.3),
    damping=Damping(ratios=(0.0,)),
    elements=(20,),
)
"""So slender and thin that Sader's strips can stand for it, and so stiff that it vibrates at some hertz in water."""


def accept(name: str, **values: float):
    return lambda predictor: accepted_state(predictor, name, values)


@pytest.mark.parametrize("mode", [2, 3, 4])
def test_a_thin_cantilever_in_water_is_damped_as_by_sader(mode: int) -> None:
    """Q = (4 rho_s t / pi rho b + Re Gamma) / Im Gamma, J. Appl. Phys. 84 (1998) 64, Eq. 30; Re = 4e3 to 1.5e4."""
    frequency = (3.0, 6.0, 10.0)[mode - 2]
    measured = replace(blank(POINTS * STRIP.length / BEAM.length), frequency=np.full(2, frequency))
    predictor = Predictor(STRIP, measured)
    inertia = FluidAddedMass().state(predictor, {"fluid_density": WATER})
    found = predictor.predict(inertia.plus(FluidDamping().state(predictor, {"viscosity": 1e-3})), count=5)
    reynolds = WATER * 2 * np.pi * found.frequency[mode] * STRIP.width**2 / 4 / 1e-3
    heavy = 4 * STRIP.material.density * STRIP.thickness / (np.pi * WATER * STRIP.width)
    gamma = sader(reynolds)
    assert 4e3 < reynolds < 1.5e4
    assert found.damping[mode] == pytest.approx(gamma.imag / (2 * (heavy + gamma.real)), rel=0.05)


@pytest.mark.long
@pytest.mark.parametrize("spec", [BEAM, PLATE], ids=["beam", "plate"])
def test_losses_go_with_the_roots_of_viscosity_and_density(spec) -> None:
    points = POINTS if spec is BEAM else np.column_stack([POINTS, POINTS / 2])
    predictor = Predictor(replace(spec, damping=Damping(ratios=(0.0,))), blank(points))
    damping = FluidDamping()
    one, four = (predictor.predict(damping.state(predictor, {"viscosity": v}), count=4) for v in (1e-3, 4e-3))
    dry = predictor.predict(count=4)
    slow, slower = (found.frequency / dry.frequency for found in (one, four))
    assert four.damping / slower == pytest.approx(2 * one.damping / slow, rel=1e-9)
    assert slow**-2 - 1 == pytest.approx(
        2 * one.damping / slow, rel=1e-6
    )  # inertia and drag of the layer are alike
    assert (np.diff(one.damping) < 0).all()
    heavy = replace(predictor, environment=Environment(fluid_density=4 * WATER))
    more = heavy.predict(damping.state(heavy, {"viscosity": 1e-3}), count=4)
    slowed = more.frequency / heavy.predict(count=4).frequency
    assert more.damping / slowed == pytest.approx(2 * one.damping / slow, rel=0.02)
    assert damping.derived(heavy, {"viscosity": 2e-3})["density_viscosity"][0] == pytest.approx(8e-3 * WATER)


def test_the_density_is_that_of_an_accepted_fluid_before_that_of_the_environment() -> None:
    stated = Predictor(BEAM, blank(POINTS), Environment(fluid_density=1000.0))
    assert fluid_density(stated) == 1000.0
    both = replace(
        stated, additions=(accept("sensor_mass", mass=0.01), accept("fluid_added_mass", fluid_density=870.0))
    )
    assert fluid_density(both) == pytest.approx(870.0)
    assert fluid_density(Predictor(BEAM, blank(POINTS))) == WATER


@pytest.mark.parametrize("extension", [0.018, -0.01])
def test_what_an_accepted_length_puts_into_the_clamp_is_not_wet(extension: float) -> None:
    """Against a model of that length from the start, wetted over its free part."""
    spec = replace(BEAM, theory="euler-bernoulli", length=BEAM.length + extension)
    dry = Predictor(spec, blank(POINTS))
    free = min(BEAM.length, spec.length)
    x, _ = quadrature_grid(free, 0.1, 24)
    shapes = dry.reduced.rows(x[:, None] + spec.length - free)["w"].T
    wall = FluidDomain(walls=(0.0, INF, -INF, INF))
    added = beam_added_mass(shapes, x, length=free, width=spec.width, thickness=spec.thickness, domain=wall)
    expected = dry.predict(State(mass=(WATER * added,)), count=4).frequency
    nominal = replace(spec, length=BEAM.length)
    additions = (accept("length", extension=extension), accept("fluid_added_mass", fluid_density=WATER))
    around = Environment(walls=(max(-extension, 0.0), INF, -INF, INF))
    found = Predictor(nominal, blank(POINTS), around, additions).predict(count=4).frequency
    assert found == pytest.approx(expected, rel=2e-4)


@pytest.mark.long
@pytest.mark.parametrize(
    ("clamped", "walls"),
    [
        (("x0",), (0.0, INF, -INF, INF)),
        (("x1",), (-INF, 0.376, -INF, INF)),
        (("y0",), (-INF, INF, 0.0, INF)),
        (("y1",), (-INF, INF, -INF, 0.2)),
        (("x0", "x1", "y0", "y1"), (-INF, INF, -INF, INF)),
        ((), (-INF, INF, -INF, INF)),
    ],
)
def test_one_clamped_edge_lets_no_fluid_pass(clamped, walls) -> None:
    spec = replace(PLATE, clamped=clamped, elements=(6, 4))
    predictor = Predictor(spec, blank(np.array([[0.2, 0.1], [0.3, 0.15]])))
    x, y = quadrature_grid(0.376, 0.2, 24)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    shapes = predictor.reduced.rows(points)["w"].T.reshape(-1, 24, 24)
    expected = added_mass(
        shapes, x, y, length=0.376, width=0.2, thickness=spec.thickness, domain=FluidDomain(walls=walls)
    )
    np.testing.assert_allclose(unit_mass(predictor), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.long
def test_coupling_by_the_fluid_is_kept() -> None:
    """Modes that the fluid mixes come out lower and higher than each by itself; a sum of frequencies is no proof."""
    predictor = Predictor(PLATE, blank(np.array([[0.2, 0.1], [0.3, 0.15]])))
    squared, vectors = predictor.reduced.eigen(State())
    added = WATER * vectors.T @ unit_mass(predictor)[: len(squared), : len(squared)] @ vectors
    wet = predictor.predict(FluidAddedMass().state(predictor, {"fluid_density": WATER}), count=8).frequency
    coupled = np.sqrt(eigh(np.diag(squared), np.eye(len(squared)) + added, eigvals_only=True))[:8] / 2 / np.pi
    assert wet == pytest.approx(coupled, rel=1e-9)
    alone = np.sqrt(np.sort(squared / (1 + np.diag(added))))[:8] / 2 / np.pi
    assert np.abs(wet / alone - 1).max() > 0.02


def test_a_mass_told_beforehand_is_no_fluid() -> None:
    spec = replace(BEAM, masses=(PointMass((0.376,), 0.01),))
    assert (
        fluid_density(Predictor(spec, blank(POINTS), additions=(accept("sensor_mass", mass=0.02),))) == WATER
    )


def test_the_distances_that_the_study_does_not_state_are_searched_for() -> None:
    fluid = FluidAddedMass()
    for around, names in (
        (Environment(), ["fluid_density", "free_surface", "bottom", "wall"]),
        (Environment(998.0, bottom=0.1), ["fluid_density", "free_surface", "wall"]),
        (Environment(998.0, 0.2, 0.1), ["fluid_density", "wall"]),
        (Environment(998.0, 0.2, 0.1, (0.0, INF, -INF, INF)), ["fluid_density"]),
    ):
        predictor = Predictor(BEAM, blank(POINTS), around)
        assert [p.name for p in fluid.parameters(predictor)] == names
        assert all(len(start) == len(names) for start in fluid.starts(predictor))


@pytest.mark.long
@pytest.mark.parametrize("around", [Environment(), Environment(bottom=0.05), Environment(free_surface=0.01)])
@pytest.mark.parametrize("spec", [BEAM, PLATE], ids=["beam", "plate"])
def test_what_is_read_from_the_table_is_what_is_solved(spec, around: Environment) -> None:
    points = POINTS if spec is BEAM else np.column_stack([POINTS, POINTS / 2])
    predictor, fluid = Predictor(spec, blank(points), around), FluidAddedMass()
    rng, count = np.random.default_rng(5), len(fluid.parameters(predictor))
    dry = predictor.predict(count=6).frequency
    for quantiles in (np.zeros(count), np.ones(count), *rng.random((6, count))):
        values = fluid.values(predictor, quantiles.tolist())
        there = surroundings(predictor, values)
        walled, bare = (mass_within(predictor, one) for one in (there, replace(there, walls=OPEN)))
        solved = values["wall"] * walled + (1 - values["wall"]) * bare
        found = predictor.predict(fluid.state(predictor, values), count=6).frequency
        exact = predictor.predict(State(mass=(values["fluid_density"] * solved,)), count=6).frequency
        assert np.log(found / dry) == pytest.approx(np.log(exact / dry), rel=3e-3)


@pytest.mark.long
@pytest.mark.parametrize("tank", [(INF, INF), (0.2, INF), (INF, 0.3), (0.3, 0.4), (1.0, 0.2)])
@pytest.mark.parametrize("clamped", [("x0",), ("x0", "x1")])
def test_frequencies_and_levels_in_a_tank_are_those_of_the_rig(tank, clamped) -> None:
    """Doublet panels and their images on quintic elements: the shifts to 4 %, the fall of the level to 8 % of it."""
    spec = replace(PLATE, clamped=clamped, theory="mindlin", elements=(14, 10), regions=(), masses=())
    points = np.array([[0.35, 0.03], [0.2, 0.1], [0.1, 0.15]])
    predictor = Predictor(spec, blank(points))
    far = dict(zip(("free_surface", "bottom"), np.array(tank) * spec.width, strict=True))
    state = FluidAddedMass().state(predictor, {"fluid_density": WATER, **far})
    ours = [predictor.predict(s, count=4) for s in (State(), state)]
    size = (0.0, spec.length, spec.width, spec.thickness)
    dry = Plate(*size, spec.material.E, spec.material.density, clamped=clamped)
    theirs = [body.real_modes(4) for body in (dry, replace(dry, fluid_density=WATER, **far))]
    shift = np.log(theirs[1][0] / theirs[0][0])
    assert np.log(ours[1].frequency / ours[0].frequency) == pytest.approx(shift, rel=0.04)
    squares = [np.sum((dry.rows(points, "w") @ shapes) ** 2, axis=0) for _, shapes in theirs]
    seen = [np.sum((predictor.nominal_rows["w"][:, : len(p.vectors)] @ p.vectors) ** 2, axis=0) for p in ours]
    level = np.log(squares[1] / squares[0])
    assert (level < -0.5).all()
    assert np.log(seen[1] / seen[0]) == pytest.approx(level, rel=0.08)


@pytest.mark.long
def test_a_fluid_in_the_model_says_its_density_wherever_its_surface_is() -> None:
    near = Predictor(
        BEAM, blank(POINTS), additions=(accept("fluid_added_mass", fluid_density=870.0, free_surface=0.01),)
    )
    deep = replace(near, additions=(accept("fluid_added_mass", fluid_density=870.0),))
    assert fluid_density(near) == fluid_density(deep) == 870.0
    assert (near.predict(count=3).frequency > 1.005 * deep.predict(count=3).frequency).all()
    lost = [FluidDamping().state(p, {"viscosity": 1e-3}).losses[0].matrix for p in (near, deep)]
    assert np.trace(lost[0]) < 0.99 * np.trace(lost[1])


@pytest.mark.long
@pytest.mark.parametrize("spec", [BEAM, PLATE], ids=["beam", "plate"])
def test_what_the_fluid_adds_in_the_first_mode_is_what_its_frequency_tells(spec) -> None:
    """Rayleigh's quotient: (f dry / f wet)^2 - 1 but for the change of the shape."""
    points = POINTS if spec is BEAM else np.column_stack([POINTS, POINTS / 2])
    predictor, fluid = Predictor(spec, blank(points)), FluidAddedMass()
    values = {"fluid_density": 900.0, "free_surface": 0.02}
    dry, wet = (predictor.predict(s, count=1).frequency[0] for s in (State(), fluid.state(predictor, values)))
    ratio, unit = fluid.derived(predictor, values)["added_mass_ratio"]
    assert unit == "-"
    assert ratio == pytest.approx((dry / wet) ** 2 - 1, rel=0.02)


@pytest.mark.parametrize(
    ("around", "doubted"),
    [
        (Environment(), True),
        (Environment(free_surface=0.2, bottom=0.1), True),
        (Environment(998.0), False),
        (Environment(walls=(0.0, INF, -INF, INF)), False),
    ],
)
def test_the_level_of_the_added_mass_is_in_doubt_where_its_surroundings_are_not_stated(
    around: Environment, doubted: bool
) -> None:
    density = FluidAddedMass().parameters(Predictor(BEAM, blank(POINTS), around))[0]
    assert (density.scale_doubt > 0) is doubted


def test_a_clamp_is_a_wall_in_part() -> None:
    """Half of it adds the mean of both; a study that states the walls leaves nothing open."""
    predictor, fluid = Predictor(BEAM, blank(POINTS)), FluidAddedMass()
    added = [fluid.state(predictor, {"fluid_density": WATER, "wall": w}).mass[0] for w in (0.0, 0.5, 1.0)]
    np.testing.assert_allclose(added[1], (added[0] + added[2]) / 2)
    np.testing.assert_array_equal(fluid.state(predictor, {"fluid_density": WATER}).mass[0], added[2])
    for walls, rank in (((-INF, INF, -INF, INF), 0), ((0.0, INF, -INF, INF), 2)):
        stated = replace(predictor, environment=Environment(walls=walls))
        found = fluid.state(stated, {"fluid_density": WATER}).mass[0]
        np.testing.assert_allclose(found, added[rank], rtol=1e-9, atol=1e-12)
    heavier = [predictor.predict(State(mass=(WATER * one,)), count=3).frequency for one in added]
    assert (np.diff(heavier, axis=0) < 0).all()  # a wall lets no fluid pass round the edge
