"""Effects beside closed forms, transcendental equations, transfer matrices and complex eigen-solutions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import CHANGES, CORNERS, LOOK, THIN, form, imported
from imported_cases import DEPTH as THICKNESS
from imported_cases import LENGTH, WIDTH, beam_matrices, clamp
from scipy import linalg, optimize, special
from updating_cases import BEAM, PLATE, POINTS, STEEL, ExactBeam, blank

from acquisition.errors import StudyError
from modalkit.simulator.bodies.plate.plate import Plate
from updating import LIBRARY, Material, Predictor, Spec
from updating.effects.box import SOFT, mirror_images, shares
from updating.effects.structure.axial_load import buckling_load
from updating.effects.structure.sensors import sensor_places
from updating.models import FieldStructure, PointMass, Region, build_structure
from updating.models.fields import Sparse
from updating.models.state import State
from updating.problem.candidate import Candidate

EI = 210e9 * BEAM.width * BEAM.thickness**3 / 12
LINE = 7850.0 * BEAM.width * BEAM.thickness
SIZE = (BEAM.length, BEAM.width, BEAM.thickness)


def predicted(name: str, place: str, count: int = 5, **values: float) -> np.ndarray:
    predictor = LOOK[place]
    return predictor.predict(LIBRARY[name].state(predictor, values), count=count).frequency


def hertz(roots: np.ndarray) -> np.ndarray:
    """Frequencies of an Euler-Bernoulli beam from the roots lambda = beta L."""
    return roots**2 / (2 * np.pi * BEAM.length**2) * np.sqrt(EI / LINE)


def roots_of(function: object, count: int) -> np.ndarray:
    grid = np.linspace(0.2, (count + 1) * np.pi, 3000)
    values = np.array([function(u) for u in grid])  # type: ignore[operator]
    found = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))[:count]
    return np.array([optimize.brentq(function, grid[i], grid[i + 1], xtol=1e-13) for i in found])


@pytest.mark.parametrize("share", [0.01, 0.1, 0.45])
def test_a_body_at_the_tip(share: float) -> None:
    """Rayleigh's equation of a cantilever with a mass and its rotary inertia at the tip (Laura et al. 1974)."""
    mass = share * LINE * BEAM.length
    turning = mass * (mass / 7850.0) ** (2 / 3) / 6 / (LINE * BEAM.length**3)

    def rayleigh(u: float) -> float:
        s, c, sh, ch = np.sin(u), np.cos(u), np.sinh(u), np.cosh(u)
        whole = 1 + c * ch + share * u * (c * sh - s * ch)
        return float(
            (whole - turning * u**3 * (ch * s + sh * c) + share * turning * u**4 * (1 - c * ch)) / ch
        )

    found = predicted("lumped_mass", "beam", mass=mass, x=BEAM.length)
    assert found == pytest.approx(hertz(roots_of(rayleigh, 5)), rel=5e-5)


@pytest.mark.parametrize("slope", [-1.2, -0.1, 0.1, 0.8])
def test_a_wedge_clamped_at_one_end(slope: float) -> None:
    """Kirchhoff's wedge (1879): w = C(z) / z, C Bessel functions of order 1 of z = 2 p sqrt(xi), xi the thickness.

    EI is EI1 xi^3 and the mass of a length m1 xi, p^4 = m1 omega^2 / EI1; each derivative by xi raises the order by one
    and divides by z once more. At the free end the second and the third are nothing.
    """
    ends = 1 - slope / 2, 1 + slope / 2

    def rows(p: float, xi: float, order: int) -> list[float]:
        z = 2 * p * np.sqrt(xi)
        n, grown = 1 + order, np.exp(z - 2 * p)
        kinds = special.jv(n, z), special.yv(n, z), special.ive(n, z) * grown, special.kve(n, z) / grown
        return [
            sign**order * (p / z) ** n * value for value, sign in zip(kinds, (-1, -1, 1, -1), strict=True)
        ]

    def free_wedge(u: float) -> float:
        p = u / abs(slope)  # lengths in units in which the thickness changes by one
        matrix = np.array(
            [rows(p, ends[0], 0), rows(p, ends[0], 1), rows(p, ends[1], 2), rows(p, ends[1], 3)]
        )
        return float(np.linalg.det(matrix / np.linalg.norm(matrix, axis=0)))

    found = predicted("taper", "beam", slope=slope)
    assert found == pytest.approx(hertz(roots_of(free_wedge, 5)), rel=5e-5)


