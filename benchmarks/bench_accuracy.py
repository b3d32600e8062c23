"""Are all modes found and none invented, how far off are they, and do 95 % intervals hold the truth?

The structure has twelve modes with a close pair and, on request, two above the band. Everything is automatic;
sdypy-EMA is given the true frequencies and picks its nearest poles.

    python benchmarks/bench_accuracy.py found --seeds 5
    python benchmarks/bench_accuracy.py references --seeds 10
    python benchmarks/bench_accuracy.py coverage --seeds 60
    python benchmarks/bench_accuracy.py peer --seeds 5
"""

from __future__ import annotations

import argparse
import contextlib
import io
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from acquisition import Dof, FrfSet
from acquisition.errors import EstimationError
from identification import ModalModel, identify, mac

HERTZ = np.array([62.0, 118.0, 187.0, 243.0, 310.0, 402.0, 405.5, 478.0, 566.0, 655.0, 763.0, 884.0])
DAMPING = np.array([2.0, 1.2, 0.9, 0.7, 0.6, 0.5, 0.4, 0.35, 0.3, 0.28, 0.24, 0.2]) / 100
ABOVE, ABOVE_DAMPING = np.array([1080.0, 1250.0]), np.array([0.002, 0.003])
LOWS, ORDERS, NOISES = (0.0, 10.0, 100.0, 300.0, 550.0), (40, 60, 100), (0.001, 0.01, 0.03)


@dataclass(frozen=True, eq=False)
class Truth:
    """A structure: poles [rad/s] and shapes of 25 points [kg^-1/2]."""

    poles: NDArray[np.complex128]
    shapes: NDArray[np.float64]

    @property
    def hertz(self) -> NDArray[np.float64]:
        """Natural frequencies [Hz]."""
        return np.abs(self.poles) / (2 * np.pi)

    @property
    def damping(self) -> NDArray[np.float64]:
        """Damping ratios [-]."""
        return np.asarray(-self.poles.real / np.abs(self.poles))


def draw(seed: int, *, above: bool = True, separation: float | None = None) -> Truth:
    """Draw shapes; point 4 moves in every mode. ``separation`` sets the pair's relative distance."""
    hertz = HERTZ.copy()
    if separation is not None:
        hertz[6] = hertz[5] * (1 + separation)
    damping = DAMPING
    if above:
        hertz, damping = np.append(hertz, ABOVE), np.append(damping, ABOVE_DAMPING)
    shapes = np.random.default_rng(seed).standard_normal((25, len(hertz)))
    shapes[3] = np.sign(shapes[3]) * np.maximum(np.abs(shapes[3]), 0.3)
    return Truth(2 * np.pi * hertz * (-damping + 1j * np.sqrt(1 - damping**2)), shapes)


def measure(truth: Truth, band: tuple[float, float], noise: float, seed: int, **options: object) -> FrfSet:
    """Return accelerances of 25 points in a band; noise relative to each FRF's r.m.s. in that band."""
    references = options.get("references", (4,))
    assert isinstance(references, tuple)
    df = float(str(options.get("df", 0.5)))
    frequency = np.arange(round(band[0] / df), round(band[1] / df) + 1) * df
    s = 2j * np.pi * frequency
    terms = (1 / (s[:, None] - truth.poles) - 1 / (s[:, None] - truth.poles.conj())) / (2j * truth.poles.imag)
    values = np.concatenate([(truth.shapes * truth.shapes[j - 1]) @ terms.T for j in references]) * s**2
    rng = np.random.default_rng(10_000 + seed)
    dirt = rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)
    level = noise * np.sqrt(np.mean(np.abs(values) ** 2, axis=1, keepdims=True) / 2)
    x = (frequency - band[0]) / (band[1] - band[0])
    colour = {"white": np.ones_like(x), "rising": 0.3 + 2 * x**2, "falling": 1.5 - 1.3 * x}
    values = values + level * dirt * colour[str(options.get("colour", "white"))]
    responses = tuple(Dof(i, 3) for _ in references for i in range(1, 26))
    return FrfSet(frequency, values, responses, tuple(Dof(j, 3) for j in references for _ in range(25)))


