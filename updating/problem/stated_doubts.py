"""Whether doubts that are stated of single parameters are of something that the model has."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition.errors import StudyError
from updating.models.named_factors import unassigned
from updating.models.spec import Spec
from updating.tolerances import Tolerances

REGIONAL = ("E", "density", "thickness", "area", "inertia")
"""Properties of a region of which a doubt may be stated."""

OF_MATRICES = ("E", "density")
"""Those of a region that is nothing but matrices."""


def check_doubts(tolerances: Tolerances, spec: Spec, parameters: Sequence[str] = ()) -> None:
    """See that every stated doubt is of a region's property, or of a parameter that is updated.

    Parameters
    ----------
    tolerances : Tolerances
        The doubts.
    spec : Spec
        The model.
    parameters : sequence of str
        What an update turns, beside properties of regions.

    Raises
    ------
    StudyError
        If one is of neither, or bounds of a factor leave out 1.
    """
    own = list(dict.fromkeys(region.name for region in spec.regions))
    bare = spec.imported is not None and spec.imported.deck is None
    regional = OF_MATRICES if bare else REGIONAL
    for name in (*tolerances.parts, *tolerances.bounds):
        region, _, prop = name.rpartition(".")
        if name in unassigned(spec) or (region in own and prop in regional):
            _check_bounds(name, tolerances)
            continue
        if name in parameters:
            continue
        named = ", ".join(own[:6]) + (", ..." if len(own) > 6 else "")
        beyond = " or ".join(unassigned(spec))
        raise StudyError(
            f"[tolerances] {name}: unknown name; give {', '.join(regional)} of a region ({named}), "
            f"{f'{beyond} (parts outside all regions), ' if beyond else ''}or a parameter of [update]"
        )


def _check_bounds(name: str, tolerances: Tolerances) -> None:
    """See that the bounds of a property hold the unchanged model; a diagnosis asks how far it may be from there."""
    low, high = tolerances.bounds.get(name, (1.0, 1.0))
    if not 0 < low <= 1 <= high:
        raise StudyError(
            f"[tolerances] bounds of {name}: [{low:g}, {high:g}] do not include 1, the factor of the unchanged model; "
            "give bounds that do"
        )


def of_updates_alone(tolerances: Tolerances, spec: Spec) -> tuple[str, ...]:
    """State which doubts are of nothing that a diagnosis turns: numbers of a deck, and effects."""
    regions = {region.name for region in spec.regions}
    every = dict.fromkeys([*tolerances.parts, *tolerances.bounds])
    known = unassigned(spec)
    others = [name for name in every if name not in known and name.rpartition(".")[0] not in regions]
    if not others:
        return ()
    return (
        f"tolerances of {', '.join(others)} count in updates only; a diagnosis uses those of region properties",
    )
