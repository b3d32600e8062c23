"""Fluid on both faces of a rectangular plate, by a lattice of doublet panels over its length and width.

The fluid is unbounded, or lies between a free surface and a bottom (``images``). The
plate is flat and its panels carry jumps of potential that are constant on each; the normal velocity of a
rectangular panel in its own plane has a closed form (Katz and Plotkin, Low-Speed Aerodynamics, 2nd ed.,
section 10.4.5). Edges and collocation points are evenly spaced in the angle along both sides, which takes
care of the square-root edges (Lan, J. Aircraft 11 (1974) 518). All places move as they like: nothing is lumped
over the width.

Thickness lets every open edge reach further: by as much as makes a flat strip as heavy in the fluid as the
rectangular section itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from acquisition.arrays import FloatArray, frozen_array
from modalkit.simulator.bodies.beam.water import slip_factor, thickness_factor
from modalkit.simulator.bodies.images import Images, all_corners, images
from modalkit.simulator.bodies.plate.panel_slip import slip_gram

_PANELS = 28, 16


@dataclass(frozen=True, eq=False)
class Wetted:
    """A plate's surface in a fluid.

    Parameters
    ----------
    places : (n, 2) array
        Where the plate's velocity counts, within its edges [m].
    matrix : (n, n) array
        Added mass between these places for unit density: symmetric, positive definite [m3].
    jump : (n, n) array
        Jump of potential over a panel for unit velocity of another [m].
    gram_matrices : two arrays
        What integrates the squared slope of the jump along x, as factors along x and across [1/m], [m].
    turned : two arrays
        Likewise its slope along y [m], [1/m].
    """

    places: FloatArray
    matrix: FloatArray
    jump: FloatArray
    gram_matrices: tuple[FloatArray, FloatArray]
    turned: tuple[FloatArray, FloatArray]

    def slip(self, velocity: FloatArray) -> FloatArray:
        """Return the product of the speeds of flow along both faces, integrated over them.

        Parameters
        ----------
        velocity : (n, n_modes) array
            Of the places in some modes [m/s].

        Returns
        -------
        (n_modes, n_modes) array
            The potential is half its jump on either side [m4/s2].
        """
        jump = (self.jump @ velocity).reshape(len(self.gram_matrices[0]), len(self.gram_matrices[1]), -1)
        whole = np.zeros((velocity.shape[1],) * 2)
        for along, across in (self.gram_matrices, self.turned):
            whole += np.einsum(
                "ijr,ijs->rs", jump, np.einsum("ik,kls,jl->ijs", along, jump, across, optimize=True)
            )
        return 0.5 * whole


@lru_cache(maxsize=32)
def _lattice(
    length: float, width: float, wall: bool, along: int, across: int, tank: tuple[float, float]
) -> tuple[FloatArray, ...]:
    """Return panel edges and collocation points along both sides, and the inverse of the influences [m]."""
    edge_x, x = _cosine(length, along, half=wall)
    edge_y, y = _cosine(width, across, half=False)
    mirrored = images(*tank)
    influence = _velocity(x, edge_x, y, edge_y, mirrored)
    if wall:
        influence = influence + _velocity(-x, edge_x, y, edge_y, mirrored)
    return tuple(frozen_array(a) for a in (edge_x, edge_y, x, y, np.linalg.inv(influence)))


def _velocity(
    x: FloatArray, edge_x: FloatArray, y: FloatArray, edge_y: FloatArray, mirrored: Images
) -> FloatArray:
    """Return the normal velocity at points that panels of unit strength induce [1/m]."""
    dx = (x[:, None] - edge_x)[:, None, :, None]
    dy = (y[:, None] - edge_y)[None, :, None, :]
    corner = all_corners(dx, dy, mirrored)
    panel = np.diff(np.diff(corner, axis=2), axis=3) / (4 * np.pi)
    return np.asarray(panel.reshape(len(x) * len(y), -1))


def _cosine(length: float, count: int, *, half: bool) -> tuple[FloatArray, FloatArray]:
    """Return edges and collocation points, even in the angle; ``half`` has no open edge at its start [m]."""
    step = np.pi / count / (2 if half else 1)
    angles = np.arange(count + 1) * step, (np.arange(count) + 0.5) * step
    edges, points = (length * np.sin(a) if half else 0.5 * length * (1 - np.cos(a)) for a in angles)
    return edges, points


def wetted(
    along: tuple[float, float],
    across: tuple[float, float],
    thickness: float,
    *,
    wall: bool = False,
    tank: tuple[float, float] = (np.inf, np.inf),
    panels: tuple[int, int] = _PANELS,
) -> Wetted:
    """Return what an ideal fluid of unit density does on both faces of a plate.

    Parameters
    ----------
    along, across : (low, high)
        The plate's edges [m].
    thickness : float
        Of the plate, not zero [m].
    wall : bool
        Whether the low edge along x stands at an endless wall.
    tank : (surface, bottom)
        Their distances from the faces, above and below [m].
    panels : (along, across)
        Panels [-].

    Returns
    -------
    Wetted
        Added mass and flow between places on the plate.
    """
    short = min(along[1] - along[0], across[1] - across[0])
    reach = edge_reach(short, thickness)
    low_x = along[0] - (0.0 if wall else reach)
    low_y = across[0] - reach
    size = along[1] + reach - low_x, across[1] + reach - low_y
    distances = tuple(round(far + 0.5 * thickness, 9) for far in tank)
    edge_x, edge_y, x, y, jump = _lattice(round(size[0], 9), round(size[1], 9), wall, *panels, distances)
    area = np.outer(np.diff(edge_x), np.diff(edge_y)).reshape(-1, 1)
    matrix = area * jump
    px, py = np.meshgrid(np.clip(low_x + x, *along), np.clip(low_y + y, *across), indexing="ij")
    places = np.column_stack([px.ravel(), py.ravel()])
    blunt = blunt_edge(short, thickness)
    return Wetted(
        places,
        0.5 * (matrix + matrix.T),
        jump,
        (slip_gram(size[0], panels[0], blunt, half=wall), np.diag(np.diff(edge_y))),
        (np.diag(np.diff(edge_x)), slip_gram(size[1], panels[1], blunt, half=False)),
    )


def edge_reach(width: float, thickness: float) -> float:
    """Return how far an edge of a flat strip has to reach beyond that of a thick one [m]."""
    return float(0.5 * width * (np.sqrt(thickness_factor(thickness / width)) - 1.0))


def blunt_edge(width: float, thickness: float) -> float:
    """Return where to stop short of a flat strip's edge so that fluid slips along it as along a thick one [m].

    Along both faces of a strip of half-width a that moves at unit speed the squared slip 2 x^2 / (a^2 - x^2)
    integrates to 2 a ln(2 a / cut) - 4 a for small cuts.
    """
    reached = width + 2 * edge_reach(width, thickness)
    return float(reached * np.exp(-2.0 - slip_factor(thickness / width) * width / reached))
