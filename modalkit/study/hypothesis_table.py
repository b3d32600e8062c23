"""The table ``[[hypothesis]]`` of a study; what it means for a model is in :mod:`modalkit.study.hypotheses`."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from modalkit.study.strict import Strict

SIGNS = frozenset(".#+(")
"""What stands between names, and between a name and its parameter, and so cannot stand in one."""


class HypothesisTable(Strict):
    """``[[hypothesis]]``."""

    name: str = Field(min_length=1, max_length=80)
    """The user's own cause; no ``.``, ``#``, ``+``, ``(``, and no name of an effect."""
    stiffness: str | None = None
    """The whole stiffness matrix K1 if the hypothesis were true; the model is K0 + amount (K1 - K0), and the
    answer is ``NAME.amount``.
    """
    mass: str | None = None
    """The whole mass matrix if the hypothesis were true."""
    deck: str | None = None
    """``calculix``: the deck if the hypothesis were true, with the same mesh and supports."""
    parameter: str | None = None
    """Instead of these: ``E``, ``density``, ``REGION.E``, ``REGION.density``, or a number of a deck, ``SET.thickness``;
    the answer is ``NAME.value``.
    """
    range: Annotated[list[float | str], Field(min_length=2, max_length=2)] | None = None
    """Range of the amount, 0 being the unchanged model. With ``parameter`` required, in the unit in which an update
    gives it: factors where neither ``[model.material]`` nor the deck's cards say the value.
    """
    why: str = ""
    """Reason, printed with the answer."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """See that the name can be one, and that there is one thing that is supposed."""
        from updating import LIBRARY  # loaded where a study has a hypothesis

        if self.name in LIBRARY:
            raise ValueError(f"name = {self.name!r} is the name of an effect; choose another")
        if wrong := sorted(SIGNS & set(self.name)):
            raise ValueError(f"name = {self.name!r} contains {wrong[0]!r}, which is reserved; leave it out")
        matrices = self.stiffness is not None or self.mass is not None
        if matrices + (self.deck is not None) + (self.parameter is not None) != 1:
            raise ValueError(f"{self.name!r} needs stiffness, mass or both; or deck; or parameter")
        if self.parameter is not None and self.range is None:
            raise ValueError(f"{self.name!r}: a parameter needs its range, [low, high]")
        return self

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the files that it is in."""
        return tuple(name for name in (self.stiffness, self.mass, self.deck) if name is not None)
