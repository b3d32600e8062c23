"""The cords of a free test, that hold and damp what the model has free."""

from __future__ import annotations

from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant, total_mass
from updating.effects.box import Place
from updating.effects.obstacles import Lack, Obstacle, damping_obstacle
from updating.effects.regions import WAYS, on_basis, one_of, way
from updating.effects.structure.clamp_edges import ALL
from updating.effects.structure.spring import LOSSY, SLIPS, lowest, springs
from updating.models.fields import Sparse
from updating.models.imported.cords import Cords
from updating.models.spec import Spec
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

BOUNCE = (0.03, 0.7)
"""Range of the frequency at which the whole bounces on its cords, over the first elastic one: at the lower end it
shifts that by some 0.1 %, at the upper one the specimen is no longer taken to be free [-]."""

FARTHEST_IN = 0.35
"""How far from the edges the outer cords are at most, of the side: beyond the nodes of the first mode, 0.224 [-]."""

CORDS = {"beam": ((2, 0.6), (3, 0.15), (4, 0.25)), "plate": ((4, 0.5), (2, 0.3), (3, 0.2))}
"""Number of cords and its share of the prior: a beam mostly hangs on two, a plate lies on four [-]."""

NAMED_SHARE = 0.6
"""Prior share of the cords that node sets name, the rest that of ends and corners of a structure given by matrices [-]:
judged. Doubled, cords are only where they are stated."""

EVERY_WAY = 0.3
"""Prior share of what holds alike in all directions, foam or rubber, as against cords, which hold along themselves [-]:
judged. Doubled, they are as common as each other."""

CORNERS = ((0, 0), (1, 1), (0, 1), (1, 0))
"""Corners of a plate in the order in which cords take them: two hold it across a diagonal."""


HELD = (
    "the model is not free: it is supported, or already contains its cords; give it without cords, or state them as "
    "a region or a hypothesis (springs beside supports are ground_spring)"
)
"""Why a model that has no rigid-body mode hangs on no cords that are missing in it."""

NOWHERE = "the node table has no place for cords: neither ends that can move along an axis, nor node sets"
"""Why a free model hangs nowhere."""


