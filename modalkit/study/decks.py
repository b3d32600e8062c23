"""``[model] type = "calculix"``: a deck, its regions as the study states them, and the specification."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from acquisition.errors import StudyError
from modalkit.study.matrices import FACTORS_ALONE, FOREIGN, sides_of, spec_of
from updating.models import Damping, Material, Region, Spec
from updating.models.imported import SI, UNITS
from updating.models.imported.decks import DeckModel, read_deck_model
from updating.models.imported.of_deck import imported

if TYPE_CHECKING:
    from modalkit.study.model_tables import ModelTable

OF_MATRICES = (
    "stiffness", "mass_matrix", "stiffness_name", "mass_name", "stiffness_parts", "mass_parts", "nodes", "material",
)  # fmt: skip
"""Keys that matrices have and a deck states itself."""

OWN = ("E", "density", "thickness", "area", "inertia", "x", "y")
"""Keys of a region that its elements say."""


def deck_of(model: ModelTable, file: Callable[[str], Path]) -> DeckModel:
    """Read the deck that a ``[model]`` of type calculix names.

    Parameters
    ----------
    model : ModelTable
        The table.
    file : callable
        Takes a name of the study file to its path.

    Raises
    ------
    StudyError
        If a key is missing or does not belong there, or the deck cannot be read.
    """
    if foreign := [key for key in (*FOREIGN, *OF_MATRICES) if getattr(model, key)]:
        raise StudyError(f"[model] of type calculix takes no {', '.join(foreign)}: the deck states it")
    if model.deck is None:
        raise StudyError('[model] of type calculix needs a deck = "part.inp"')
    for region in model.region:
        if own := [key for key in OWN if getattr(region, key) is not None]:
            raise StudyError(
                f"[[model.region]] {region.name!r} takes no {', '.join(own)} on a deck, where a region is an element "
                'set; give its name, or set = "..."'
            )
    return read_deck_model(
        file(model.deck), [(r.name, r.set or r.name) for r in model.region], units=model.units or SI
    )


def deck_spec(model: ModelTable, deck: DeckModel, damping: Damping) -> Spec:
    """Return the specification of a deck.

    Parameters
    ----------
    model : ModelTable
        What the study states beside it.
    deck : DeckModel
        The deck.
    damping : Damping
        What the modeller expects.

    Raises
    ------
    StudyError
        If CalculiX does not solve it.
    """
    stated, made_of = {table.name: table for table in model.region}, imported(deck)
    regions = []
    for number, own in enumerate(deck.division.regions):
        box = made_of.box(number)
        x, y = sides_of(made_of, made_of.extents if box is None else box)
        table = stated.get(own.name)
        damps = {} if table is None else table.model_dump(include={"alpha", "beta", "loss_factor"})
        made = _material(deck, own.materials)
        regions.append(Region(own.name, x, y, made.E, made.density, **damps))
    names = dict.fromkeys(name for own in deck.division.regions for name in own.materials)
    return spec_of(model, made_of, _material(deck, tuple(names)), tuple(regions), damping)


def known_values(deck: DeckModel) -> dict[str, float]:
    """Return moduli [Pa] and densities [kg/m3] by the names of their parameters, 1 where no card states one for all."""
    own = {f"{region.name}.": region.materials for region in deck.division.regions}
    every = tuple(dict.fromkeys(name for names in own.values() for name in names))
    made = {head: _material(deck, names) for head, names in {"": every, **own}.items()}
    return {
        f"{head}{key}": value
        for head, one in made.items()
        for key, value in (("E", one.E), ("density", one.density))
    }


def _material(deck: DeckModel, names: tuple[str, ...]) -> Material:
    """Return the one isotropic material of some elements [SI], else one whose modulus and density are factors."""
    length, force = UNITS[deck.units]
    if len(names) != 1:
        return FACTORS_ALONE
    modulus, density = (deck.mesh.property_of(names[0], card) for card in ("*ELASTIC", "*DENSITY"))
    return Material(
        FACTORS_ALONE.E if modulus is None else modulus * force / length**2,
        FACTORS_ALONE.density if density is None else density * force / length**4,
    )
