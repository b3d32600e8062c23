"""The diagnosis on tests of structures that another program solved: bricks in CalculiX, no theory of plates.

    uv run python benchmarks/bench_bricks.py --seed 3 --trials 40        # needs ccx; some 30 s a trial on one core
    uv run python benchmarks/bench_bricks.py --seed 3 --trials 40 --only 7 12
    uv run python benchmarks/bench_bricks.py --seed 3 --trials 40 --beams          # strips, studied as beams

Plates and strips of steel, clamped or free, with what is hidden put into the bricks: another elasticity there, a body
on a stalk, a spring, a soft layer at the root. The modes that CalculiX prints are hit and recorded; the study states
the nominal body. Dimensions and properties scatter within the tolerances, damping from mode to mode, frequencies by
what mounting leaves. What is named is compared with what was hidden.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from acquisition import Dof, Geometry, HammerPlan, ModalSystem, hammer_test, write_uff
from acquisition.arrays import FloatArray
from modalkit.workflow.case import sessions_of
from updating import diagnose
from updating.effects import LIBRARY

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "updating" / "effects"))
from calculix_bricks import Bricks, body, isotropic, modes, spring

E, DENSITY, POISSON = 205e9, 7850.0, 0.3
TOLERANCES = {
    "E": 0.01,
    "density": 0.003,
    "thickness": 0.005,
    "length": 0.001,
    "width": 0.002,
    "damping": 0.15,
}
REMOUNTED, SCATTERED = 5e-4, 0.08
"""Scatter of frequencies by mounting, and of damping from mode to mode [-]."""


@dataclass(frozen=True)
class Specimen:
    """What stands on the bench: a flat body of bricks, and how it is measured.

    Parameters
    ----------
    bricks : Bricks
        The body.
    extra : tuple of str
        Lines of the deck for what is fixed to it.
    damping : float
        Factor on all damping [-].
    at_points : function of residues (n_points, n_modes)
        What the measurement makes of them.
    """

    bricks: Bricks
    extra: tuple[str, ...] = ()
    damping: float = 1.0
    at_points: Callable[[FloatArray], FloatArray] = field(default=lambda residues: residues)


@dataclass(frozen=True)
class Nominal:
    """What the study states.

    Parameters
    ----------
    clamped : bool
        At x = 0, else free.
    size : (3,) tuple of float
        Length, width, thickness [m].
    cells : (2,) tuple of int
        Bricks along and across.
    beam : bool
        Whether the study states a beam, hit on its middle line; else a plate.
    """

    clamped: bool
    size: tuple[float, float, float]
    cells: tuple[int, int]
    beam: bool = False

    @property
    def points(self) -> FloatArray:
        """Test points, at corners of bricks, as shares of length and width (n, 2) [-]."""
        along = np.arange(4 if self.clamped else 0, self.cells[0] + 1, 4) / self.cells[0]
        x, y = np.meshgrid(along, [1 / 2] if self.beam else [0, 1 / 2, 1], indexing="ij")
        return np.stack([x.ravel(), y.ravel()], axis=1)

    @property
    def graded(self) -> FloatArray:
        """Ends of bricks along x, as shares of the length; finer towards a clamp, where the strain gathers [-]."""
        even = np.arange(self.cells[0] + 1) / self.cells[0]
        near = self.size[2] / self.size[0] * np.array([0.5, 1.0, 2.0, 4.0])
        return np.unique(np.concatenate([even, near[near < 0.8 * even[1]]])) if self.clamped else even


Hide = Callable[[np.random.Generator, Specimen, Nominal], Specimen]


def _inside(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> tuple[float, float]:
    """Return a place at corners of bricks, off the root; on the middle line of a beam."""
    x, y = own.bricks.x, own.bricks.y
    across = len(y) // 2 if nominal.beam else int(rng.integers(0, len(y)))
    return float(x[int(rng.integers(len(x) // 4, len(x)))]), float(y[across])


def _block(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    at = _inside(rng, own, nominal)
    mass = DENSITY * float(np.prod(nominal.size)) * rng.uniform(0.02, 0.08)
    height = own.bricks.thickness / 2 + (mass / 7850.0) ** (1 / 3) / 2
    return replace(own, extra=tuple(body(own.bricks, at, mass, height)))


def _soft(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    loss, length, width = rng.uniform(0.3, 0.6), own.bricks.x[-1], own.bricks.y[-1]
    long, wide = rng.uniform(0.08, 0.2) * length, (2.0 if nominal.beam else rng.uniform(0.2, 0.4)) * width
    x, y = rng.uniform(0.15, 0.85) * length, rng.uniform(0.25, 0.75) * width
    there = lambda a, b: abs(a - x) < long / 2 and abs(b - y) < wide / 2  # noqa: E731
    bricks = replace(own.bricks, place=there, elastic_there=isotropic(E * (1 - loss), POISSON))
    return replace(own, bricks=bricks)


def _root(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    layer = own.bricks.x[1]
    softer = isotropic(E * rng.uniform(0.02, 0.1), POISSON)
    return replace(own, bricks=replace(own.bricks, place=lambda a, b: a < layer, elastic_there=softer))


def _held(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    at = _inside(rng, own, nominal)
    length, width, thickness = nominal.size
    stiffness = E * width * thickness**3 / 12 / length**3 * rng.uniform(2.0, 15.0)
    return replace(own, extra=tuple(spring(own.bricks, at, stiffness)))


def _stretched(name: str, low: float, high: float) -> Hide:
    def hide(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
        factor = 1 + rng.choice([-1, 1]) * rng.uniform(low, high)
        if name == "thickness":
            return replace(own, bricks=replace(own.bricks, thickness=own.bricks.thickness * factor))
        if name == "length":
            return replace(own, bricks=replace(own.bricks, x=tuple(np.asarray(own.bricks.x) * factor)))
        if name == "density":
            return replace(own, bricks=replace(own.bricks, density=own.bricks.density * factor))
        return replace(own, bricks=replace(own.bricks, elastic=isotropic(E * factor, POISSON)))

    return hide


def _rolled(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    across = E * rng.uniform(0.75, 0.9)
    shear = np.sqrt(E * across) / (2 * (1 + POISSON)) * rng.uniform(0.9, 1.1)
    first = f"{E:g}, {across:.9g}, {E:g}, {POISSON}, {POISSON}, {POISSON}, {shear:.9g}, {shear:.9g}"
    lines = f"*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{first}\n{shear:.9g}"
    return replace(own, bricks=replace(own.bricks, elastic=lines))


def _damped(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    return replace(own, damping=rng.uniform(1.7, 2.5))


def _loud(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    gain = rng.choice([rng.uniform(0.7, 0.85), rng.uniform(1.2, 1.4)])
    return replace(own, at_points=lambda residues: gain * residues)


def _turned(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    one = int(rng.integers(len(nominal.points) - 1))
    signs = np.where(np.arange(len(nominal.points)) == one, -1.0, 1.0)[:, None]
    return replace(own, at_points=lambda residues: signs * residues)


def _nothing(rng: np.random.Generator, own: Specimen, nominal: Nominal) -> Specimen:
    return own


HIDDEN: dict[str, Hide] = {
    "nothing": _nothing,
    "lumped_mass": _block,
    "local_stiffness": _soft,
    "clamp": _root,
    "ground_spring": _held,
    "thickness": _stretched("thickness", 0.025, 0.05),
    "length": _stretched("length", 0.008, 0.02),
    "density": _stretched("density", 0.015, 0.04),
    "E": _stretched("E", 0.05, 0.1),
    "orthotropy": _rolled,
    "uniform_damping": _damped,
    "calibration_gain": _loud,
    "polarity": _turned,
}
SAME = {"clamp": {"clamp_rotation", "clamp_translation"}, "E": {"material"}}
"""Names of the library for what is hidden, where they differ."""


def draw(rng: np.random.Generator, *, beams: bool) -> tuple[Nominal, Specimen, tuple[str, ...]]:
    """Return what is stated, what stands there, and what was hidden in it."""
    length = rng.uniform(0.25, 0.45)
    narrow = rng.random() < 0.3 or beams
    width = length * (
        rng.uniform(0.05, 0.12) if beams else rng.uniform(0.1, 0.2) if narrow else rng.uniform(0.4, 0.75)
    )
    size = (length, width, length * rng.uniform(0.005, 0.01))
    nominal = Nominal(bool(rng.random() < 0.5), size, (24, 4 if narrow else 12), beams)
    off = {n: 1 + s * rng.standard_normal() for n, s in TOLERANCES.items()}
    length, width, thickness = (
        a * off[n] for a, n in zip(size, ("length", "width", "thickness"), strict=True)
    )
    bricks = Bricks(
        tuple(nominal.graded * length), tuple(np.linspace(0, width, nominal.cells[1] + 1)),
        thickness, isotropic(E * off["E"], POISSON), DENSITY * off["density"], clamped=nominal.clamped,
    )  # fmt: skip
    specimen = Specimen(bricks, damping=off["damping"])
    absent = {"clamp": not nominal.clamped, "orthotropy": beams}
    possible = [n for n in HIDDEN if not absent.get(n)]
    count = 2 if rng.random() < 0.2 else 1
    names = tuple(str(n) for n in rng.choice(possible[1:], count, replace=False))
    if rng.random() < 0.15:
        names = ("nothing",)
    for name in names:
        kept = specimen.extra
        specimen = HIDDEN[name](rng, specimen, nominal)
        specimen = replace(specimen, extra=specimen.extra or kept)
    return nominal, specimen, names


def measure(rng: np.random.Generator, nominal: Nominal, own: Specimen, folder: Path) -> tuple[float, float]:
    """Hit the specimen, write ``test.uff``, and return the band [Hz]."""
    shares = nominal.points
    places = shares * (own.bricks.x[-1], own.bricks.y[-1])
    frequency, shapes = modes(folder, own.bricks, 26, places, own.extra)
    elastic = frequency > 1.0
    seen = elastic & (np.abs(shapes).max(axis=0) > 0.2 * np.abs(shapes[:, elastic]).max())
    frequency, shapes = frequency[seen], shapes[:, seen]
    frequency = frequency * np.exp(REMOUNTED * rng.standard_normal(len(frequency)))
    clear = [n for n in range(4, 9) if frequency[n] > CLEAR * frequency[n - 1]]
    top = 0.5 * (frequency[max(clear) - 1] + frequency[max(clear)])
    omega = 2 * np.pi * frequency
    ratio = own.damping * (ALPHA / (2 * omega) + beta(omega[0]) * omega / 2)
    ratio = ratio * np.exp(SCATTERED * rng.standard_normal(len(ratio)))
    damped = omega * np.sqrt(1 - ratio**2)
    residues = own.at_points(shapes * shapes[-1]) / (2j * damped)
    nodes = tuple(Dof(i + 1, 3) for i in range(len(places)))
    system = ModalSystem(-ratio * omega + 1j * damped, residues[None], (nodes[-1],), nodes)
    rate = 2.56 * top
    samples = int(2 ** np.ceil(np.log2(rate * 6 / (ratio[0] * omega[0]))))
    plan = HammerPlan(
        rate=rate, samples=min(samples, 8192), hits=4, peak=60.0, width=1.2 / top, pre_trigger=0.02 * samples / rate,
        force_noise=2e-4 * 60, response_noise=3e-4, position_sigma=0.0,
        decay=max(0.0, 5 / (min(samples, 8192) / rate) - ratio[0] * omega[0]), adc_bits=20,
    )  # fmt: skip
    stated = np.zeros((len(places), 3))
    stated[:, :2] = shares * nominal.size[:2]
    geometry = Geometry(tuple(range(1, len(places) + 1)), stated)
    test = hammer_test(system, plan, rng=rng, geometry=geometry)
    write_uff(folder / "test.uff", tests=[test], title="bricks", precision="single")
    _study(nominal, folder, (0.5 * float(frequency[0]), float(top)), plan.decay, float(omega[0]))
    return 0.5 * float(frequency[0]), float(top)


CLEAR = 1.15
"""The band ends where the next mode is so many times higher than the last [-]."""

ALPHA = 1.0
"""Damping proportional to mass [1/s]; that to stiffness is as much again half a decade above the first mode."""


def beta(first: float) -> float:
    """Return the damping proportional to stiffness that the specimen and the study share [s]."""
    return ALPHA / (3 * first) ** 2


def _study(nominal: Nominal, folder: Path, band: tuple[float, float], decay: float, first: float) -> None:
    length, width, thickness = nominal.size
    strip = nominal.cells[1] < 12
    kind, theory, elements = (
        ("beam", "timoshenko", 40) if nominal.beam else ("plate", "kirchhoff", [28, 4 if strip else 14])
    )
    lines = [
        "[test]", 'files = ["test.uff"]', f"band = {list(band)}", f"exponential_window = {float(decay)!r}",
        "calibration = 0.03", f"repeatability = {REMOUNTED}", "position_sigma = 0.0005", "[model]",
        f'type = "{kind}"', f"length = {length}", f"width = {width}", f"thickness = {thickness}",
        f"elements = {elements}", f"clamped = {['x0'] if nominal.clamped else []}", f'theory = "{theory}"',
        "[model.material]", f"E = {E}", f"density = {DENSITY}", f"poisson = {POISSON}",
        "[model.damping]", f"alpha = {ALPHA}", f"beta = {float(beta(first))!r}",
        "[tolerances]", *(f"{n} = {s}" for n, s in TOLERANCES.items()),
    ]  # fmt: skip
    (folder / "study.toml").write_text("\n".join(lines) + "\n")


def trial(seed: int, index: int, folder: Path, *, beams: bool) -> tuple[str, str, str]:
    """Return the body, what was hidden, and how the answer stands to it."""
    rng = np.random.default_rng([seed, index])
    nominal, own, names = draw(rng, beams=beams)
    measure(rng, nominal, own, folder)
    found = diagnose(sessions_of([folder / "study.toml"])[0].case, library=list(LIBRARY.values()))
    shape = "beam" if beams else "strip" if nominal.cells[1] < 12 else "plate"
    body_name = f"{'clamped' if nominal.clamped else 'free'} {shape}"
    return body_name, "+".join(names), verdict(found, names)


def verdict(found: object, names: Sequence[str]) -> str:
    """Return "right", "class", "part", "unknown", "none" or "wrong", with what was answered."""
    kind = str(found.verdict)  # type: ignore[attr-defined]
    sets = [set(s) for s in found.sets]  # type: ignore[attr-defined]
    said = f"{kind} {' | '.join('+'.join(sorted(s)) for s in sets[:3])}"
    if names == ("nothing",):
        return f"{'right' if kind == 'none' else 'wrong'}: {said}"
    wanted = [SAME.get(n, {n}) for n in names]
    holds = [len(s) == len(wanted) and all(s & w for w in wanted) for s in sets]
    if kind in ("named", "class") and any(holds):
        return f"{'right' if kind == 'named' else 'class'}: {said}"
    if kind in ("named", "class") and any(
        s and all(any({one} & w for w in wanted) for one in s) for s in sets
    ):
        return f"part: {said}"
    return f"{'wrong' if kind in ('named', 'class') else kind}: {said}"


def main() -> None:
    """Run the trials asked for."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--trials", type=int, default=20)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--beams", action="store_true")
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    for index in given.only or range(given.trials):
        with tempfile.TemporaryDirectory() as temporary:
            folder = given.keep / str(index) if given.keep else Path(temporary)
            folder.mkdir(parents=True, exist_ok=True)
            kind, hidden, answer = trial(given.seed, index, folder, beams=given.beams)
        counts[answer.split(":")[0]] += 1
        print(f"{index:3d}  {kind:14s} {hidden:36s} {answer}", flush=True)
    print(dict(counts))


if __name__ == "__main__":
    main()