class Suspension(Effect):
    """Springs and dashpots where cords hold a free specimen: evenly along a beam, at the corners of a plate.

    ``stiffness`` and ``damping`` are those of each cord, across the structure; the outer ones are ``inset`` from the
    edges, as a share of each side. Of imported matrices they hold ``at`` node sets, at both ends, or at the corners,
    ``along`` an axis or in all directions.
    """

    name = "suspension"
    channel = "stiffness"
    summary = "The cords on which the specimen hangs hold and damp it."
    footprint = "Frequencies and damping rise, in the lowest modes most, and hardly where cords sit at nodes of a mode."
    phrase = "the cords of the suspension"
    models = ("beam", "plate", "matrices")
    named = ("at", "along")
    equivalent_to = ("ground_spring",)
    separated_by = "the same test on softer cords, or with the cords at other places"
    fidelity = 0.03
    damping_doubt = SLIPS

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return stiffness and damping of a cord, and where they are."""
        mass = total_mass(predictor.spec)
        first = lowest(predictor)
        counts = _counts(predictor)
        low, high = (_cord(predictor, share, n) for share, n in zip(BOUNCE, counts, strict=True))
        least, most = (share * mass * first / n for share, n in zip(LOSSY, counts, strict=True))
        held = f"from a bounce at {BOUNCE[0]:g} of the first elastic frequency to one at {BOUNCE[1]:g}"
        lossy = "from hardly detectable to cords so damped that the specimen does not bounce twice"
        sizes = (
            Parameter("stiffness", "N/m", low, high, held, log=True),
            Parameter(
                "damping", "N s/m", least, most, lossy, log=True, default=0.0, natural=("low",), or_none=True
            ),
        )
        if predictor.spec.kind == "matrices":
            return sizes
        usual = float(CORDS[predictor.spec.kind][0][0])
        return (
            *sizes,
            Parameter(
                "inset",
                "-",
                0.0,
                FARTHEST_IN,
                "from the ends to beyond the first nodes",
                log=False,
                default=0.1,
                natural=EDGES,
            ),
            Parameter(
                "cords",
                "-",
                2.0,
                4.0,
                "as a specimen is hung up by hand",
                log=False,
                default=usual,
                natural=EDGES,
            ),
        )

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need a specimen that hangs free."""
        if predictor.spec.imported is not None:
            if not predictor.reduced.structure.rigid_modes:
                return Obstacle(Lack.MODEL, HELD)
            return None if _ways(predictor) else Obstacle(Lack.MODEL, NOWHERE)
        if not predictor.spec.clamped:
            return None
        return Obstacle(
            Lack.MODEL,
            "the model is clamped and does not hang on cords (springs beside clamps are ground_spring)",
        )

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return how many cords there are."""
        if predictor.spec.imported is not None:
            return {"number": (float(len(_cords(predictor, values).places)), "-")}
        return {"number": (float(round(values.get("cords", 2))), "-")}

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return each number of cords, of imported matrices each place; without damping where none can be compared."""
        still = {} if damping_obstacle(predictor) is None else {"damping": 0.0}
        if predictor.spec.imported is not None:
            return tuple(
                Variant({**form, **still}, share, self._window(predictor, len(cords.places)))
                for cords, form, share in _ways(predictor)
            )
        return tuple(Variant({"cords": float(n), **still}, share) for n, share in CORDS[predictor.spec.kind])

    def _window(self, predictor: Predictor, count: int) -> dict[str, tuple[float, float]]:
        """Return the quantiles of the stiffness between which the whole bounces as a suspension does on so many."""
        stiffness = self.parameters(predictor)[0]
        low, high = (stiffness.coordinate(_cord(predictor, share, count)) for share in BOUNCE)
        return {"stiffness": (low, high)}

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from cords at the ends, at the nodes and inside them."""
        if predictor.spec.imported is not None:
            return tuple((u, 0.2 + 0.4 * u) for u in (0.2, 0.35, 0.5, 0.65, 0.8))
        return tuple((0.6, 0.5, inset, 0.5) for inset in (0.1, 0.5, 0.9))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure on its cords."""
        build = _across if predictor.spec.imported is None else _on_matrices
        unit = build(predictor, values)
        damping = values.get("damping", 0.0)
        return State(
            stiffness=(values["stiffness"] * unit,), losses=(Loss(damping * unit),) if damping else ()
        )

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return where the cords are."""
        if predictor.spec.imported is not None:
            return tuple((float(x), float(y), float(z)) for x, y, z in _cords(predictor, values).places)
        points = cord_places(predictor.spec, round(values["cords"]), values["inset"])
        return tuple((float(p[0]), float(p[1]) if len(p) > 1 else 0.0, 0.0) for p in points)


def _counts(predictor: Predictor) -> tuple[int, int]:
    """Return how many cords there are at most and at least."""
    if predictor.spec.imported is None:
        return 4, 2
    counts = [len(cords.places) for cords in predictor.spec.imported.cords]
    return max(counts, default=2), min(counts, default=2)


def _cord(predictor: Predictor, share: float, count: int) -> float:
    """Return the stiffness of each of some cords on which the whole bounces at a share of the lowest mode [N/m]."""
    return total_mass(predictor.spec) * (share * lowest(predictor)) ** 2 / count


def _across(predictor: Predictor, values: Values) -> FloatArray:
    """Return the stiffness of cords of 1 N/m each across a beam or a plate, (r, r) [N/m]."""
    points = cord_places(predictor.spec, round(values.get("cords", 2)), values.get("inset", 0.1))
    return springs(predictor, points, np.ones(len(points)))


def _cords(predictor: Predictor, values: Values) -> Cords:
    """Return the suspension of imported matrices that is meant."""
    assert predictor.spec.imported is not None
    return one_of(predictor.spec.imported.cords, values, "at")


def _on_matrices(predictor: Predictor, values: Values) -> FloatArray:
    """Return the stiffness of cords of 1 N/m each on imported matrices, (r, r) [N/m]."""
    cords = _cords(predictor, values)
    axes = range(3) if values.get("along", ALL) == ALL else [way(values, "along")]

    def full() -> Sparse:
        return Sparse(sum(rows.T @ rows for rows in (cords.rows[axis] for axis in axes)))

    return on_basis(predictor, ("cords", cords.name, *axes), full)


def _ways(predictor: Predictor) -> list[tuple[Cords, dict[str, Any], float]]:
    """Return where cords may hold imported matrices, where and along what as a form has it, with its prior share."""
    assert predictor.spec.imported is not None
    every = [(one, [a for a in range(3) if one.moves(a)]) for one in predictor.spec.imported.cords]
    known = [(one, axes) for one, axes in every if axes]
    found: list[tuple[Cords, dict[str, Any], float]] = []
    for one, axes in known:
        alike = sum(other.named == one.named for other, _ in known)
        of_kind = NAMED_SHARE if one.named else 1 - NAMED_SHARE
        share = (of_kind if alike < len(known) else 1.0) / alike
        together = EVERY_WAY if len(axes) > 1 else 0.0
        ways = {WAYS[axis]: (1 - together) / len(axes) for axis in axes} | (
            {ALL: together} if together else {}
        )
        found += [(one, {"at": one.name, "along": along}, share * of) for along, of in ways.items()]
    return found


def cord_places(spec: Spec, count: int, inset: float) -> FloatArray:
    """Return where cords hold: evenly along a beam, near the corners of a plate, (count, dim) [m].

    Parameters
    ----------
    spec : Spec
        The specimen.
    count : int
        Number of cords, on plates four at most.
    inset : float
        How far the outer ones are from the edges, of each side [-].
    """
    if spec.kind == "beam":
        return np.linspace(inset, 1 - inset, count)[:, None] * spec.length
    shares = np.where(np.array(CORNERS[:count]) == 0, inset, 1 - inset)
    return np.asarray(shares * [spec.length, spec.width])
