"""What became of a test: modes found, missed and invented, and whether the intervals hold the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hammer.setups import Setup
from identification import ModalModel


@dataclass(frozen=True, kw_only=True)
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
    damping_z: list[float]
    level: float
    cpu: float


def counted(
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
    level = _level(setup, model, mine, theirs) if pairs else np.nan
    return Outcome(
        kind=kind,
        seed=seed,
        modes=int(out.sum()),
        found=len(pairs),
        missed=missed,
        invented=names,
        frequency_inside=int(np.sum(np.abs(f_z) < 1.96)),
        damping_inside=int(np.sum(np.abs(d_z) < 1.96)),
        frequency_z=[round(float(z), 2) for z in f_z],
        damping_z=[round(float(z), 2) for z in d_z],
        level=level,
        cpu=cpu,
    )


def _level(setup: Setup, model: ModalModel, mine: list[int], theirs: list[int]) -> float:
    """Return the median of identified over true modal constants [-]."""
    rows = [str(d) for d in setup.system.responses], [str(d) for d in setup.system.points]
    true = np.array(
        [
            setup.system.residues[rows[0].index(str(r)), rows[1].index(str(f))] * 2j * setup.system.poles.imag
            for r, f in zip(model.responses, model.references, strict=True)
        ]
    )[:, mine]
    found = model.constants[:, theirs]
    strong = np.abs(true) > 0.3 * np.abs(true).max(axis=0)
    return float(np.median(np.abs(found[strong] / true[strong])))
