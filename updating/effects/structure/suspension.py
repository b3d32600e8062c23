"""The cords of a free test, that hold and damp what the model has free."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant, total_mass
from updating.effects.box import Place
from updating.effects.obstacles import Lack, Obstacle, damping_obstacle
from updating.effects.structure.spring import LOSSY, SLIPS, lowest, springs
from updating.models.spec import Spec
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

BOUNCE = (0.03, 0.7)
"""Range of the frequency at which the whole bounces on its cords, over the first elastic one: at the lower end it
shifts that by some 0.1 %, at the upper one nobody takes the specimen to be free [-]."""

FARTHEST_IN = 0.35
"""How far from the edges the outer cords are at most, of the side: beyond the nodes of the first mode, 0.224 [-]."""

CORDS = {"beam": ((2, 0.6), (3, 0.15), (4, 0.25)), "plate": ((4, 0.5), (2, 0.3), (3, 0.2))}
"""Number of cords and its share of the prior: a beam mostly hangs on two, a plate lies on four [-]."""

CORNERS = ((0, 0), (1, 1), (0, 1), (1, 0))
"""Corners of a plate in the order in which cords take them: two hold it across a diagonal."""


class Suspension(Effect):
    """Springs and dashpots where cords hold a free specimen: evenly along a beam, at the corners of a plate.

    ``stiffness`` and ``damping`` are those of each cord, across the structure; the outer ones are ``inset`` from the
    edges, as a share of each side.
    """

    name = "suspension"
    channel = "stiffness"
    summary = "The cords on which the specimen hangs hold and damp it."
    footprint = "Frequencies rise and damping, the lowest modes most, and hardly where cords sit at nodes."
    phrase = "the cords of the suspension"
    equivalent_to = ("ground_spring",)
    separated_by = "the same test on softer cords, or with the cords at other places"
    fidelity = 0.03
    damping_doubt = SLIPS
    elsewhere = MappingProxyType(
        {"matrices": "imported matrices do not say where cords may be; ground_spring is tried at the points"}
    )

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return stiffness and damping of a cord, and where they are."""
        mass = total_mass(predictor.spec)
        first = lowest(predictor)
        low, high = (mass * (share * first) ** 2 / n for share, n in zip(BOUNCE, (4, 2), strict=True))
        least, most = (share * mass * first / n for share, n in zip(LOSSY, (4, 2), strict=True))
        usual = float(CORDS["plate" if predictor.spec.kind == "plate" else "beam"][0][0])
        held = f"from a bounce at {BOUNCE[0]:g} of the first elastic frequency to one at {BOUNCE[1]:g}"
        lossy = "from hardly anything to be seen to cords on which nothing bounces twice"
        return (
            Parameter("stiffness", "N/m", low, high, held, log=True),
            Parameter("damping", "N s/m", least, most, lossy, True, 0.0, ("low",), or_none=True),
            Parameter(
                "inset", "-", 0.0, FARTHEST_IN, "from the ends to beyond the first nodes", False, 0.1, EDGES
            ),
            Parameter("cords", "-", 2.0, 4.0, "as a specimen is hung up by hand", False, usual, EDGES),
        )

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need a specimen that hangs free."""
        if not predictor.spec.clamped:
            return None
        return Obstacle(
            Lack.MODEL, "the model is clamped: it hangs on no cords; ground_spring holds it beside clamps"
        )

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return how many cords there are."""
        return {"number": (float(round(values.get("cords", 2))), "-")}

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return each number of cords; without damping where none can be compared."""
        still = {} if damping_obstacle(predictor) is None else {"damping": 0.0}
        return tuple(Variant({"cords": float(n), **still}, share) for n, share in CORDS[predictor.spec.kind])

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from cords at the ends, at the nodes and inside them."""
        return tuple((0.6, 0.5, inset, 0.5) for inset in (0.1, 0.5, 0.9))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure on its cords."""
        points = cord_places(predictor.spec, round(values.get("cords", 2)), values.get("inset", 0.1))
        unit = springs(predictor, points, np.ones(len(points)))
        damping = values.get("damping", 0.0)
        return State(
            stiffness=(values["stiffness"] * unit,), losses=(Loss(damping * unit),) if damping else ()
        )

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return where the cords are."""
        points = cord_places(predictor.spec, round(values["cords"]), values["inset"])
        return tuple((float(p[0]), float(p[1]) if len(p) > 1 else 0.0, 0.0) for p in points)


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
