"""What holds the structure beside its clamps: a stop, a cable, a stinger, an elastic foundation, a dashpot."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from acquisition.arrays import BoolArray, FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant, bending_stiffness, total_mass
from updating.effects.box import AXES, Place, outline, place, spread, starting_places, where_alike
from updating.effects.mechanism import Channel, Size
from updating.effects.obstacles import Obstacle, damping_obstacle
from updating.effects.regions import WAYS, centre_of, on_basis, one_of, way
from updating.effects.structure.attachment import Attachment, attachment_of, with_spring
from updating.effects.structure.nodes import (
    NAMED_SHARE,
    distinct,
    distinct_groups,
    free_nodes,
    group_centres,
    without_places,
)
from updating.effects.structure.screening import TRIED, promising_nodes
from updating.models.fields import Sparse
from updating.models.imported.matrices import Imported
from updating.models.spec import Spec
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

STIFFNESS = (0.1, 2e4)
"""Range of a spring's stiffness over the structure's own E I / L^3: one that moves the lowest mode by a tenth of a per
cent, and a stop [-]."""

LOSSY = (1e-4, 3.0)
"""Range of a dashpot over M omega of the lowest mode: at a cantilever's tip it damps that by 2 c / M omega, a hardly
visible 0.02 %, and all but holds the tip at the upper end [-]."""

SLIPS = 0.1
"""How far what touches a structure leaves its damping in doubt: it rubs and slips, and is no dashpot, 1 sigma [-]."""

SIZES = 9
"""So many stiffnesses at a place of imported matrices are starts, three in two decades: the search begins at the best
of them, and from one ten times as stiff it ends where modes have changed places. Doubled: twice the time of a first
look."""

SHORTEST = 0.03
"""Shortest stretch that differs from a point, of the length [-]."""

SAME = 1e-6
"""So near to a test point, of the length, a place is that point [-]."""


class GroundSpring(Effect):
    """Springs and dashpots to the ground, at a point or evenly over a stretch, or over a square of a plate.

    ``stiffness`` and ``damping`` are those of all together; a stretch stays on the structure. Of imported matrices a
    spring acts at one of the test's points, in the directions in which that is measured, at a node set ``at`` ``along``
    an axis, or at another node along an axis.
    """

    name = "ground_spring"
    channel = "stiffness"
    summary = (
        "Something holds the structure beside its clamps: a stop, a cable, a stinger, an elastic foundation."
    )
    keeps_clamps = True
    footprint = (
        "Frequencies rise, the lowest most, in the modes that move at the place; damping rises there, too."
    )
    phrase = "a spring to the ground"
    models = ("beam", "plate", "matrices")
    equivalent_to = ("axial_load", "suspension")
    named = ("at", "along")
    screened = MappingProxyType({"extent": (0.1, 0.6), "damping": (0.5,)})
    repeats = True
    separated_by = (
        "find what touches the structure there and remove it; or measure more points around the place"
    )
    undone_by = frozenset({"unclamped"})
    fidelity = 0.03
    damping_doubt = SLIPS

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, extent, stiffness and damping."""
        spec = predictor.spec
        low, high = (share * own_stiffness(predictor) for share in STIFFNESS)
        held = "from the softest cable that repeated tests detect to a stop"
        why = "a longer one is the whole structure; a spring at a point is compared separately"
        size = max(spec.length, spec.width) if spec.kind == "plate" else spec.length
        lossy = "from hardly detectable to a dashpot that all but holds the lowest mode"
        extent = SHORTEST * spec.length, size
        least, most = (share * total_mass(spec) * lowest(predictor) for share in LOSSY)
        return (
            *outline(predictor),
            Parameter("extent", "m", *extent, why, log=True, default=0.0, natural=EDGES, or_none=True),
            Parameter("stiffness", "N/m", low, high, held, log=True, or_none=True),
            Parameter(
                "damping", "N s/m", least, most, lossy, log=True, default=0.0, natural=("low",), or_none=True
            ),
        )

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need places: on imported matrices, the points of the test."""
        return without_places(predictor, "a spring might act")

    def damps(self, parameter: str = "") -> bool:
        """State that the dashpots do, and nothing else."""
        return parameter == "damping"

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return a dashpot alone, a point, and a stretch; without any damping where none can be compared."""
        point, still = {"extent": 0.0}, {"damping": 0.0}
        shares: list[tuple[dict[str, Any], float]] = [
            (point | {"stiffness": 0.0}, 0.1),
            (point, 0.55),
            ({}, 0.35),
        ]
        if damping_obstacle(predictor) is not None:
            shares = [(point | still, 0.6), (still, 0.4)]
        if predictor.spec.kind != "matrices":
            return tuple(Variant(fixed, share) for fixed, share in shares)
        alone = [(fixed, share) for fixed, share in shares if fixed.get("extent") == 0.0]
        whole = sum(share for _, share in alone)
        places = self._on_nodes(predictor)
        return tuple(
            Variant({**at, **fixed}, of * share / whole) for fixed, share in alone for at, of in places
        )

    def _on_nodes(self, predictor: Predictor) -> list[tuple[dict[str, Any], float]]:
        """Return places on imported matrices: test points, node sets, the most promising nodes; and their shares."""
        imported = predictor.spec.imported
        assert imported is not None
        known = [*_at_points(predictor), *_at_sets(predictor)]
        stiffness = next(p for p in self.parameters(predictor) if p.name == "stiffness")
        others = free_nodes(imported, group_centres(imported))
        sizes = [stiffness.value(u) for u in TRIED]
        along = _along_no_other(predictor, imported.places.at[others])
        best = promising_nodes(predictor, imported, others, with_spring, sizes, along)
        share = NAMED_SHARE if along.any() else 1.0
        each = (1 - share) / max(int(along.sum()), 1)
        return [
            *((at, share / len(known)) for at in known),
            *(({**node, "along": WAYS[axis]}, each) for node, axis in best),
        ]

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of places and the ends, with a middling spring that hardly damps.

        On imported matrices, where each place is a form of its own, from sizes over the whole range: above the one that
        fits, modes have changed places and the likelihood has maxima of its own.
        """
        spec = predictor.spec
        if spec.kind == "matrices":
            return tuple((0.5, 0.5, 0.5, 0.5, u, 0.2 + 0.4 * u) for u in np.linspace(0.06, 0.94, SIZES))
        ends = ((0.98,),) if spec.kind == "beam" else ((0.98, 0.02), (0.98, 0.98))
        return tuple((*where, 0.6, 0.5, 0.5) for where in (*starting_places(spec), *ends))

    def settled(self, predictor: Predictor, values: Values) -> Values:
        """Return the values with the stretch moved, in proportion, to where all of it is on the structure."""
        spec = predictor.spec
        if not spec.outlined:
            return values
        settled = dict(values)
        for name, size in _sides(spec):
            half = min(values["extent"], size) / 2
            settled[name] = half + values[name] / size * (size - 2 * half)
        return settled

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with springs and dashpots."""
        stiffness, damping = values.get("stiffness", 0.0), values.get("damping", 0.0)
        imported = predictor.spec.imported
        if imported is not None and "at" not in values:
            return with_spring(_attachment(predictor, imported, values), stiffness, damping)
        unit = _unit(predictor, values)
        return State(
            stiffness=(stiffness * unit,) if stiffness else (),
            losses=(Loss(damping * unit),) if damping else (),
        )

    def acts_in(self, predictor: Predictor, values: Values) -> Channel:
        """Return damping where there are dashpots alone."""
        return self.channel if values.get("stiffness") else "damping"

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the stiffness of all springs together, of dashpots alone theirs."""
        if values.get("stiffness"):
            return (Size("stiffness to the ground", float(values["stiffness"]), "N/m"),)
        return (Size("damping to the ground", float(values.get("damping", 0.0)), "N s/m"),)

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the middle; where no shapes separate it from its mirror images, these too."""
        if "at" in values:
            assert predictor.spec.imported is not None
            return (centre_of(one_of(predictor.spec.imported.groups, values, "at")),)
        at = (*place(values)[:2], float(values.get("z", 0.0)))
        return where_alike(predictor, at)