@pytest.mark.parametrize("place", ["beam", "timoshenko"])
@pytest.mark.parametrize("ratio", [8.0, 300.0, 3e4])
def test_a_clamp_that_shifts_but_does_not_turn(place: str, ratio: float) -> None:
    spring, shear = ratio * EI / BEAM.length**3, place == "timoshenko"
    exact = ExactBeam(*SIZE, translation=spring, shear=shear, rotary=shear).frequencies(5)
    assert predicted("clamp_translation", place, stiffness=spring) == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("place", ["beam", "timoshenko"])
@pytest.mark.parametrize(("turn", "shift"), [(20.0, 500.0), (300.0, 1e4)])
def test_a_clamp_that_shifts_and_turns_as_a_pair(place: str, turn: float, shift: float) -> None:
    predictor, shear = LOOK[place], place == "timoshenko"
    values = {"clamp_rotation": turn * EI / BEAM.length, "clamp_translation": shift * EI / BEAM.length**3}
    state = State()
    for name, stiffness in values.items():
        state = state.plus(LIBRARY[name].state(predictor, {"stiffness": stiffness}))
    exact = ExactBeam(
        *SIZE,
        translation=values["clamp_translation"],
        rotation=values["clamp_rotation"],
        shear=shear,
        rotary=shear,
    )
    found = predictor.predict(state, count=5).frequency
    assert found == pytest.approx(exact.frequencies(5), rel=1e-4)


def test_a_shifting_clamp_holds_its_slope_in_frfs_too() -> None:
    """What turns is cut off from all else: FRFs far below it show nothing of it."""
    predictor = LOOK["beam"]
    state = LIBRARY["clamp_translation"].state(predictor, {"stiffness": 100 * EI / BEAM.length**3})
    still = 1j * 2 * np.pi * np.array([1e-3])
    given = predictor.receptance(still, state)[-1, 0].real
    assert given == pytest.approx(BEAM.length**3 / (3 * EI) + BEAM.length**3 / (100 * EI), rel=1e-4)


def axially_loaded(force: float, count: int) -> np.ndarray:
    """Cantilever under a dead load along it: (w, w', M, S) carried from the clamp to the tip."""

    def tip(hertz: float) -> float:
        omega = 2 * np.pi * hertz
        rate = np.array([[0, 1, 0, 0], [0, 0, 1 / EI, 0], [0, force, 0, 1], [LINE * omega**2, 0, 0, 0]])
        carried = linalg.expm(rate * BEAM.length)[2:, 2:]
        return float(np.linalg.det(carried))

    grid = np.linspace(2.0, 2200.0, 6000)
    values = np.array([tip(f) for f in grid])
    found = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))[:count]
    return np.array([optimize.brentq(tip, grid[i], grid[i + 1], xtol=1e-10) for i in found])


@pytest.mark.parametrize("share", [-0.9, -0.7, 0.5, 4.0])
def test_a_beam_under_tension_and_thrust(share: float) -> None:
    force = share * np.pi**2 * EI / (4 * BEAM.length**2)
    assert predicted("axial_load", "beam", force=force) == pytest.approx(axially_loaded(force, 5), rel=2e-5)


@pytest.mark.parametrize(("clamped", "factor"), [(("x0",), 0.25), (("x0", "x1"), 4.0)])
def test_euler_buckles(clamped: tuple[str, ...], factor: float) -> None:
    predictor = Predictor(replace(THIN, clamped=clamped), blank(POINTS[:3]))
    critical = buckling_load(predictor)
    assert critical == pytest.approx(factor * np.pi**2 * EI / BEAM.length**2, rel=1e-4)
    nearly = LIBRARY["axial_load"].state(predictor, {"force": -0.9999 * critical})
    first = predictor.predict(count=1).frequency[0]
    assert predictor.predict(nearly, count=1).frequency[0] < 0.03 * first


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.8])
def test_huber_is_a_change_of_scale_across(ratio: float) -> None:
    """With D_1 and D_xy from the geometric mean the plate is an isotropic one of width W ratio^(-1/4)."""
    narrower = replace(PLATE, width=PLATE.width * ratio**-0.25, regions=())
    values = build_structure(narrower).eigen(5)[0]
    found = predicted("orthotropy", "plate", ratio=ratio)
    assert found == pytest.approx(np.sqrt(values) / (2 * np.pi), rel=5e-4)


