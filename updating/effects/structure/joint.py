"""A joint between two node sets of imported matrices that gives way, or holds, otherwise than modelled."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values, Variant, total_mass
from updating.effects.box import Place
from updating.effects.mechanism import Size
from updating.effects.obstacles import Lack, Obstacle, damping_obstacle
from updating.effects.regions import centre_of, on_basis, one_of
from updating.effects.structure.spring import LOSSY, SLIPS, lowest, own_stiffness
from updating.models.fields import Sparse
from updating.models.imported.groups import Joint as Sides
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

SOFTEST, STIFFEST = 1e-3, 1e3
"""Range of a joint's stiffness over the modelled one [-]: a bolt that fell out, and one that holds as if welded."""

SOFT_FOR_STRUCTURE = 0.1
"""A joint of this share of the structure's own stiffness holds next to nothing [-]; as soft as that one may be, even
where the model has it tied by springs of a million times that."""

SHARE_SOFTER = 0.7
"""Prior of the softer form [-]: what comes loose is commoner than what was glued and not modelled. Judged; doubled for
the stiffer one it gains ln 2."""

TURNS, SHIFTS, BOTH = 0.4, 0.3, 0.3
"""Prior of a joint that is off in turning alone, in shifting alone, and in both [-]: judged."""

STARTS = (0.25, 0.5, 0.75, 0.93)
"""Quantiles from which a search starts: within the range of a form most are far from what is modelled."""


class Joint(Effect):
    """Springs between the nodes of two sets that are at the same places: bolts, seats, bearings.

    ``stiffness`` [N/m] is that of the joint against shifting, ``turning`` [N m/rad] that against turning, each summed
    over its nodes and the mean of its directions, whose ratios stay as modelled. What is not searched is as modelled.
    """

    name = "joint"
    channel = "stiffness"
    summary = "A joint between two parts is softer (loose) or stiffer than modelled."
    footprint = "Frequencies fall, or rise, in the modes that strain the joint; local modes of the parts do not change."
    phrase = "a joint"
    models = ("matrices",)
    equivalent_to = ("local_stiffness",)
    named = ("joint",)
    repeats = True
    separated_by = "tighten the bolt and repeat the test; or points on both sides of the joint"
    fidelity = 0.03
    damping_doubt = SLIPS

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return stiffness against shifting and turning, and the dashpot across the joint."""
        (low, high), (lowest_turn, highest_turn) = predictor.once(
            "spans of joints", lambda: _spans(predictor)
        ).tolist()
        held = "from a bolt that fell out to a joint that holds as if welded"
        lossy = "from hardly detectable to a dashpot that all but holds the lowest mode"
        least, most = (share * total_mass(predictor.spec) * lowest(predictor) for share in LOSSY)
        return (
            Parameter("stiffness", "N/m", low, high, held, log=True, like="nothing", or_none=True),
            Parameter(
                "turning", "N m/rad", lowest_turn, highest_turn, held, log=True, like="nothing", or_none=True
            ),
            Parameter(
                "damping", "N s/m", least, most, lossy, log=True, default=0.0, natural=("low",), or_none=True
            ),
        )

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need two node sets at one place."""
        if joints_of(predictor):
            return None
        what = "no two node sets have nodes at the same places: name both sides of a joint, each with nodes of its own"
        return Obstacle(Lack.MODEL, what)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return every joint softer and stiffer, in shifting, in turning, and in both."""
        joints = joints_of(predictor)
        return tuple(
            Variant(form.values, form.weight / len(joints), form.within)
            for joint in joints
            for form in self._forms(predictor, joint)
        )

    def _forms(self, predictor: Predictor, joint: Sides) -> Iterator[Variant]:
        """Yield the forms of one joint."""
        names = ("stiffness", "turning")
        there = [bool(springs.nnz) for springs in joint.springs]
        known = {"joint": joint.name, "damping": 0.0, **_modelled(joint)}
        windows = [self._windows(predictor, joint, i) if there[i] else {} for i in range(2)]
        ways = [(SHIFTS, (0,)), (TURNS, (1,)), (BOTH, (0, 1))]
        for share, searched in ways:
            if not all(there[i] for i in searched):
                continue
            for side in ("softer", "stiffer"):
                if all(side in windows[i] for i in searched):
                    fixed = {n: v for n, v in known.items() if n not in {names[i] for i in searched}}
                    within = {names[i]: windows[i][side] for i in searched}
                    yield Variant(
                        fixed, share * (SHARE_SOFTER if side == "softer" else 1 - SHARE_SOFTER), within
                    )
                if (
                    side == "softer"
                    and searched == (0,)
                    and damping_obstacle(predictor) is None
                    and joint.stiffness[0]
                ):
                    yield Variant({"joint": joint.name, **_modelled(joint)}, 0.1 * share)

    def _windows(self, predictor: Predictor, joint: Sides, i: int) -> dict[str, tuple[float, float]]:
        """Return the quantiles of the stiffness in which the joint is softer than modelled, and stiffer."""
        parameter = self.parameters(predictor)[i]
        low, high = (parameter.coordinate(end) for end in _range(predictor, joint, i))
        if not joint.stiffness[i]:
            return {"stiffer": (low, high)}
        middle = parameter.coordinate(joint.stiffness[i])
        return {"softer": (low, middle), "stiffer": (middle, high)}

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a few sizes over the whole range; each form keeps those within its own."""
        return tuple((u, u, 0.5) for u in np.linspace(0.05, 0.95, 13))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the joint's springs in place of the modelled ones."""
        joint = one_of(joints_of(predictor), values, "joint")
        units = [joint_springs(predictor, joint, i) for i in range(2)]
        changes = []
        for unit, (name, own) in zip(units, _modelled(joint).items(), strict=True):
            wanted = float(values.get(name, own))
            if wanted != own:
                changes.append((wanted / own - 1 if own else wanted) * unit)
        damping = float(values.get("damping", 0.0)) / (joint.stiffness[0] or 1.0)
        return State(stiffness=tuple(changes), losses=(Loss(damping * units[0]),) if damping else ())

    def damps(self, parameter: str = "") -> bool:
        """State that the dashpot does, and nothing else."""
        return parameter == "damping"

    def sentence(self, values: Values) -> str:
        """Return which joint."""
        return (
            f"The joint {values['joint']} is not as stiff as modelled." if "joint" in values else self.summary
        )

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return what the joint has of the modelled stiffness, in shifting and in turning, where that is another."""
        joint = one_of(joints_of(predictor), values, "joint")
        names = {"stiffness": "of_modelled", "turning": "of_modelled_turning"}
        return {
            names[name]: (float(values[name]) / own, "-")
            for name, own in _modelled(joint).items()
            if own and name in values and values[name] != own
        }

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return what the joint has of the modelled stiffness, or what is not modelled itself."""
        shares = self.derived(predictor, values)
        of_modelled = tuple(Size(name.replace("_", " "), *share) for name, share in shares.items())
        return of_modelled[:1] or super().sizes(predictor, values)

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the joint."""
        return (centre_of(one_of(joints_of(predictor), values, "joint")),)


def joint_springs(predictor: Predictor, joint: Sides, i: int) -> FloatArray:
    """Return the springs of a joint's translations (0) or rotations (1) on the basis, (r, r) [SI]."""
    return on_basis(predictor, ("joint", joint.name, i), partial(_same, joint.springs[i]))