def within(truth: Truth, low: float, high: float = 1000.0) -> NDArray[np.bool_]:
    """Tell which modes lie in a band."""
    return np.asarray((truth.hertz >= low) & (truth.hertz <= high))


def counted(good: int, total: int) -> str:
    """Return a count with its 95 % binomial interval."""
    low, high = stats.binomtest(good, total).proportion_ci(0.95)
    return f"{good}/{total} = {100 * good / total:.2f} % [{100 * low:.2f}, {100 * high:.2f}]"


def tried(frfs: FrfSet, low: float, order: int) -> ModalModel | None:
    """Identify, or None if nothing stands out."""
    try:
        return identify(frfs, band=(low, 1000.0), order=order)
    except EstimationError:
        return None


def found(seeds: int, *, references: tuple[int, ...] = (4,), separation: float | None = None) -> None:
    """Count runs in which all modes are found, with their shapes, and none is invented."""
    good, total, missed, invented = 0, 0, 0, 0
    for seed, noise, low in _grid(seeds):
        truth = draw(seed, above=seed % 2 == 0, separation=separation)
        frfs = measure(truth, (low, 1000.0), noise, seed, references=references)
        wanted = within(truth, low)
        for order in ORDERS:
            model = tried(frfs, low, order)
            total += 1
            if model is not None and len(model) == wanted.sum():
                likeness = np.diag(mac(model.modal.shapes, truth.shapes[:, wanted]))
                right = np.abs(model.modal.frequency / truth.hertz[wanted] - 1) < 1e-3
                if right.all() and likeness.min() > 1 - 2 * noise:
                    good += 1
                    continue
            count = 0 if model is None else len(model)
            missed, invented = missed + (count < wanted.sum()), invented + (count > wanted.sum())
            print(
                f"  seed {seed}, noise {noise}, from {low:g} Hz, order {order}: {count} of {wanted.sum()} modes"
            )
    print(f"all modes and no other: {counted(good, total)}; too few {missed}, too many {invented}")


def _grid(seeds: int) -> Iterator[tuple[int, float, float]]:
    for seed in range(seeds):
        for noise in NOISES:
            for low in LOWS:
                yield seed, noise, low


def coverage(seeds: int, *, references: tuple[int, ...] = (4,)) -> None:
    """Count truths inside 95 % intervals of frequency, damping and modal constants."""
    kinds = ("frequency", "damping", "constants")
    pooled = dict.fromkeys(kinds, (0, 0))
    for colour in ("white", "rising", "falling"):
        for above in (True, False):
            for df in (0.5, 1.0):
                here = dict.fromkeys(kinds, (0, 0))
                for seed in range(seeds):
                    _cover(here, seed, colour=colour, above=above, df=df, references=references)
                label = f"{colour:8s} {'modes above' if above else 'none above '} df {df:g} Hz"
                print(f"{label}:", "; ".join(f"{k} {counted(*here[k])}" for k in kinds), flush=True)
                pooled = {k: (pooled[k][0] + here[k][0], pooled[k][1] + here[k][1]) for k in kinds}
    print("pooled:", "; ".join(f"{k} {counted(*pooled[k])}" for k in kinds))