@pytest.mark.long
@pytest.mark.parametrize(
    ("ratio", "shear_ratio", "coupling"), [(0.5, 0.3, 1.0), (1.8, 2.0, 0.4), (4.0, 0.15, 2.0)]
)
def test_a_hinged_plate_of_four_constants(ratio: float, shear_ratio: float, coupling: float) -> None:
    """Lekhnitskii, Anisotropic Plates, 1968: the shapes are sines, the frequencies a sum of D_1, D_2 and D_3."""
    around = replace(PLATE, clamped=("x0", "x1", "y0", "y1"), elements=(14, 10), regions=(), masses=())
    inside = np.array([(x, y) for x in np.linspace(0.05, 0.35, 4) for y in (0.02, 0.1, 0.17)])
    predictor = Predictor(around, blank(inside))
    hinges = LIBRARY["clamp_rotation"].state(predictor, {"stiffness": 1e-3})
    values = {"ratio": ratio, "shear_ratio": shear_ratio, "coupling": coupling}
    found = predictor.predict(LIBRARY["orthotropy"].state(predictor, values).plus(hinges), count=8).frequency
    nu = STEEL.poisson
    along = STEEL.E * PLATE.thickness**3 / 12 / (1 - nu**2)
    mixed = np.sqrt(ratio) * (nu * coupling + (1 - nu) * shear_ratio)
    m, n = np.meshgrid(np.arange(1, 12) / PLATE.length, np.arange(1, 8) / PLATE.width)
    energy = along * (m**4 + 2 * mixed * (m * n) ** 2 + ratio * n**4)
    exact = np.pi / 2 * np.sort(np.sqrt(energy / STEEL.density / PLATE.thickness), axis=None)[:8]
    assert found == pytest.approx(exact, rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("clamped", [("x0",), (), ("x0", "x1")])
def test_a_sheet_that_shears_in_its_plane_as_it_likes_beside_the_rig(clamped: tuple[str, ...]) -> None:
    """Quintic elements that shear across the thickness too: twist and coupling each by itself, not their sum."""
    spec = replace(PLATE, theory="mindlin", clamped=clamped, elements=(16, 10), regions=(), masses=())
    predictor = Predictor(spec, blank(CORNERS))
    values = {"ratio": 0.7, "shear_ratio": 0.75}
    found = predictor.predict(LIBRARY["orthotropy"].state(predictor, values), count=8).frequency
    body = Plate(
        0.0, spec.length, spec.width, spec.thickness, STEEL.E, STEEL.density, clamped=clamped, **values
    )
    omega, _ = body.real_modes(8 + body.rigid_modes)
    assert found == pytest.approx(omega[body.rigid_modes :] / (2 * np.pi), rel=1e-3)


@pytest.mark.parametrize("place", ["beam", "plate", "matrices"])
def test_uniform_damping_has_a_closed_form(place: str) -> None:
    predictor, alpha, beta, eta = LOOK[place], 3.0, 2e-6, 0.004
    state = LIBRARY["uniform_damping"].state(predictor, {"alpha": alpha, "beta": beta, "loss_factor": eta})
    plain, found = predictor.predict(count=4), predictor.predict(state, count=4)
    omega = 2 * np.pi * plain.frequency
    added = alpha / (2 * omega) + beta * omega / 2 + eta / 2
    assert found.damping - plain.damping == pytest.approx(added, rel=1e-6)
    window = LIBRARY["exponential_window"].state(predictor, {"decay": 4.0})
    alone = LIBRARY["uniform_damping"].state(predictor, {"alpha": 8.0, "beta": 0.0, "loss_factor": 0.0})
    both = [predictor.predict(s, count=4).damping for s in (window, alone)]
    # the same decay; a window leaves the frequency of ringing, a damper that without damping
    ringing = omega * np.sqrt(1 - plain.damping**2)
    assert both[0] == pytest.approx(both[1] * omega / np.hypot(both[1] * omega, ringing), rel=1e-9)


@pytest.mark.parametrize("place", ["beam", "plate", "matrices"])
def test_less_damping_than_expected_leaves_the_same_share_of_every_mode(place: str) -> None:
    """Of Rayleigh damping alpha M + beta K a share less of both is that share less of every ratio."""
    predictor, effect = LOOK[place], LIBRARY["uniform_damping"]
    less = Candidate((effect,), chosen=(effect.variants(predictor)[-1],))
    plain = predictor.predict(count=4).damping
    for left in (0.0, 0.3, 0.9):
        found = predictor.predict(less.state(predictor, [left]), count=4).damping
        assert found == pytest.approx(left * plain, rel=1e-6, abs=1e-9)
    ((_, values),) = less.split(predictor, [0.3])
    stated = predictor.spec.damping
    assert values["alpha"] == pytest.approx(-0.7 * (stated.alpha or 0.0), rel=1e-6)
    assert values["beta"] == pytest.approx(-0.7 * (stated.beta or 0.0), rel=1e-6)
    assert "less" in effect.sentence(values)
    named = {"alpha", "beta"} - {name.split(".")[1] for name, _ in less.parameters(predictor)}
    assert set(effect.derived(predictor, values)) == {n for n in named if values[n]}
    with pytest.raises(StudyError, match="takes more from mode"):
        effect.state(predictor, {"alpha": 0.0, "beta": 0.0, "loss_factor": -2.5 * float(plain.max())})


def complex_beam(
    first: int, last: int, values: dict[str, float], *, clamped: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and damping ratios of (K + i eta K_patch) by 100 textbook elements, some of them covered."""
    (k, m), (kp, mp) = beam_matrices(100), beam_matrices(100, first, last)
    if clamped:
        k, m, kp, mp = (clamp(a) for a in (k, m, kp, mp))
    kp = (1 + values["stiffness"]) * kp, values["stiffness"] * kp
    stiff = k.toarray() + kp[1].toarray() + 1j * values["loss_factor"] * kp[0].toarray()
    squares = linalg.eig(stiff, m.toarray() + values["mass"] * mp.toarray(), right=False)
    squares = squares[np.argsort(squares.real)][0 if clamped else 2 :][:6]
    return np.sqrt(squares.real) / (2 * np.pi), squares.imag / squares.real / 2


@pytest.mark.parametrize("clamped", [True, False])
@pytest.mark.parametrize("layer", [(0.0, 0.0), (0.12, 0.05)])
def test_a_patch_beside_the_complex_eigen_solution(*, clamped: bool, layer: tuple[float, float]) -> None:
    """Tape on segments 6 to 8 of ten, as in paper B, and a longer one."""
    edges = ("x0",) if clamped else ()
    spec = Spec(
        "beam",
        length=LENGTH,
        width=WIDTH,
        thickness=THICKNESS,
        elements=(40,),
        clamped=edges,
        theory="euler-bernoulli",
        material=Material(210e9, 7850.0),
    )
    spec = replace(spec, damping=replace(BEAM.damping, alpha=0.0, beta=0.0))
    predictor = Predictor(spec, blank(np.linspace(0.05, 0.5, 6)))
    for first, last in ((50, 80), (20, 55)):
        size = {"x": (first + last) / 200 * LENGTH, "extent": (last - first) / 100 * LENGTH}
        values = {**size, "loss_factor": 0.03, "mass": layer[0], "stiffness": layer[1]}
        found = predictor.predict(LIBRARY["damping_patch"].state(predictor, values), count=6)
        frequency, damping = complex_beam(first, last, values, clamped=clamped)
        assert found.frequency == pytest.approx(frequency, rel=5e-4)
        assert found.damping == pytest.approx(damping, rel=0.015)


@pytest.mark.parametrize("law", [{"alpha": 40.0}, {"beta": 1e-5}])
def test_a_viscous_patch_beside_the_complex_eigen_solution(law: dict[str, float]) -> None:
    """C = alpha M + beta K of the covered part with its layer, by 100 textbook elements."""
    spec = Spec(
        "beam",
        length=LENGTH,
        width=WIDTH,
        thickness=THICKNESS,
        elements=(40,),
        clamped=("x0",),
        theory="euler-bernoulli",
        material=Material(210e9, 7850.0),
    )
    spec = replace(spec, damping=replace(BEAM.damping, alpha=0.0, beta=0.0))
    predictor = Predictor(spec, blank(np.linspace(0.05, 0.5, 6)))
    (k, m), (kp, mp) = (
        [clamp(a).toarray() for a in pair] for pair in (beam_matrices(100), beam_matrices(100, 20, 55))
    )
    k, m = k + 0.05 * kp, m + 0.12 * mp
    c = law.get("alpha", 0.0) * 1.12 * mp + law.get("beta", 0.0) * 1.05 * kp
    squares, shapes = linalg.eigh(k, m)
    shapes = shapes[:, :30]  # modes of some kHz more change nothing below
    below = np.hstack([-np.diag(squares[:30]), -shapes.T @ c @ shapes])
    poles = linalg.eigvals(np.vstack([np.hstack([np.zeros((30, 30)), np.eye(30)]), below]))
    poles = sorted(poles[poles.imag > 0], key=lambda p: p.imag)[:5]
    values = {
        "x": 0.375 * LENGTH,
        "extent": 0.35 * LENGTH,
        "loss_factor": 0.0,
        "mass": 0.12,
        "stiffness": 0.05,
    }
    found = predictor.predict(LIBRARY["damping_patch"].state(predictor, values | law), count=5)
    assert found.frequency == pytest.approx(np.abs(poles) / (2 * np.pi), rel=5e-4)
    assert found.damping == pytest.approx(-np.real(poles) / np.abs(poles), rel=0.015)


def test_two_halves_of_a_layer_are_the_whole() -> None:
    predictor, effect = LOOK["plate"], LIBRARY["damping_patch"]
    width = predictor.spec.width
    at = {"x": 0.2, "extent": 0.1, "loss_factor": 0.05, "mass": 0.0, "stiffness": 0.0}

    def damping(*layers: tuple[float, float]) -> np.ndarray:
        state = State()
        for middle, across in layers:
            state = state.plus(
                effect.state(predictor, {**at, "y": middle * width, "extent_y": across * width})
            )
        return predictor.predict(state, count=6).damping

    halves = damping((0.25, 0.5), (0.75, 0.5))
    assert halves == pytest.approx(damping((0.5, 1.0)), rel=0.02)
    assert (damping((0.5, 0.5)) < halves).all()


@pytest.mark.parametrize(
    ("extent", "loss"), [(0.03, 0.3), (0.03, 0.7), (0.03, -1.5), (0.1, 0.6), (0.1, -0.5), (0.1, -9.0)]
)
def test_a_box_has_the_frequencies_of_one_with_sharp_edges(extent: float, loss: float) -> None:
    """By transfer matrices: the sketch at its best extent and loss, whose edges are soft, within its fidelity."""
    effect, predictor = LIBRARY["local_stiffness"], LOOK["beam"]
    ends = 0.15 - extent / 2, 0.15 + extent / 2
    exact = ExactBeam(*SIZE, soft=(*ends, loss), shear=False, rotary=False).frequencies(5)
    plain = ExactBeam(*SIZE, shear=False, rotary=False).frequencies(5)
    start = effect.quantiles(predictor, {"x": 0.15, "extent": extent, "loss": loss})

    def off(turned: np.ndarray) -> np.ndarray:
        values = effect.values(predictor, [start[0], *turned])
        return (predicted("local_stiffness", "beam", **values) - exact) / np.abs(exact - plain).max()

    half = (0.5, 1.0) if loss > 0 else (0.0, 0.5)
    found = optimize.least_squares(
        off, np.clip(start[1:], 0.02, 0.98), bounds=([0.0, half[0]], [1.0, half[1]]), diff_step=1e-3
    )
    assert np.abs(found.fun).max() < effect.fidelity
    compliance = effect.derived(predictor, effect.values(predictor, [start[0], *found.x]))["compliance"][0]
    assert compliance == pytest.approx(extent * loss / (1 - loss), rel=0.25)


SPOTS = (
    (0.13, 0.5, 0.13, 0.244, 0.7),
    (0.53, 0.15, 0.10, 0.19, 0.8),
    (0.27, 0.9, 0.08, 0.15, 0.85),
    (0.4, 0.5, 0.03, 0.06, 0.95),
    (0.0, 0.4, 0.1, 0.19, 0.85),
    (0.66, 1.0, 0.15, 0.28, 0.8),
    (0.5, 0.5, 0.4, 0.4, 0.6),
    (0.66, 0.3, 0.03, 0.4, 0.95),
    (0.2, 0.8, 0.4, 0.1, -1.0),
    (0.5, 0.5, 0.33, 0.33, -4.0),
    (0.3, 0.4, 0.1, 0.2, -9.0),
)
"""Places, extents (in lengths and widths) and losses; none has more compliance than the prior admits."""


def spotted(predictor: Predictor, spot: tuple[float, ...]) -> dict[str, float]:
    length, width = predictor.spec.length, predictor.spec.width
    sizes = {"extent": spot[2] * length, "extent_y": spot[3] * width}
    return {"x": spot[0] * length, "y": spot[1] * width, **sizes, "loss": spot[4]}


def off_by(predictor: Predictor, spot: dict[str, float], beside: dict[str, dict[str, float]]) -> float:
    """Worst error of twelve modes on the reduced basis beside the full matrices, in shares of the spot's shift."""
    structure = predictor.reduced.structure
    assert isinstance(structure, FieldStructure)
    k, m, released, state = structure.matrix("stiffness"), structure.matrix("mass"), frozenset[str](), State()
    for name, values in beside.items():
        change = CHANGES[name](structure, values)
        k, m = Sparse(k + change.get("stiffness", 0 * k)), Sparse(m + change.get("mass", 0 * m))
        released |= change.get("released", frozenset())
        state = state.plus(LIBRARY[name].state(predictor, values))
    first = structure.rigid_modes
    soft = CHANGES["local_stiffness"](structure, spot)["stiffness"]
    full = [
        np.sqrt(structure.eigen(first + 12, stiffness=Sparse(s), mass=m, released=released)[0][first:])
        for s in (k, k + soft)
    ]
    states = (state, state.plus(LIBRARY["local_stiffness"].state(predictor, spot)))
    found = [predictor.predict(s, count=12).frequency * 2 * np.pi for s in states]
    shift = np.abs(np.log(full[1] / full[0]))
    return float(np.abs(np.log(found[1] / found[0]) - np.log(full[1] / full[0])).max() / shift.max())


@pytest.fixture(scope="module")
def cantilever() -> Predictor:
    return Predictor(replace(PLATE, elements=(20, 10)), blank(CORNERS))


@pytest.mark.parametrize("spot", SPOTS)
def test_curvature_gathers_in_a_soft_spot_of_a_plate(cantilever: Predictor, spot: tuple[float, ...]) -> None:
    assert off_by(cantilever, spotted(cantilever, spot), {}) < 0.02


@pytest.mark.long
def test_a_soft_spot_of_a_free_plate() -> None:
    free = Predictor(replace(PLATE, elements=(20, 10), clamped=()), blank(CORNERS))
    assert max(off_by(free, spotted(free, spot), {}) for spot in SPOTS) < 0.03


@pytest.mark.long
@pytest.mark.parametrize(
    ("beside", "most"),
    [
        ({"sensor_mass": {"mass": 0.02}}, 0.02),
        ({"clamp_rotation": {"stiffness": 200.0}}, 0.03),
        ({"clamp_translation": {"stiffness": 1e6}}, 0.05),
        ({"clamp_rotation": {"stiffness": 200.0}, "clamp_translation": {"stiffness": 1e6}}, 0.05),
    ],
    ids=["sensor", "turning", "shifting", "both"],
)
def test_a_soft_spot_beside_another_effect(
    cantilever: Predictor, beside: dict[str, dict[str, float]], most: float
) -> None:
    """Within the fidelity too where a clamp is released, unless the spot lies on the clamp itself."""
    assert most <= LIBRARY["local_stiffness"].fidelity
    away = [spot for spot in SPOTS if spot[0] > 0]
    assert max(off_by(cantilever, spotted(cantilever, spot), beside) for spot in away) < most


def test_a_soft_spot_follows_the_modulus_of_the_plate_it_is_in(cantilever: Predictor) -> None:
    """An accepted factor of E stiffens the place and its surroundings alike: all frequencies scale by its root."""
    spot = spotted(cantilever, SPOTS[2])
    stiffer = cantilever.for_test(cantilever.measured, (lambda _: State(factors={"E": 1.3}),))
    both = [p.predict(LIBRARY["local_stiffness"].state(p, spot), count=8) for p in (cantilever, stiffer)]
    assert both[1].frequency == pytest.approx(np.sqrt(1.3) * both[0].frequency, rel=1e-9)


def test_a_plate_that_is_its_own_basis_lacks_nothing() -> None:
    coarse = Predictor(replace(PLATE, elements=(4, 3)), blank(CORNERS))
    spot = spotted(coarse, SPOTS[0])
    (found,) = LIBRARY["local_stiffness"].state(coarse, spot).stiffness
    plain = -coarse.reduced.weighted("stiffness", spot["loss"] * shares(coarse, spot, soft=SOFT))
    n = coarse.reduced.ranks[frozenset()]
    assert n == coarse.reduced.structure.unknowns
    assert found[:n, :n] == pytest.approx(plain[:n, :n], abs=1e-9 * np.abs(plain[:n, :n]).max())


def test_regions_of_imported_matrices_soften_and_damp() -> None:
    predictor = LOOK["matrices"]
    for name in ("local_stiffness", "damping_patch"):
        effect = LIBRARY[name]
        assert {v.values["region"] for v in effect.variants(predictor)} == {f"part{i}" for i in (1, 2, 3, 4)}
    k, m = (clamp(a) for a in beam_matrices(20))
    for loss in (0.4, -4.0):
        state = LIBRARY["local_stiffness"].state(predictor, {"region": "part2", "loss": loss})
        lost = loss * clamp(beam_matrices(20, 5, 10)[0])
        exact = np.sqrt(linalg.eigh((k - lost).toarray(), m.toarray(), eigvals_only=True)[:4]) / (2 * np.pi)
        assert predictor.predict(state, count=4).frequency == pytest.approx(exact, rel=1e-6)
    layer = {"region": 2, "loss_factor": 0.02, "mass": 0.1, "stiffness": 0.0}
    covered = predictor.predict(LIBRARY["damping_patch"].state(predictor, layer), count=4)
    assert (covered.frequency < predictor.predict(count=4).frequency).all()


def test_matrices_without_parts_say_why_nothing_softens() -> None:
    spec = replace(imported().spec, regions=())
    whole = replace(spec.imported, stiffness_parts=(), mass_parts=())  # type: ignore[type-var]
    predictor = Predictor(
        replace(spec, imported=whole, regions=(Region("all", (0, 1), (0, 1)),)), LOOK["matrices"].measured
    )
    for name in ("local_stiffness", "damping_patch"):
        assert "stiffness_parts" in str(LIBRARY[name].why_not(predictor))


def test_an_accelerometer_that_roves_loads_the_mean_of_its_places() -> None:
    """To first order: the mean frequency of a model loaded at one place after the other, to 2 % of the shift."""
    predictor = LOOK["beam"]
    test = predictor.measured
    roving = predictor.for_test(replace(test, seen=test.hit, hit=test.seen))
    assert LIBRARY["sensor_mass"].why_not(roving) is None
    mass = 0.001 * LINE * BEAM.length
    found = roving.predict(LIBRARY["sensor_mass"].state(roving, {"mass": mass}), count=5).frequency
    one_by_one = [
        predicted("lumped_mass", "beam", mass=mass, x=float(x)) for x in sensor_places(roving)[:, 0]
    ]
    plain = predictor.predict(count=5).frequency
    assert found / plain - 1 == pytest.approx(np.mean(one_by_one, axis=0) / plain - 1, rel=0.02)


def test_a_mirror_image_is_another_place() -> None:
    free = replace(THIN, clamped=())
    at = (0.1, 0.0, 0.0)
    assert mirror_images(free, at) == (at, pytest.approx((0.276, 0.0, 0.0)))
    assert mirror_images(THIN, at) == (at,)
    assert mirror_images(replace(free, masses=(PointMass((0.3,), 0.01),)), at) == (at,)
    assert len(mirror_images(free, (0.188, 0.0, 0.0))) == 1
    assert len(mirror_images(PLATE, (0.1, 0.05, 0.0))) == 2
    assert len(mirror_images(replace(PLATE, clamped=()), (0.1, 0.05, 0.0))) == 4
    both = [
        predicted("damping_patch", "free", **form(LIBRARY["damping_patch"], LOOK["free"]) | {"x": x})
        for x in (0.1, 0.276)
    ]
    assert both[0] == pytest.approx(both[1], rel=1e-7)
