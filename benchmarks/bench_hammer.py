"""Are the modes of realistic hammer tests all found, none invented, and do 95 % intervals hold the truth?

Noise of the force and the place of a hit are common to all outputs of that hit, and filters, converters and drift
leave traces that no independent noise has. Three kinds of test are simulated from poles and residues:

* ``beam``: a roving hammer along a cantilever, one accelerometer;
* ``plate``: a roving hammer on a plate clamped along one edge, two accelerometers, pairs of modes now and then;
* ``array``: the same plate or cantilever hit at one or two points, with accelerometers at all others;
* ``roving``: 74 points and three references, two pairs of modes closer than 2 %, and frequencies that differ by
  0.1 to 0.2 % (one standard deviation) from point to point as the set-up is moved;
* ``absorber``: a cantilever with an absorber on it, tuned near one of its modes: a mode of 1 to 5 % beside sharp ones;
* ``averaged``: FRFs averaged over blocks with a Hann window, the force random, lines as wide as the peaks;
* ``coarse``: FRFs on lines half as far apart as peaks are wide up to twice, half of them smoothed over three lines.

    python benchmarks/bench_hammer.py --kinds beam plate roving --seeds 50

A mode *stands out* if the power of its own peak is ten times that of the noise, the middle one of all FRFs.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

import numpy as np
from hammer.absorbed import absorbed
from hammer.on_lines import ON_LINES
from numpy.typing import NDArray
from scipy import stats

from acquisition import Dof, FrfSet, HammerTest, decide, estimate_frfs, judge_hits
from acquisition.errors import EstimationError
from acquisition.synthetic import HammerPlan, ModalSystem, hammer_test, modal_system
from identification import ModalModel, identify

CLAMPED = np.array([1.8751041, 4.6940911, 7.8547574, 10.9955407, 14.1371684, 17.2787596, 20.4203522])
FREE = np.array([4.7300407, 7.8532046, 10.9956078, 14.1371655])
KINDS = ("beam", "plate", "array", "roving", "absorber", "averaged", "coarse")
BEAMS = ("absorber", "averaged", "coarse")
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Setup:
    """A structure and how it is tested."""

    system: ModalSystem
    plan: HammerPlan
    band: tuple[float, float]


@dataclass(frozen=True)
class Outcome:
    """What became of one test."""

    kind: str
    seed: int
    modes: int
    found: int
    missed: list[float]
    invented: list[str]
    frequency_inside: int
    damping_inside: int
    frequency_z: list[float]
    cpu: float


def clamped_free(number: int, x: Array) -> Array:
    """Return a shape of a cantilever of unit length, unit mean square."""
    b = CLAMPED[number]
    s = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    return np.cosh(b * x) - np.cos(b * x) - s * (np.sinh(b * x) - np.sin(b * x))


def free_free(number: int, x: Array) -> Array:
    """Return a shape of a free beam of unit length, unit mean square; 0 and 1 are rigid."""
    if number < 2:
        return np.ones_like(x) if number == 0 else np.sqrt(3.0) * (2 * x - 1)
    b = FREE[number - 2]
    s = (np.cosh(b) - np.cos(b)) / (np.sinh(b) - np.sin(b))
    return np.cosh(b * x) + np.cos(b * x) - s * (np.sinh(b * x) + np.sin(b * x))


@dataclass(frozen=True, eq=False)
class Body:
    """A structure: frequencies [Hz], shapes and their slopes at its points, damping, and what is tested up to."""

    hertz: Array
    shapes: Array
    slopes: tuple[Array, Array]
    damping: float
    top: float


def beam(rng: np.random.Generator) -> Body:
    """Draw a cantilever."""
    length, mass = rng.uniform(0.4, 1.2), rng.uniform(0.5, 6.0)
    hertz = rng.uniform(6.0, 40.0) * (CLAMPED / CLAMPED[0]) ** 2
    x = np.linspace(0.1, 1.0, int(rng.integers(5, 16)))
    shapes, slope = (np.stack([f(k) for k in range(7)], axis=1) / np.sqrt(mass) for f in (
        lambda k: clamped_free(k, x), lambda k: _slope(lambda at: clamped_free(k, at), x) / length
    ))  # fmt: skip
    top = float(rng.uniform(0.6, 0.9) * hertz[int(rng.integers(3, 6))])
    return Body(hertz, shapes, (slope, 0 * slope), 0.002, top)


def plate(rng: np.random.Generator) -> Body:
    """Draw a plate clamped along one edge, its shapes products of those of beams."""
    mass, long, wide = rng.uniform(1.0, 8.0), rng.uniform(0.3, 0.6), rng.uniform(0.15, 0.4)
    first, ratio = rng.uniform(15.0, 40.0), rng.uniform(1.5, 3.5)
    kinds = [(i, j) for i in range(4) for j in range(4)]
    bending = (CLAMPED / CLAMPED[0]) ** 2
    across = [0.0, *(6.4 * ratio**2 * (FREE[:2] / FREE[0]) ** 2)]
    own = np.array(
        [np.hypot(bending[i], 2.2 * ratio * (i + 0.6) if j == 1 else across[j - (j > 1)]) for i, j in kinds]
    )
    order = np.argsort(own)
    gx, gy = np.meshgrid(np.linspace(0.2, 1.0, 5), np.linspace(0.0, 1.0, 5), indexing="ij")
    x, y, kinds = gx.ravel(), gy.ravel(), [kinds[k] for k in order]
    along, over = (
        [f(k) for k in range(4)] for f in (lambda k: clamped_free(k, x), lambda k: free_free(k, y))
    )
    dx = [_slope(lambda at, k=k: clamped_free(k, at), x) / long for k in range(4)]
    dy = [_slope(lambda at, k=k: free_free(k, at), y) / wide for k in range(4)]
    shapes = np.stack([along[i] * over[j] for i, j in kinds], axis=1) / np.sqrt(mass)
    slopes = [np.stack(s, axis=1) / np.sqrt(mass) for s in (
        [dx[i] * over[j] for i, j in kinds], [along[i] * dy[j] for i, j in kinds]
    )]  # fmt: skip
    hertz = first * own[order]
    return Body(
        hertz,
        shapes,
        (slopes[0], slopes[1]),
        0.002,
        float(rng.uniform(0.95, 1.05) * hertz[int(rng.integers(6, 11))]),
    )


def airframe(rng: np.random.Generator) -> Body:
    """Draw 13 modes at 74 points, two pairs closer than 2 %."""
    hertz = np.cumsum(rng.uniform(5.0, 14.0, 13)) + 10.0
    for k in (4, 8):
        hertz[k + 1] = hertz[k] * (1 + rng.uniform(0.008, 0.018))
    hertz = np.sort(hertz)
    x, y = rng.uniform(size=74), rng.uniform(size=74)
    wave, phase = rng.uniform(0.5, 4.0, (2, 13)), rng.uniform(0, 2 * np.pi, (2, 13))
    shapes = np.cos(wave[0] * np.pi * x[:, None] + phase[0]) * np.cos(wave[1] * np.pi * y[:, None] + phase[1])
    shapes = 2 * shapes / np.sqrt(rng.uniform(5.0, 20.0))
    return Body(hertz, shapes, (0 * shapes, 0 * shapes), 0.01, float(hertz[-1] + 8.0))


def _slope(shape: Callable[[Array], Array], x: Array) -> Array:
    step = 1e-6
    return (shape(x + step) - shape(x - step)) / (2 * step)


def drawn(kind: str, rng: np.random.Generator) -> Setup:
    """Draw a body, where it is hit and measured, and the equipment."""
    body = {"beam": beam, "plate": plate, "roving": airframe, **dict.fromkeys(BEAMS, beam)}.get(
        kind, beam if rng.random() < 0.5 else plate
    )(rng)
    every, later = np.arange(len(body.shapes)), np.arange(len(body.shapes) // 2, len(body.shapes))
    if kind == "array":
        setup = _setup(rng, body, every, rng.choice(later, int(rng.integers(1, 3)), replace=False))
        return replace(setup, plan=replace(setup.plan, drift=0.0))  # one point hit tells nothing of drift
    seats = {"plate": 2, "roving": 3}.get(kind, 1)
    setup = _setup(rng, body, rng.choice(later, seats, replace=False), every)
    if kind == "absorber":
        return replace(setup, system=absorbed(setup.system, setup.band, rng))
    return (
        replace(setup, plan=replace(setup.plan, drift=float(rng.uniform(8e-4, 2e-3)), hits=3))
        if kind == "roving"
        else setup
    )


def _setup(rng: np.random.Generator, body: Body, seats: NDArray[np.int64], hit: NDArray[np.int64]) -> Setup:
    """Put structure and test together: noise, filter, converter, place of the hits, drift."""
    zeta = body.damping * np.exp(0.7 * rng.standard_normal(len(body.hertz)))
    system = modal_system(
        frequency=body.hertz, damping=zeta, response_shapes=body.shapes[seats], point_shapes=body.shapes[hit],
        responses=[Dof(int(k) + 1, 3) for k in seats], points=[Dof(int(k) + 1, 3) for k in hit],
    )  # fmt: skip
    both = np.stack(
        [np.einsum("im,jm->ijm", body.shapes[seats], s[hit]) / (2j * system.poles.imag) for s in body.slopes]
    )
    rate = 2.0 ** np.ceil(np.log2(2.56 * body.top))
    slowest = float((zeta * 2 * np.pi * body.hertz)[body.hertz < body.top].min())
    duration = float(np.clip(2.0 ** np.ceil(np.log2(4.6 / slowest)), 1.0, 4.0))
    peak = float(rng.uniform(40.0, 150.0))
    plan = HammerPlan(
        rate=rate, samples=int(rate * duration), hits=int(rng.integers(3, 8)), peak=peak,
        width=float(rng.uniform(0.5, 1.2)) / body.top, pre_trigger=0.01, jitter=1e-4,
        decay=max(0.0, 4.6 / duration - slowest),
        force_noise=peak * 10 ** rng.uniform(-4.0, -2.5), response_noise=10 ** rng.uniform(-4.0, -2.0),
        adc_bits=int(rng.choice([16, 24])), position_sigma=float(rng.uniform(3e-4, 1e-3)), drift=5e-5,
        anti_alias="sharp",
    )  # fmt: skip
    return Setup(replace(system, gradients=both), plan, (max(5.0, 0.3 * float(body.hertz[0])), body.top))


def measured(setup: Setup, rng: np.random.Generator) -> tuple[HammerTest, FrfSet]:
    """Hit it, judge the hits and estimate FRFs."""
    test = hammer_test(setup.system, setup.plan, rng=rng)
    return test, estimate_frfs(test, verdicts=decide(judge_hits(test)))


def standing_out(setup: Setup, frfs: FrfSet, clean: FrfSet) -> NDArray[np.bool_]:
    """Tell which modes stand ten times above the noise at their own peak, in the middle one of all FRFs."""
    poles, decay = setup.system.poles, setup.plan.decay
    hertz = np.abs(poles) / (2 * np.pi)
    lines = np.searchsorted(frfs.frequency, hertz).clip(0, len(frfs.frequency) - 1)
    residues = np.concatenate([setup.system.residues[:, j] for j in range(setup.system.residues.shape[1])])
    peak = np.abs(residues) * np.abs(poles) ** 2 / (decay - poles.real)
    noise = np.abs(frfs.values - clean.values) ** 2
    near = np.stack([noise[:, max(0, k - 10) : k + 11].mean(axis=1) for k in lines], axis=1)
    margin = 2.0 / setup.plan.samples * setup.plan.rate
    inside = (hertz > setup.band[0] + margin) & (hertz < setup.band[1] - margin)
    return np.asarray(inside & (np.median(peak**2 / near, axis=0) > 10.0))


def judged(kind: str, seed: int) -> Outcome:
    """Simulate one test, identify it and count."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    setup = drawn(kind, rng)
    if kind in ON_LINES:
        return _on_lines(kind, seed, setup)
    _, frfs = measured(setup, np.random.default_rng([seed, 1]))
    quiet = replace(
        setup.plan, force_noise=0.0, response_noise=0.0, adc_bits=None, position_sigma=0.0, drift=0.0, hits=1
    )
    clean = estimate_frfs(hammer_test(setup.system, quiet, rng=np.random.default_rng([seed, 1])))
    out = standing_out(setup, frfs, clean)
    began = time.process_time()
    try:
        model = identify(frfs, band=setup.band)
    except EstimationError as error:
        hertz = np.abs(setup.system.poles[out]) / (2 * np.pi)
        print(f"  {kind} {seed}: {error}")
        return Outcome(kind, seed, int(out.sum()), 0, hertz.tolist(), [], 0, 0, [], 0.0)
    return _counted(kind, seed, setup, out, model, time.process_time() - began)


