"""Inertia of an unbounded still fluid by panels of constant doublet strength on the body's plane.

A rectangular doublet panel is a ring of four vortices; the normal velocity that it induces in its plane is in
closed form (Katz and Plotkin, Low-Speed Aerodynamics, 2001, section 10.4). Two meshes are extrapolated linearly,
as the error of a panel at a sharp edge is of first order. The thickness enters by the ratio of Blevins (Formulas for
Natural Frequency and Mode Shape, 1979, table 14-1) for a rectangular section.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from diagnosis.body import Body
from diagnosis.mesh import Floats

THICK = np.array([0.0, 0.1, 0.2, 0.5, 1.0])
HEAVIER = np.array([1.0, 1.14, 1.21, 1.36, 1.51])
PANELS = {"beam": (40, 6), "plate": (16, 10)}


def modal_inertia(body: Body, shapes: Callable[[Floats], Floats]) -> Floats:
    """Return the fluid's inertia in modal coordinates, (m, m) [-]; ``shapes`` gives the modes at places."""
    nx, ny = PANELS[body.kind]
    coarse = _inertia(body, shapes, nx, ny)
    fine = _inertia(body, shapes, 2 * nx, 2 * ny)
    thick = float(np.interp(body.thickness / min(body.length, body.width), THICK, HEAVIER))
    return np.asarray(body.fluid * thick * (2 * fine - coarse))


def _inertia(body: Body, shapes: Callable[[Floats], Floats], nx: int, ny: int) -> Floats:
    x, y = (np.arange(n + 1) * size / n for n, size in ((nx, body.length), (ny, body.width)))
    centres = np.stack(
        [m.ravel() for m in np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2, indexing="ij")], axis=1
    )
    velocity = shapes(centres)
    jump = np.linalg.solve(_induced(body.length / nx, body.width / ny, nx, ny), velocity)
    inertia = velocity.T @ jump * (body.length / nx) * (body.width / ny)
    return np.asarray((inertia + inertia.T) / 2)


def _induced(dx: float, dy: float, nx: int, ny: int) -> Floats:
    """Return the velocity at each centre by each panel of unit doublet strength [1/m]."""
    i, j = np.arange(-nx + 1, nx), np.arange(-ny + 1, ny)
    total = np.zeros((len(i), len(j)))
    for a in (-0.5, 0.5):
        for b in (-0.5, 0.5):
            px, py = ((i - a) * dx)[:, None], ((j - b) * dy)[None, :]
            total += np.sign(a * b) * np.hypot(px, py) / (px * py)
    total /= 4 * np.pi
    row, column = np.divmod(np.arange(nx * ny), ny)
    return np.asarray(total[row[:, None] - row + nx - 1, column[:, None] - column + ny - 1])
