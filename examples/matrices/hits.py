"""Synthetic hammer tests of a structure of bars whose matrices are given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from bars import Place, Structure, rows_of
from scipy import sparse
from scipy.linalg import eigh

from acquisition import Dof, Geometry, hammer_test, write_uff
from acquisition.synthetic import HammerPlan, modal_system

Points = dict[int, tuple[Place, int]]
"""Where a structure is hit [m], and along which axis (UFF code), by the number of the point."""

DAMPING = 0.004
MODES = 24


def _nearest(places: list[Place], place: Place) -> Place:
    """Return the node's place that is nearest to one."""
    return places[int(np.argmin(np.linalg.norm(np.subtract(places, place), axis=1)))]


def hit(
    file: Path,
    model: Structure,
    stiffness: sparse.csr_array,
    mass: sparse.csr_array,
    points: Points,
    *,
    rate: float,
    rng: np.random.Generator,
) -> None:
    """Hit a structure five times at every point and write the hits; the last point carries the accelerometer."""
    values, vectors = eigh(stiffness.toarray(), mass.toarray(), subset_by_index=(0, MODES - 1))
    row_of = {row: i for i, row in enumerate(model.free)}
    nodes = {place: n for n, place in enumerate(model.places, start=1)}
    near = {p: _nearest(list(nodes), place) for p, (place, _) in points.items()}
    rows = [row_of[rows_of(nodes[near[p]])[abs(code) - 1]] for p, (_, code) in points.items()]
    shapes = np.sign([code for _, code in points.values()])[:, None] * vectors[rows]
    dofs = [Dof(p, code) for p, (_, code) in points.items()]
    system = modal_system(
        frequency=np.sqrt(values) / (2 * np.pi), damping=np.full(MODES, DAMPING), response_shapes=shapes[-1:],
        point_shapes=shapes, responses=dofs[-1:], points=dofs,
    )  # fmt: skip
    plan = HammerPlan(
        rate=rate,
        samples=8192,
        hits=5,
        peak=50.0,
        width=8e-4,
        pre_trigger=0.02,
        force_noise=0.01,
        response_noise=3e-4,
    )
    geometry = Geometry(tuple(points), np.array([near[p] for p in points]))
    test = hammer_test(system, plan, rng=rng, geometry=geometry)
    write_uff(file, tests=test, precision="single", title=file.stem)