def _on_lines(kind: str, seed: int, setup: Setup) -> Outcome:
    """Make FRFs of a kind that has no hits, identify them and count; all modes well inside the band stand out."""
    rng = np.random.default_rng([seed, 1])
    true = setup.system.poles[setup.system.poles.imag < 2 * np.pi * setup.band[1]]
    frfs, noisy = ON_LINES[kind](setup.system, true, setup.band, rng)
    out = noisy & (np.abs(setup.system.poles) < 2 * np.pi * 0.97 * setup.band[1])
    began = time.process_time()
    try:
        model = identify(frfs)
    except EstimationError as error:
        print(f"  {kind} {seed}: {error}")
        hertz = np.abs(setup.system.poles[out]) / (2 * np.pi)
        return Outcome(kind, seed, int(out.sum()), 0, hertz.tolist(), [], 0, 0, [], 0.0)
    return _counted(kind, seed, setup, out, model, time.process_time() - began)


def _counted(
    kind: str, seed: int, setup: Setup, out: NDArray[np.bool_], model: ModalModel, cpu: float
) -> Outcome:
    """Pair identified with true modes, nearest first and within the reach of drift and damping."""
    true, found = setup.system.poles, model.poles
    reach = 3.0 * np.abs(true.real) + 3.0 * setup.plan.drift * np.abs(true)
    distance = np.abs(true.imag[:, None] - found.imag[None, :]) / reach[:, None]
    pairs: list[tuple[int, int]] = []
    while distance.size and distance.min() < 1.0:
        r, k = np.unravel_index(int(distance.argmin()), distance.shape)
        pairs.append((int(r), int(k)))
        distance[r], distance[:, k] = np.inf, np.inf
    mine, theirs = [p[0] for p in pairs], [p[1] for p in pairs]
    hertz, data = np.abs(true) / (2 * np.pi), model.modal
    zeta = -true.real / np.abs(true)
    f_z = (data.frequency[theirs] - hertz[mine]) / data.frequency_sigma[theirs]
    d_z = (data.damping[theirs] - zeta[mine]) / data.damping_sigma[theirs]
    names = [
        f"{data.frequency[k]:.2f} +- {data.frequency_sigma[k]:.2g} Hz, {100 * data.damping[k]:.3g} %"
        for k in range(len(found)) if k not in theirs
    ]  # fmt: skip
    missed = [float(hertz[r]) for r in np.flatnonzero(out) if r not in mine]
    inside = int(np.sum(np.abs(f_z) < 1.96)), int(np.sum(np.abs(d_z) < 1.96))
    return Outcome(
        kind, seed, int(out.sum()), len(pairs), missed, names, *inside, [round(float(z), 2) for z in f_z], cpu
    )