def _cover(
    here: dict[str, tuple[int, int]],
    seed: int,
    *,
    colour: str,
    above: bool,
    df: float,
    references: tuple[int, ...],
) -> None:
    truth, low = draw(seed, above=above), (0.0, 300.0)[seed % 2]
    frfs = measure(truth, (low, 1000.0), 0.01, seed, colour=colour, df=df, references=references)
    model, wanted = identify(frfs, band=(low, 1000.0)), within(truth, low)
    if len(model) != wanted.sum():
        print(f"  seed {seed}: {len(model)} of {wanted.sum()} modes")
        return
    exact = np.concatenate([truth.shapes[:, wanted] * truth.shapes[j - 1, wanted] for j in references])
    scores = {
        "frequency": (model.modal.frequency - truth.hertz[wanted]) / model.modal.frequency_sigma,
        "damping": (model.modal.damping - truth.damping[wanted]) / model.modal.damping_sigma,
        "constants": ((model.constants.real - exact) / model.constant_sigma).ravel(),
    }
    for kind, score in scores.items():
        here[kind] = here[kind][0] + int(np.sum(np.abs(score) < 1.959964)), here[kind][1] + score.size


def peer(seeds: int) -> None:
    """Compare errors with sdypy-EMA's: its own choice nearest the true frequency, and its best at any order."""
    errors: dict[str, list[NDArray[np.float64]]] = {"modalkit": [], "nearest": [], "best": []}
    for seed in range(seeds):
        truth = draw(seed)
        frfs = measure(truth, (1.0, 1000.0), 0.01, seed, df=1.0)
        wanted = within(truth, 1.0)
        model = identify(frfs)
        exact = np.stack([truth.hertz[wanted], truth.damping[wanted]])
        ours = np.stack([model.modal.frequency, model.modal.damping])
        errors["modalkit"].append(np.abs(ours / exact - 1))
        nearest, best = _theirs(frfs, exact)
        errors["nearest"].append(nearest)
        errors["best"].append(best)
    stacked = {k: np.stack(v) for k, v in errors.items()}
    for row, name in enumerate(("frequency", "damping")):
        for key, label in (("nearest", "its choice"), ("best", "its best pole at any order")):
            ratio = [f(stacked[key][:, row]) / f(stacked["modalkit"][:, row]) for f in (np.median, np.max)]
            print(
                f"{name}: modalkit median {np.median(stacked['modalkit'][:, row]):.2g}, "
                f"max {stacked['modalkit'][:, row].max():.2g}; sdypy-EMA, {label}: median "
                f"{np.median(stacked[key][:, row]):.2g}, max {stacked[key][:, row].max():.2g}; "
                f"{ratio[0]:.1f} and {ratio[1]:.1f} times ours"
            )


def _theirs(frfs: FrfSet, exact: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    from sdypy import EMA

    quiet = io.StringIO()
    with warnings.catch_warnings(), contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
        warnings.simplefilter("ignore")
        model = EMA.Model(
            frf=np.array(frfs.values),
            freq=np.array(frfs.frequency),
            lower=10,
            upper=1000,
            pol_order_high=60,
            frf_form="accelerance",
        )
        model.get_poles(method="lscf", show_progress=False)
        model.select_closest_poles(list(exact[0]))
        chosen = np.stack([np.asarray(model.nat_freq), np.asarray(model.nat_xi)])
        every = np.stack([np.concatenate(model.pole_freq), np.concatenate(model.pole_xi)])
    off = np.abs(every[:, None, :] / exact[:, :, None] - 1)
    off = np.where((every[1] > 0)[None, None, :], off, np.inf)
    near = off[0] < 0.01
    best = off[0].argmin(axis=1)
    damping = np.where(near, off[1], np.inf).min(axis=1)
    return np.abs(chosen / exact - 1), np.stack([off[0][np.arange(len(best)), best], damping])


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("what", choices=["found", "references", "coverage", "coverage-references", "peer"])
    parser.add_argument("--seeds", type=int, default=5)
    chosen = parser.parse_args()
    three = (4, 9, 17)
    match chosen.what:
        case "found":
            found(chosen.seeds)
        case "references":
            found(chosen.seeds, references=three, separation=0.002)
        case "coverage":
            coverage(chosen.seeds)
        case "coverage-references":
            coverage(chosen.seeds, references=three)
        case _:
            peer(chosen.seeds)


if __name__ == "__main__":
    main()