def _at_points(predictor: Predictor) -> list[dict[str, Any]]:
    """Return the test points at which a spring may act."""
    imported = predictor.spec.imported
    assert imported is not None
    points = np.unique(predictor.measured.points, axis=0)
    unlike = points[distinct(imported, points, group_centres(imported))]
    return [dict(zip(AXES, map(float, at), strict=True)) for at in unlike]


def _along_no_other(predictor: Predictor, places: FloatArray) -> BoolArray:
    """Return along which axes a spring at places (n, 3) [m] is no other form already, (3, n).

    At a test point that is measured along one axis, a spring in the directions measured is one along that axis.
    """
    found = np.ones((3, len(places)), dtype=bool)
    points = np.unique(predictor.measured.points, axis=0).reshape(-1, 3)
    if not len(points):
        return found
    away, index = (np.asarray(each) for each in KDTree(points).query(places))
    for i in np.flatnonzero(away <= SAME * predictor.spec.length):
        axes = np.abs(measured_directions(predictor, points[index[[i]]])) > 1 - SAME
        found[:, i] = ~axes.all(axis=0)
    return found


def _at_sets(predictor: Predictor) -> list[dict[str, Any]]:
    """Return the node sets at which a spring may act, and along what."""
    imported = predictor.spec.imported
    assert imported is not None
    return [
        {**dict(zip(AXES, centre_of(group), strict=True)), "at": group.name, "along": WAYS[axis]}
        for group in distinct_groups(imported)
        for axis in range(3)
        if group.moves(axis)
    ]


