"""Clamps that give: in rotation, in translation, or in a pair of effects in both; of plates along a part of an edge."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant, bending_stiffness
from updating.effects.box import mirror_images
from updating.effects.mechanism import INTEGRAL_COMPLIANCE, Size
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import WAYS, centre_of, one_of, way
from updating.effects.structure.clamp_edges import (
    ALL,
    clamps_and_stretches,
    edge_size,
    longest,
    released_edges,
    stretch_of,
    whole_clamps,
)
from updating.effects.structure.edge_stretch import on_a_stretch
from updating.effects.structure.length import clamped_places
from updating.effects.structure.spring import own_stiffness
from updating.models.base import Structure
from updating.models.fields import Sparse
from updating.models.imported.groups import Support
from updating.models.spec import Spec
from updating.models.state import State
from updating.models.structure import FieldStructure
from updating.models.yielding import Yielding
from updating.prediction.predict import Predictor

NOT_HELD = (
    "the motion that the supports prevent is unknown: the node table lists no supported node (with empty rows), or "
    "the matrices have rows without a place"
)
"""Why supports of imported matrices cannot give way."""

EVERY_WAY = 0.5
"""Prior share of a support that gives way alike in all directions of its kind, where it holds in several [-]: rubber,
or a loose bolt, as against a slide or a hinge. Judged; doubled, one direction alone is out of the question."""

RIGID = 1e7
"""Stiffness of a clamp that holds beside one that gives way, in natural units [-]: it moves frequencies by a hundred
thousandth. A hundred times as much costs the eigenvalues as many digits as it gains."""

STRETCHES = ((0.0, 0.5), (1.0, 0.5), (0.5, 0.5), (0.0, 0.25), (1.0, 0.25))
"""Stretches of an edge from which a search starts: place and length, as quantiles [-]. Each half, the middle and both
ends: what is shorter is found from these."""

SIZES = (0.3, 0.7)
"""Quantiles of the stiffness from which a search starts [-]."""


class Clamp(Effect):
    """A spring in place of a built-in edge.

    On plates it acts ``from`` one place ``to`` another along the edge, by y of an edge of constant x; the rest of the
    edge holds. The prior takes any length and any place, each alike.
    """

    channel = "stiffness"
    models = ("beam", "plate", "matrices")
    named = ("support", "direction")
    fidelity = 0.02
    of_supports = True
    undone_by = frozenset({"unclamped"})
    freed: ClassVar[Literal["rotation", "translation"]]
    """What the clamp no longer holds by itself."""
    power: ClassVar[int]
    """Power of the length with which E I makes the natural unit of the spring's stiffness."""
    units: ClassVar[tuple[str, str]]
    """Units of the stiffness on a beam and on a plate."""
    span: ClassVar[tuple[float, float]]
    """Range of the prior, in natural units."""
    why: ClassVar[str]
    firm: ClassVar[float]
    """Stiffness of an edge that holds beside a stretch that gives way, in natural units: what is stiffer costs the
    eigenvalues digits, what is softer moves frequencies by more than a hundred thousandth [-]."""

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the spring's stiffness, per metre of edge on plates, and there from where to where it acts."""
        spec = predictor.spec
        if spec.imported is None:
            scale = bending_stiffness(spec) / spec.length**self.power
        else:
            scale = own_stiffness(predictor) * spec.imported.reach ** (3 - self.power)
        unit = self.units[spec.kind == "plate"]
        stiffness = Parameter(
            "stiffness", unit, self.span[0] * scale, self.span[1] * scale, self.why, log=True
        )
        if spec.kind != "plate" or not spec.clamped:
            return (stiffness,)
        size = longest(spec)
        why = "any stretch of the clamped edge; all lengths and places are equally probable"
        ends = (("from", 0.0), ("to", size))
        return (
            stiffness,
            *(Parameter(name, "m", 0.0, size, why, default=end, natural=EDGES) for name, end in ends),
        )

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values: on plates those of the place and of the length of the stretch."""
        values = super().values(predictor, coordinates)
        if "to" in values:
            size, (place, length) = longest(predictor.spec), coordinates[1:]
            values["from"] = place * (1 - length) * size
            values["to"] = values["from"] + length * size
        return values

    def quantiles(self, predictor: Predictor, values: Values) -> list[float]:
        """Take values to prior quantiles."""
        found = super().quantiles(predictor, values)
        if len(found) > 1 and "to" in values and "from" in values:
            size = longest(predictor.spec)
            length = float(np.clip((values["to"] - values["from"]) / size, 0.0, 1.0))
            place = values["from"] / size / max(1 - length, 1e-9)
            found[1:] = [float(np.clip(place, 0.0, 1.0)), length]
        return found

    def settled(self, predictor: Predictor, values: Values) -> Values:
        """Return the values with a stretch of the longest edge, as the prior has it, on the edge that is meant."""
        edge = values.get("support", ALL)
        if "to" not in values or edge == ALL:
            return values
        share = edge_size(predictor.spec, str(edge)) / longest(predictor.spec)
        return {**values, "from": values["from"] * share, "to": values["to"] * share}

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from little and much stiffness, on plates of some stretches of the edge."""
        if len(self.parameters(predictor)) == 1:
            return super().starts(predictor)
        return tuple((size, *stretch) for stretch in STRETCHES for size in SIZES)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need a clamp."""
        if predictor.spec.imported is not None:
            return None if predictor.spec.imported.supports else Obstacle(Lack.MODEL, NOT_HELD)
        return None if predictor.spec.clamped else Obstacle(Lack.MODEL, "the model has no clamped edge")

    def names_in(self, spec: Spec) -> set[str]:
        """Return that one of several clamped edges may be named, and a support of imported matrices."""
        return (
            super().names_in(spec)
            if spec.imported is not None
            else {"support"}
            if len(spec.clamped) > 1
            else set()
        )

    def repeats_on(self, predictor: Predictor) -> bool:
        """State that two feet may give way, or one foot in two directions; the clamps of a beam are one form each."""
        return predictor.spec.imported is not None

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the forms: all clamps alike, and each alone; of imported matrices each support in each direction.

        Of plates along the whole edge, and along any part of each edge.
        """
        if predictor.spec.kind == "plate":
            return clamps_and_stretches(predictor.spec)
        if predictor.spec.imported is None:
            return whole_clamps(predictor.spec)
        supports = predictor.spec.imported.supports
        forms = [form for support in supports for form in self._ways(support)]
        whole = sum(form.weight for form in forms)
        return tuple(Variant(form.values, form.weight / whole) for form in forms)

    def _ways(self, support: Support) -> list[Variant]:
        """Return the directions in which a support may give way, each alone and all alike, the shares adding to 1."""
        axes = self._axes(support)
        several = len(axes) > 1
        share = (1 - EVERY_WAY if several else 1.0) / max(len(axes), 1)
        alone = [Variant({"support": support.name, "direction": WAYS[axis]}, share) for axis in axes]
        return [Variant({"support": support.name, "direction": ALL}, EVERY_WAY)] * several + alone

    def _axes(self, support: Support) -> list[int]:
        """Return the directions, of this effect's kind, in which a support holds."""
        return [
            axis for axis in (range(3, 6) if self.freed == "rotation" else range(3)) if support.holds(axis)
        ]

    def sentence(self, values: Values) -> str:
        """Return the summary, and which support in which direction."""
        along = ""
        if "from" in values and "to" in values:
            along = f" It does so along the edge from {values['from']:.3g} to {values['to']:.3g} m; the rest holds."
        if values.get("support", ALL) == ALL:
            return self.summary + along
        if "direction" not in values:
            return f"{self.summary} It is the one at {values['support']}.{along}"
        way = str(values["direction"])
        towards = "alike in all directions" if way == ALL else way.replace("r", "about ")
        return f"{self.summary} It is {values['support']}, {towards}."

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure on the spring.

        Imported matrices have lost the rows of their supports, see :class:`updating.models.yielding.Yielding`. Where
        one of several clamps gives way, the others are springs that nothing moves.
        """
        if predictor.spec.imported is not None:
            support = one_of(predictor.spec.imported.supports, values, "support")
            return State(yielding={support.name: self._yielding(predictor, support, values)})
        own, others = released_edges(predictor.spec, values)
        if (stretch := stretch_of(predictor.spec, own, values)) is not None:
            firm = self.firm * bending_stiffness(predictor.spec) / predictor.spec.length**self.power
            return on_a_stretch(predictor, self.freed, own[0], stretch, float(values["stiffness"]), firm)
        held = values["stiffness"] * unit_edges(predictor, self.freed, own)
        if others:
            firm = RIGID * bending_stiffness(predictor.spec) / predictor.spec.length**self.power
            held = held + firm * unit_edges(predictor, self.freed, others)
        return State(stiffness=(held,), released=frozenset({self.freed}))

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the stiffness against its kind of motion; of an edge that turns along all of it its compliance."""
        spec, stiffness = predictor.spec, float(values["stiffness"])
        held = Size(f"stiffness in {self.freed}", stiffness, self.units[spec.kind == "plate"])
        turns = self.freed == "rotation" and spec.imported is None
        if not turns or stretch_of(spec, released_edges(spec, values)[0], values) is not None:
            return (held,)
        return held, Size(INTEGRAL_COMPLIANCE, bending_stiffness(spec) / stiffness, "m")

    def _yielding(self, predictor: Predictor, support: Support, values: Values) -> Yielding:
        """Return a support on springs of one stiffness, in a direction or in all of this kind in which it holds."""
        axes = self._axes(support) if values.get("direction") == ALL else [way(values, "direction")]
        compliance = np.zeros(6)
        compliance[axes] = np.divide(1.0, float(values["stiffness"]))
        kept, key = predictor.reduced.kept, ("support", support.name)
        if key not in kept:
            known = support.loads, support.inertia
            kept[key] = [predictor.reduced.generalised(Sparse(each)) for each in known]
        loads, inertia = kept[key]
        regions = 1 + len(predictor.spec.regions)  # matrices without parts are in none of them
        shares = [
            np.insert(each, 0, np.zeros(regions - len(each)))
            for each in (support.held_by, support.carried_by)
        ]
        return Yielding(loads, support.own, support.mass, inertia, compliance, *shares)

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the clamped edges that give way, or the support."""
        if predictor.spec.imported is not None:
            return (centre_of(one_of(predictor.spec.imported.supports, values, "support")),)
        edges = released_edges(predictor.spec, values)[0]
        places = clamped_places(predictor, edges=edges)
        if (stretch := stretch_of(predictor.spec, edges, values)) is None:
            return places
        (x, y, z), middle = places[0], sum(stretch) / 2
        at = (x, middle, z) if edges[0][0] == "x" else (middle, y, z)
        if predictor.measured.has_shapes:
            return (at,)
        along = 1 if edges[0][0] == "x" else 0  # along the edge alone: another edge is a form of its own
        return tuple(one for one in mirror_images(predictor.spec, at) if one[1 - along] == at[1 - along])


class ClampRotation(Clamp):
    """The clamp turns: a rotational spring in place of a built-in edge."""

    name = "clamp_rotation"
    summary = "The clamp turns with the structure instead of holding its slope."
    footprint = "All frequencies fall, the lowest most; shapes tilt about the clamp."
    equivalent_to = ("E", "length", "clamp_translation", "local_stiffness")
    separated_by = (
        "points near the clamp, a free-free test of the same specimen, or re-clamping at another torque"
    )
    phrase = "a clamp that rotates"
    freed = "rotation"
    power = 1
    firm = 1e5
    units = ("N m/rad", "N m/rad per m")
    span = (1.0, 2000.0)
    why = "from nearly a hinge to 2000 times the structure's own E I / L, where it is undetectable"


class ClampTranslation(Clamp):
    """The clamp shifts: a spring across the structure in place of a built-in edge, whose slope stays held."""

    name = "clamp_translation"
    summary = "The clamp shifts with the structure instead of holding it in place."
    footprint = "Frequencies fall, the higher modes most; shapes move at the clamp, with no tilt there."
    equivalent_to = ("clamp_rotation",)
    separated_by = "a sensor on the clamp, or a test on a heavier foundation"
    phrase = "a clamp that gives way"
    freed = "translation"
    power = 3
    firm = 1e8
    units = ("N/m", "N/m per m")
    span = (5.0, 1e7)
    why = (
        "from nearly as soft as the structure, 5 E I / L^3, to ten million E I / L^3, where it is "
        "undetectable"
    )


def unit_edges(
    predictor: Predictor, freed: Literal["rotation", "translation"], edges: Sequence[str] | None = None
) -> FloatArray:
    """Integrate the square of the slope, or of the displacement, across clamped edges, as (r, r) [m in w].

    Across all of them where no ``edges`` are named.
    """
    reduced = predictor.reduced
    named = tuple(predictor.spec.clamped if edges is None else edges)

    def build() -> FloatArray:
        across = edge_slopes if freed == "rotation" else edge_shifts
        return reduced.project(across(reduced.structure, named))

    return predictor.once(f"edges {named} {freed}", build)


def edge_slopes(structure: Structure, edges: Sequence[str] | None = None) -> Sparse:
    """Integrate the square of the slope across clamped edges of the full model, or those named [m in w]."""
    assert isinstance(structure, FieldStructure)
    normal = {"x": "wx", "y": "wy"}
    if structure.spec.theory == "timoshenko":
        normal["x"] = "r"
    if structure.spec.theory == "mindlin":
        normal = {"x": "tx", "y": "ty"}
    return _along_edges(structure, normal, structure.spec.clamped if edges is None else edges)


def edge_shifts(structure: Structure, edges: Sequence[str] | None = None) -> Sparse:
    """Integrate the square of the displacement across clamped edges of the full model, or those named [m in w]."""
    assert isinstance(structure, FieldStructure)
    return _along_edges(structure, {"x": "w", "y": "w"}, structure.spec.clamped if edges is None else edges)


def _along_edges(structure: FieldStructure, names: Mapping[str, str], edges: Sequence[str]) -> Sparse:
    """Integrate the square of a field, named by the edge's normal, across edges."""
    spec, fields = structure.spec, structure.fields
    total = Sparse((fields.n_dofs, fields.n_dofs))
    for edge in edges:
        name = names[edge[0]]
        place = {"x0": 0.0, "x1": spec.length, "y0": 0.0, "y1": spec.width}[edge]
        if spec.kind == "beam":
            component = next(c for c in fields.components if name in c.names)
            rows, weights = component.at(np.array([[place]]), fields.n_dofs)[name], np.ones(1)
        else:
            size = spec.width if edge[0] == "x" else spec.length
            nodes, weights = np.polynomial.legendre.leggauss(40)
            span, weights = (nodes + 1) * size / 2, weights * size / 2
            ends = (np.full(40, place), span) if edge[0] == "x" else (span, np.full(40, place))
            component = next(c for c in fields.components if name in c.names)
            rows = component.at(np.stack(ends, axis=1), fields.n_dofs)[name]
        total = total + rows.T @ sparse.diags_array(weights) @ rows
    return Sparse(total)
