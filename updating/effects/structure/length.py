"""A length that differs from the drawing, penetration into a clamp included."""

from collections.abc import Sequence

from acquisition.errors import StudyError
from updating.effects.base import Effect, Parameter, Values
from updating.effects.mechanism import INTEGRAL_COMPLIANCE, STIFFNESS_OVER_MASS, Size
from updating.models.state import State
from updating.prediction.predict import Predictor


class Length(Effect):
    """The free length is larger or smaller than modelled; it grows at the clamped edge."""

    name = "length"
    channel = "stiffness"
    summary = "The free length differs from the model's; at a clamp, the structure bends some way inside it."
    keeps_clamps = True
    footprint = (
        "All frequencies change by nearly one factor; points move relative to the clamp, so shapes show it."
    )
    equivalent_to = ("E", "density", "thickness", "clamp_rotation")
    separated_by = "shapes at points near the clamp, absolute level, or a free-free test of the same specimen"
    phrase = "the length"
    competes_with = "length"
    undone_by = frozenset({"unclamped"})
    fidelity = 0.01
    of_supports = True

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the extension."""
        size = predictor.spec.length
        why = "clamps grip up to some thicknesses deep; a mis-stated length is rarely worse"
        return (Parameter("extension", "m", -0.06 * size, 0.12 * size, why),)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the stretched structure.

        Raises
        ------
        StudyError
            If nothing is left of it.
        """
        stretch = 1 + values["extension"] / predictor.spec.length
        if not stretch > 0:
            raise StudyError(f"length: extension = {values['extension']:g} m leaves nothing of the structure")
        return State(factors={"length": stretch})

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the extension, the compliance that shifts modes as far at a clamp, and the change of all of them."""
        added = float(values["extension"])
        slower = (1 + added / predictor.spec.length) ** -4 - 1
        return (
            Size("length", added, "m"),
            Size(INTEGRAL_COMPLIANCE, added, "m"),
            Size(STIFFNESS_OVER_MASS, slower, "-"),
        )

    def scales(self, predictor: Predictor) -> tuple[str, float] | None:
        """Return that the extension stretches the model, at a clamp as elsewhere."""
        return "length", 1 / predictor.spec.length

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the clamped edges across x, where the length is in doubt."""
        return clamped_places(predictor, "x")


def clamped_places(
    predictor: Predictor, axes: str = "xy", *, edges: Sequence[str] | None = None
) -> tuple[tuple[float, float, float], ...]:
    """Return the middle of every clamped edge across the given axes, or of those named [m]."""
    spec = predictor.spec
    middle = 0.0 if spec.kind == "beam" else spec.width / 2
    places = {
        "x0": (0.0, middle, 0.0),
        "x1": (spec.length, middle, 0.0),
        "y0": (spec.length / 2, 0.0, 0.0),
        "y1": (spec.length / 2, spec.width, 0.0),
    }
    return tuple(places[edge] for edge in (spec.clamped if edges is None else edges) if edge[0] in axes)