def share(good: int, total: int) -> str:
    """Return a count with its 95 % interval."""
    low, high = stats.binomtest(good, max(total, 1)).proportion_ci(0.95)
    return f"{good}/{total} = {100 * good / max(total, 1):.1f} % [{100 * low:.1f}, {100 * high:.1f}]"


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=KINDS)
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--json")
    arguments = parser.parse_args()
    everything: list[Outcome] = []
    for kind in arguments.kinds:
        here = [judged(kind, seed) for seed in range(arguments.first, arguments.first + arguments.seeds)]
        everything += here
        for o in here:
            if o.missed or o.invented:
                print(f"  {kind} {o.seed}: missed {[round(f, 2) for f in o.missed]}, invented {o.invented}")
        found, modes = sum(o.found for o in here), sum(o.modes for o in here)
        missed, invented = sum(len(o.missed) for o in here), sum(len(o.invented) for o in here)
        print(
            f"{kind}: {len(here)} tests, {modes} modes stand out, {missed} missed, {invented} invented in "
            f"{sum(bool(o.invented) for o in here)} tests; 95 % intervals hold frequency "
            f"{share(sum(o.frequency_inside for o in here), found)}, damping "
            f"{share(sum(o.damping_inside for o in here), found)}; {np.mean([o.cpu for o in here]):.2f} s of CPU each",
            flush=True,
        )
    if arguments.json:
        with open(arguments.json, "w") as stream:  # noqa: PTH123
            json.dump([asdict(o) for o in everything], stream)


if __name__ == "__main__":
    main()
