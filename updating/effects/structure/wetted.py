"""What of a structure is wet, and the inertia of the fluid around it, wherever its surface and its bottom are."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Values
from updating.environment import Environment
from updating.fluid import (
    AddedMassOperator,
    FluidDomain,
    TankTable,
    energy_matrix,
    quadrature_grid,
    unbounded,
)
from updating.models.spec import Spec
from updating.prediction.predict import Predictor

COUPLES = "a fluid's pressure, which couples every point to every other"
"""Why full matrices, which are sparse, take no fluid."""

DISTANCES = ("free_surface", "bottom")
"""What of the surroundings is a parameter where a study does not state it."""

OPEN = (-math.inf, math.inf, -math.inf, math.inf)
"""Walls of a fluid that has none [m]."""


def unstated(around: Environment) -> tuple[str, ...]:
    """Return which distances a study does not state."""
    return tuple(name for name in DISTANCES if getattr(around, name) is None)


def shorter_side(spec: Spec) -> float:
    """Return the side over which distances count [m]."""
    return min(spec.length, spec.width)


def surroundings(predictor: Predictor, values: Values) -> Environment:
    """Return what bounds the fluid: as an effect's values say, and where they do not, the study."""
    around = predictor.environment
    far = {name: values[name] for name in DISTANCES if math.isfinite(values.get(name, math.inf))}
    return replace(
        around,
        free_surface=far.get("free_surface", around.free_surface),
        bottom=far.get("bottom", around.bottom),
    )


def unit_mass(predictor: Predictor, around: Environment | None = None) -> FloatArray:
    """Return the added mass of a fluid of unit density in the reduced basis, (r, r) [m^3 in w].

    Parameters
    ----------
    predictor : Predictor
        The structure.
    around : Environment, optional
        Surface and bottom elsewhere than where the study has them, or where it has none; other walls.
    """
    stated = predictor.environment
    around = stated if around is None else around
    if all(getattr(around, name) == getattr(stated, name) for name in DISTANCES):
        return predictor.once(("fluid", around.walls), lambda: mass_within(predictor, around))
    table = _table(predictor, replace(stated, walls=around.walls))
    distances = unbounded(around.free_surface), unbounded(around.bottom)
    return table.matrix(*distances) if table.knows(*distances) else mass_within(predictor, around)


def at_a_wall(predictor: Predictor) -> bool:
    """Return whether the structure is taken to stand at a wall because it is clamped along one edge alone."""
    return predictor.environment.walls is None and len(predictor.spec.clamped) == 1


def _table(predictor: Predictor, stated: Environment) -> TankTable:
    """Return the added mass for all distances that the surroundings do not state, kept with the structure."""
    predictor.reduced.refuse_whole(COUPLES)
    kept = predictor.reduced.kept
    stretch = predictor.base.factors.get("length", 1.0)
    key = ("tank", stated.free_surface, stated.bottom, stated.walls, stretch)
    if key not in kept:
        wet, free = wetted(predictor, stated), unstated(stated)
        flow = wet.operator(wet.thickness)
        loads = flow.loads(wet.shapes, wet.x, wet.y)

        def solve(surface: float | None, bottom: float | None) -> FloatArray:
            around = replace(
                wet.domain,
                free_surface=surface if "free_surface" in free else stated.free_surface,
                bottom=bottom if "bottom" in free else stated.bottom,
            )
            return energy_matrix(flow.along, flow.across, around, wet.thickness, loads)

        variable = {"surface": "free_surface" in free, "bottom": "bottom" in free}
        kept[key] = TankTable.build(solve, shorter_side(predictor.spec), **variable)
    table: TankTable = kept[key]
    return table


def mass_within(predictor: Predictor, around: Environment, *, thickness: float | None = None) -> FloatArray:
    """Return the same for given surroundings.

    Parameters
    ----------
    predictor : Predictor
        The structure.
    around : Environment
        Free surface, bottom and walls.
    thickness : float, optional
        Thickness that the fluid meets, in place of the structure's; zero is a thin plate [m].

    Returns
    -------
    (r, r) array [m^3 in w]
    """
    wet = wetted(predictor, around)
    operator = wet.operator(wet.thickness if thickness is None else thickness)
    return operator.matrix(wet.shapes, wet.x, wet.y)


@dataclass(frozen=True, eq=False)
class Wetted:
    """The part of the structure that the fluid touches, in axes that begin at its edges."""

    length: float
    width: float
    thickness: float
    domain: FluidDomain
    x: FloatArray
    y: FloatArray
    shapes: FloatArray

    def operator(self, thickness: float) -> AddedMassOperator:
        """Return the flow around it, for a thickness in place of its own; zero is a thin plate [m]."""
        return AddedMassOperator.build(
            length=self.length, width=self.width, thickness=thickness, domain=self.domain
        )


def _domain(spec: Spec, around: Environment) -> FluidDomain:
    """Return what bounds the fluid. Where no walls are stated, the one clamped edge stands at a wall of its own.

    A clamp is a body through which nothing flows. Of several clamped edges nothing of the kind is assumed.
    """
    walls, free = around.walls, float("inf")
    if walls is None and len(spec.clamped) == 1:
        low, high = {"x": (0.0, spec.length), "y": (0.0, spec.width)}[spec.clamped[0][0]]
        sides = [(-free, free), (-free, free)]
        sides["xy".index(spec.clamped[0][0])] = (low, free) if spec.clamped[0][1] == "0" else (-free, high)
        walls = (*sides[0], *sides[1])
    return FluidDomain(around.free_surface, around.bottom, walls)


def wetted(predictor: Predictor, around: Environment) -> Wetted:
    """Return what is wet, and the shapes of the reduced basis there, (r, nx, ny).

    A structure that an accepted ``length`` makes longer bends inside its clamps, where no fluid is; a shorter
    one ends where it ends.
    """
    predictor.reduced.refuse_whole(COUPLES)
    spec = predictor.spec
    stretch = predictor.base.factors.get("length", 1.0)
    start = -predictor.stretch.growths[0] * (stretch - 1.0)
    end = start + spec.length * stretch
    low = max(start, 0.0) if "x0" in spec.clamped else start
    high = min(end, spec.length) if "x1" in spec.clamped else end
    x, y = quadrature_grid(high - low, spec.width, 24)
    aside = 0.5 * spec.width if spec.kind == "beam" else 0.0
    walls = _domain(spec, around).shifted(aside, dx=-low)
    along = (x + low - start) / stretch
    if spec.kind == "beam":
        y = np.array([0.0, spec.width])
        shapes = np.repeat(predictor.reduced.rows(along[:, None])["w"].T[:, :, None], 2, axis=2)
    else:
        points = np.stack(np.meshgrid(along, y, indexing="ij"), axis=-1).reshape(-1, 2)
        shapes = predictor.reduced.rows(points)["w"].T.reshape(-1, len(x), len(y))
    return Wetted(high - low, spec.width, spec.thickness, walls, x, y, shapes)