def own_stiffness(predictor: Predictor) -> float:
    """Return the natural unit of springs across the structure, E I / L^3 [N/m].

    Of imported matrices, whose section is not known, from the lowest mode as if it were a cantilever's: M omega^2 /
    3.516^2.
    """
    spec = predictor.spec
    if not spec.outlined:
        return total_mass(spec) * lowest(predictor) ** 2 / 3.516**2
    wide = spec.width if spec.kind == "plate" else 1.0
    return bending_stiffness(spec) * wide / spec.length**3


def lowest(predictor: Predictor) -> float:
    """Return the angular frequency of the bare model's lowest elastic mode [rad/s]."""
    found = predictor.once("lowest", lambda: predictor.bare.predict(count=1).frequency)
    return 2 * np.pi * float(found[0])


def springs(
    predictor: Predictor, points: FloatArray, shares: FloatArray, directions: FloatArray | None = None
) -> FloatArray:
    """Return the stiffness of springs to the ground, 1 N/m each times its share, shape (r, r) [N/m].

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    points : (n, dim) array
        Where they act [m].
    shares : (n,) array
        Their stiffness [N/m].
    directions : (n, 3) array, optional
        Along which; left out, z.
    """
    rows = predictor.reduced.rows(points, directions)["w"] * np.sqrt(shares)[:, None]
    unit: FloatArray = rows.T @ rows
    return unit


def _unit(predictor: Predictor, values: Values) -> FloatArray:
    """Return the stiffness of 1 N/m in all, shape (r, r) [N/m]."""
    spec = predictor.spec
    if spec.imported is not None and "at" in values:
        row = one_of(spec.imported.groups, values, "at").rows[way(values, "along")]
        return on_basis(predictor, ("springs", values["at"], values["along"]), lambda: Sparse(row.T @ row))
    if not values.get("extent"):
        return springs(predictor, np.array([[values[name] for name, _ in _sides(spec)]]), np.ones(1))
    points, weights = spread(spec, values)
    return springs(predictor, points, weights / weights.sum())


def _attachment(predictor: Predictor, imported: Imported, values: Values) -> Attachment:
    """Return a place on imported matrices, ``along`` an axis or as that is measured."""
    at = np.array([[values[name] for name in AXES]])
    directions = (
        np.eye(3)[[way(values, "along")]] if "along" in values else measured_directions(predictor, at)
    )

    def motions() -> Sparse:
        return imported.places.rows(np.repeat(at, len(directions), axis=0), directions)["w"]

    return attachment_of(predictor, ("spring", *at[0].tolist(), *directions.ravel().tolist()), motions)


def _sides(spec: Spec) -> list[tuple[str, float]]:
    """Return the axes along which there are places, and how far they reach [m]."""
    return list(zip(AXES, (spec.length, spec.width)[: spec.dim], strict=False))


def measured_directions(predictor: Predictor, at: FloatArray) -> FloatArray:
    """Return in which directions a place (1, 3) on imported matrices is measured, z where it is not, (n, 3) [-]."""
    test = predictor.measured
    here = np.linalg.norm(test.points - at, axis=1) <= SAME * predictor.spec.length
    if test.directions is None or not here.any():
        return np.array([[0.0, 0.0, 1.0]])
    return np.unique(test.directions[here], axis=0)
