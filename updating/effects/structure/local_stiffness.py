"""A place softer or stiffer than modelled: a crack, a notch, a loose rivet row; a rib, a weld, a repair."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

from updating.effects.base import EDGES, Parameter, Values
from updating.effects.box import (
    SOFT,
    along_beam,
    extents,
    shares,
    starting_places,
)
from updating.effects.mechanism import INTEGRAL_COMPLIANCE, Size
from updating.effects.regions import regions_meant, stiff_regions
from updating.effects.structure.either_way import EitherWay
from updating.models.soft_stretch import Profile, soft_stretch
from updating.models.softening import softening
from updating.models.state import State
from updating.prediction.predict import Predictor

COMPLIANCE = (5e-4, 0.6)
"""Range of the compliance, the integral of EI0/EI - 1, relative to the length; negative of a stiffer place [-]."""

REGIONAL = (5e-3, 20.0)
"""Range of E0/E - 1 of a region of imported matrices; negative of a stiffer one [-]."""

LOSSES = (-9.0, 0.98)
"""Share of the stiffness lost: from ten times as stiff to nearly severed [-]."""

RIGID = -LOSSES[0] / (1 - LOSSES[0])
"""Largest 1 - EI0/EI of a stiffer place, however little it still gives [-]."""

SIZES = (0.3, 0.65)
"""Quantiles, within a form, of the sizes from which a search starts [-]."""

SHORT = 1 / 3
"""Quantile of the extents from which it starts, a twentieth of the side [-]: what is long is found from there, what is
short hardly from what is long."""


class LocalStiffness(EitherWay):
    """Bending stiffness lost or gained over a stretch of a beam, a rectangle of a plate, or a region of matrices."""

    name = "local_stiffness"
    channel = "stiffness"
    summary = "One place is softer (crack, notch, loose joint) or stiffer (rib, weld, repair) than modelled."
    footprint = (
        "Frequencies fall, or rise, in the modes that bend there; those with no curvature there hardly move."
    )
    equivalent_to = ("clamp_rotation", "joint")
    screened = MappingProxyType({"extent": (SHORT, 0.75)})
    separated_by = "more points around the place, or a visual and dye check there"
    phrase = "a soft or stiff spot"
    fidelity = 0.05  # some 0.03 of a sharp-edged place seen as one with soft edges, 0.02 of the condensation

    among = (0.02, 0.4)  # a third of the side with some room
    why = "a longer one is a region, not a place; a shorter one has the same effect"
    lacking = "the matrices have no stiffness_parts: the stiffness of a place cannot be changed; give one per region"
    upper = 0.7
    """What breaks or comes loose is commoner than what was added and not modelled. Judged; doubled for the stiffer form
    it gains ln 2."""

    def changed(self, predictor: Predictor) -> Parameter:
        """Return the share of the stiffness that is lost."""
        why = "from ten times as stiff, through no change, to nearly severed; uniform in log compliance on either side"
        return Parameter("loss", "-", *LOSSES, why, natural=EDGES)

    def regions(self, predictor: Predictor) -> Sequence[str]:
        """Return those with stiffnesses of their own."""
        return stiff_regions(predictor)

    def size(self, value: float) -> float:
        """Return EI0/EI - 1 [-]."""
        return value / (1 - value)

    def value(self, size: float) -> float:
        """Return the loss of such a compliance, of a stiffer place of such a share of it that is left."""
        return size / (1 + size)

    def size_range(self, predictor: Predictor, values: Values, *, upper: bool) -> tuple[float, float]:
        """Return the range of the size of EI0/EI - 1 [-]."""
        whole = 1.0 if predictor.spec.kind == "matrices" else predictor.spec.length / values["extent"]
        low, high = REGIONAL if predictor.spec.kind == "matrices" else COMPLIANCE
        return low * whole, high * whole if upper else RIGID

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of places, with two losses and two gains at each."""
        losses = [0.5 + side * size / 2 for side in (1, -1) for size in SIZES]
        if predictor.spec.kind == "matrices":
            return tuple((loss,) for loss in losses)
        where, short = starting_places(predictor.spec, along=16), (SHORT,) * predictor.spec.dim
        return tuple((*at, *short, loss) for loss in losses for at in where)

    def sentence(self, values: Values) -> str:
        """Return whether it is softer or stiffer."""
        where = f"{values['region']}" if "region" in values else "One place"
        if values.get("loss", 0.0) < 0:
            return f"{where} is stiffer than modelled (rib, weld, repair)."
        return f"{where} is softer than modelled (crack, notch, loose joint)."

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with its stiffness changed there."""
        if predictor.spec.kind == "matrices":
            left = 1 - values["loss"]
            return State(regional={(i, "E"): left for i in regions_meant(predictor.spec, values)})
        factors = predictor.base.factors
        if predictor.spec.kind == "beam":
            return State(stiffness=(soft_stretch(predictor.reduced, _profile(predictor, values), factors),))
        if predictor.reduced.whole:
            if predictor.reduced.fielded.finer is not predictor.reduced.fielded:
                predictor.reduced.refuse_whole("a soft place on a plate of few elements")
            lost = values["loss"] * shares(predictor.reduced.fielded, values, soft=SOFT)
            return State(stiffness=(-predictor.reduced.weighted("stiffness", lost, factors),))
        plate = softening(predictor.reduced)
        inside = shares(plate.structure, values, soft=SOFT)
        return State(stiffness=(plate.change(inside, values["loss"], factors),))

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the compliance, of a region of matrices over its own."""
        value, unit = self.derived(predictor, values)["compliance"]
        name = INTEGRAL_COMPLIANCE if unit == "m" else f"relative {INTEGRAL_COMPLIANCE}"
        return (Size(name, value, unit),)

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the compliance, the integral of EI0/EI - 1 along x, of plates its mean across: what data determine."""
        if predictor.spec.kind == "matrices":
            return {"compliance": (values["loss"] / (1 - values["loss"]), "-")}
        if predictor.spec.kind == "beam":
            _, lengths, compliance = _profile(predictor, values)
            return {"compliance": (float(lengths @ compliance), "m")}
        structure = predictor.reduced.fielded.finer
        lost = values["loss"] * shares(structure, values, soft=SOFT)
        low, high = (values["y"] + side * extents(values)[1] / 2 for side in (-1, 1))
        across = min(high, predictor.spec.width) - max(low, 0.0)
        return {"compliance": (float(structure.fields.weights @ (1 / (1 - lost) - 1)) / across, "m")}


def _profile(predictor: Predictor, values: Values) -> Profile:
    """Return by how much a stretch of a beam is softer; soft edges do not change its whole compliance."""
    points, lengths, inside = along_beam(predictor.spec, values, soft=SOFT)
    return Profile(points, lengths, values["loss"] / (1 - values["loss"]) * inside)
