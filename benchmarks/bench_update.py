"""Updating a plate by its frequencies: modalkit beside plain re-solution of the full model with scipy.

python benchmarks/bench_update.py            one update and 200 bootstrap updates; the peer runs 4 of the 200
python benchmarks/bench_update.py --all      the peer runs all 200: some minutes

The plate has 760 elements, 15 regions with a modulus each, and the twelve frequencies of sample_data/plate_dry.
The peer takes the same steps (Gauss-Newton on relative frequencies with paper A's Eqs. 16 and 17, W_s from the
measurement, W_theta from tolerances, the same end of the iteration; ours corrects them by the curvature it has seen),
assembles the regions' matrices once, adds
them up at each step and solves with ``eigsh`` by shift and invert. Both begin with the mesh.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

import common
import numpy as np
from scipy import linalg
from scipy.sparse import linalg as sparse_linalg

from acquisition import ModalData, read_modes
from updating import Axes, Case, Material, Region, Spec, Tolerances, build_structure, measured_from_modes
from updating.update import bootstrap, update
from updating.update.parameters.affine import Affine

STEEL = Material(210e9, 7850.0, 0.3)
ALONG, ACROSS = 5, 3
REGIONS = tuple(
    Region(f"r{i}{j}", (0.376 * i / 5, 0.376 * (i + 1) / 5), (0.2 * j / 3, 0.2 * (j + 1) / 3))
    for i in range(ALONG)
    for j in range(ACROSS)
)
PLATE = Spec(
    "plate",
    length=0.376,
    width=0.2,
    thickness=0.003175,
    elements=(38, 20),
    clamped=("x0",),
    theory="kirchhoff",
    material=STEEL,
    regions=REGIONS,
)
NAMES = tuple(f"{region.name}.E" for region in REGIONS)
DOUBT = 0.3
DRAWS = 200
CONVERGED = 1e-7


def plate_case() -> Case:
    """Return the dry plate's published frequencies beside the model in 15 regions."""
    path = Path(__file__).resolve().parents[1] / "sample_data" / "plate_dry" / "modes.csv"
    modes = read_modes(path)
    data = ModalData(frequency=modes.frequency, frequency_sigma=1e-4 * modes.frequency)
    test = measured_from_modes(data, Axes(), PLATE)
    return Case("plate", PLATE, test, baseline=None, tolerances=Tolerances({"E": DOUBT}))