def _same(springs: Sparse) -> Sparse:
    return springs


def joints_of(predictor: Predictor) -> tuple[Sides, ...]:
    """Return the joints between node sets, none of models that are not imported."""
    imported = predictor.spec.imported
    return () if imported is None else imported.joints


def _modelled(joint: Sides) -> dict[str, Any]:
    return {"stiffness": joint.stiffness[0], "turning": joint.stiffness[1]}


def _range(predictor: Predictor, joint: Sides, i: int) -> tuple[float, float]:
    """Return how soft and how stiff a joint may be in shifting (0) or turning (1) [N/m, N m/rad]."""
    assert predictor.spec.imported is not None
    own = own_stiffness(predictor) * (predictor.spec.imported.reach**2 if i else 1.0)
    modelled = joint.stiffness[i]
    if not modelled:
        return SOFT_FOR_STRUCTURE * own, STIFFEST * own
    return min(SOFTEST * modelled, SOFT_FOR_STRUCTURE * own), STIFFEST * modelled


def _spans(predictor: Predictor) -> FloatArray:
    """Return the widest range of any joint in shifting and in turning, (2, 2) [N/m, N m/rad]."""
    joints = joints_of(predictor)
    return np.array([_span([_range(predictor, joint, i) for joint in joints]) for i in range(2)])


def _span(ranges: list[tuple[float, float]]) -> tuple[float, float]:
    """Return the widest of some ranges, anything where there is no joint."""
    return min((low for low, _ in ranges), default=1.0), max((high for _, high in ranges), default=1e12)