class Peer:
    """The same update with nothing reduced.

    Parameters
    ----------
    case : Case
        Test beside model.
    """

    def __init__(self, case: Case) -> None:
        structure = build_structure(case.spec)
        masks = [(structure.region_of == i).astype(float) for i in range(len(case.spec.regions))]
        free = structure.free()
        self.parts = [structure.matrix("stiffness", mask)[free][:, free].tocsc() for mask in masks]
        self.mass = structure.matrix("mass")[free][:, free].tocsc()
        test = case.measured
        self.frequency = test.frequency
        self.variance = (test.frequency_sigma / test.frequency) ** 2 + test.repeatability**2
        self.solutions = 0

    def modes(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return frequencies [Hz] and mass-normalised vectors at logarithms of the moduli."""
        stiffness = sum(np.exp(t) * part for t, part in zip(theta, self.parts, strict=True))
        n, count = self.mass.shape[0], len(self.frequency)
        values, vectors = sparse_linalg.eigsh(stiffness, count, self.mass, sigma=0.0, v0=np.ones(n))
        order = np.argsort(values)
        self.solutions += 1
        return np.sqrt(values[order]) / (2 * np.pi), vectors[:, order]

    def update(self, frequency: np.ndarray, centre: np.ndarray, start: np.ndarray) -> np.ndarray:
        """Return the logarithms of the moduli that fit some frequencies, held near ``centre``."""
        theta = start
        found = self.modes(theta)
        for _ in range(40):
            cost, step = self.step(*found, theta, frequency, centre)
            for halving in range(14):
                new = theta + step / 2**halving
                trial = self.modes(new)
                small = bool(np.all(np.abs(new - theta) <= CONVERGED * DOUBT))
                if small or self.cost(trial[0], new, frequency, centre) <= cost * (1 + 1e-12):
                    break
            theta, found = new, trial
            if small:
                break
        return theta

    def at(self, theta: np.ndarray, frequency: np.ndarray, centre: np.ndarray) -> float:
        """Return what Eq. 25 makes least, by the full model."""
        return self.cost(self.modes(theta)[0], theta, frequency, centre)

    def cost(self, f: np.ndarray, theta: np.ndarray, frequency: np.ndarray, centre: np.ndarray) -> float:
        """Return what Eq. 25 makes least."""
        return float(
            np.sum((1 - f / frequency) ** 2 / self.variance) + np.sum((theta - centre) ** 2) / DOUBT**2
        )

    def step(
        self, f: np.ndarray, vectors: np.ndarray, theta: np.ndarray, frequency: np.ndarray, centre: np.ndarray
    ) -> tuple[float, np.ndarray]:
        """Return the cost and the increment of Eq. 25."""
        scaled = zip(theta, self.parts, strict=True)
        forms = [np.exp(t) * np.sum(vectors * (part @ vectors), axis=0) for t, part in scaled]
        slopes = np.stack(forms, axis=1) / (2 * (2 * np.pi * f[:, None]) ** 2) * (f / frequency)[:, None]
        root = 1 / np.sqrt(self.variance)
        rows = np.vstack([root[:, None] * slopes, np.eye(len(theta)) / DOUBT])
        load = np.concatenate([root * (1 - f / frequency), (centre - theta) / DOUBT])
        return self.cost(f, theta, frequency, centre), np.linalg.lstsq(rows, load, rcond=None)[0]


def counted(run: Callable[[], object]) -> tuple[int, int]:
    """Return how many reduced eigenproblems a run solves, and how large the largest is."""
    ranks = []
    solve = Affine.eigen

    def counting(model: Affine, *given: Any) -> tuple[np.ndarray, np.ndarray]:
        ranks.append(model.rank)
        return solve(model, *given)

    with mock.patch.object(Affine, "eigen", counting):
        run()
    return len(ranks), max(ranks)


def floor(rank: int, solutions: int) -> float:
    """Time the dense eigenproblems alone of a reduced basis of some rank [s]."""
    rng = np.random.default_rng(1)
    matrix = rng.standard_normal((rank, rank))
    matrix = matrix @ matrix.T
    one = common.seconds(lambda: [linalg.eigh(matrix, subset_by_index=(0, 23)) for _ in range(20)], 5) / 20
    return one * solutions


def single(case: Case) -> np.ndarray:
    """Print one update, ours and the peer's; return the peer's logarithms."""
    nothing = np.zeros(len(NAMES))
    once = Peer(case)
    theirs = once.update(case.measured.frequency, nothing, nothing)
    own = common.seconds(lambda: update(case, parameters=NAMES), 5)
    peer = common.seconds(lambda: Peer(case).update(case.measured.frequency, nothing, nothing), 2)
    result = update(case, parameters=NAMES)
    ours = np.log([float(p.factor or np.nan) for p in result.parameters])
    solutions, rank = counted(lambda: update(case, parameters=NAMES))
    least = floor(rank, solutions)
    print(
        f"one update: {own:.3f} s, re-solution {peer:.2f} s ({once.solutions} solutions), ratio {peer / own:.1f}; "
        f"floor {least:.3f} s ({solutions} eigenproblems of {rank} unknowns); "
        f"what Eq. 25 makes least: {once.at(ours, case.measured.frequency, nothing):.4f}, "
        f"re-solution {once.at(theirs, case.measured.frequency, nothing):.4f}; "
        f"r.m.s. {result.rms_percent():.4f} %"
    )
    return theirs


def many(case: Case, theirs: np.ndarray, peers: int) -> None:
    """Print 200 bootstrap updates, ours and the peer's on the same draws, which starts where ours do."""
    result = bootstrap(case, parameters=NAMES, n=DRAWS, rng=np.random.default_rng(5))
    own = common.seconds(lambda: bootstrap(case, parameters=NAMES, n=DRAWS, rng=np.random.default_rng(5)), 2)
    drawn, peer = result.draws, Peer(case)
    solutions, rank = counted(
        lambda: bootstrap(case, parameters=NAMES, n=DRAWS, rng=np.random.default_rng(5))
    )
    least = floor(rank, solutions)
    for start, name in ((np.zeros(len(NAMES)), "from the nominal model"), (theirs, "from the solution")):
        kept = []

        def run(start: np.ndarray = start, kept: list[np.ndarray] = kept) -> None:
            kept.clear()
            for frequency, centre in zip(drawn.frequency[:peers], drawn.centre[:peers], strict=True):
                kept.append(peer.update(frequency, centre, start))

        peer.solutions = 0
        taken = common.seconds(run, 1) * DRAWS / peers
        both = zip(drawn.coordinates, kept, drawn.frequency, drawn.centre, strict=False)
        cost = [(peer.at(a, f, c), peer.at(b, f, c)) for a, b, f, c in both]
        print(
            f"{DRAWS} bootstrap updates: {own:.2f} s with the first update and the basis, re-solution {name} "
            f"{taken:.0f} s ({peer.solutions / peers:.1f} solutions each, {peers} run), ratio {taken / own:.0f}; "
            f"floor {least:.2f} s ({solutions} eigenproblems of {rank} unknowns); "
            f"Eq. 25 over that of the re-solution {', '.join(f'{a / b:.4f}' for a, b in cost)}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--all", action="store_true", help="the peer runs all bootstrap updates")
    chosen = parser.parse_args()
    case = plate_case()
    theirs = single(case)
    many(case, theirs, DRAWS if chosen.all else 4)


if __name__ == "__main__":
    main()
