"""What may be drawn in a run of blind trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self

from acquisition.errors import StudyError

KINDS = ("beam", "plate", "solid", "frame", "ribbed", "bracket")


@dataclass(frozen=True)
class DrawRanges:
    """What may be drawn; together with the seed it defines a run completely.

    Parameters
    ----------
    kinds : tuple of str
        Kinds of specimen, of ``beam``, ``plate``, ``solid``, a cantilever of bricks that the study models as a beam,
        and what it models by matrices: ``frame``, bars between joints, ``ribbed``, a plate with ribs, and ``bracket``,
        the last two of bricks. Those of bricks need CalculiX.
    plates : float
        Share of each kind beside beams [-]; all kinds are alike where that leaves nothing to beams, or there are none.
    effects : tuple of str
        What may be hidden; empty for everything that the rig has. ``none`` among them keeps its share.
    none : float
        Share of trials without any effect [-].
    pairs : float
        Share of trials with two effects of the library at once [-].
    triples : float
        Share of trials with three of them [-].
    outside : float
        Share of trials with an effect that the library lacks [-].
    mild, strong : float
        Shares of effects fainter and stronger than clear ones [-].
    leave_out : bool
        Whether the true effect is taken out of the library in every trial that has one.
    baseline : float
        Share of tests with a baseline [-].

    Raises
    ------
    StudyError
        If a share is none, or shares do not leave room for single effects of the library.
    """

    kinds: tuple[str, ...] = ("beam", "plate")
    plates: float = 1 / 3
    effects: tuple[str, ...] = ()
    none: float = 0.12
    pairs: float = 0.10
    triples: float = 0.0
    outside: float = 0.15
    mild: float = 0.2
    strong: float = 0.15
    leave_out: bool = False
    baseline: float = 0.25

    def __post_init__(self) -> None:
        """Check the shares and the kinds."""
        object.__setattr__(self, "kinds", tuple(self.kinds))
        object.__setattr__(self, "effects", tuple(self.effects))
        unknown = [kind for kind in self.kinds if kind not in KINDS]
        if unknown or not self.kinds:
            raise StudyError(f"plan: kinds {unknown or 'empty'}; choose from {', '.join(KINDS)}")
        shares = ("plates", "none", "pairs", "triples", "outside", "mild", "strong", "baseline")
        wrong = [name for name in shares if not 0.0 <= getattr(self, name) <= 1.0]
        if wrong:
            raise StudyError(f"plan: {wrong[0]} = {getattr(self, wrong[0])} is not a share; give 0 to 1")
        for names in (("none", "pairs", "triples", "outside"), ("mild", "strong")):
            if sum(getattr(self, name) for name in names) > 1.0 + 1e-9:
                raise StudyError(f"plan: the shares {', '.join(names)} add up to more than 1")

    def to_json(self) -> dict[str, Any]:
        """Return the plan as JSON can carry it."""
        return asdict(self) | {"kinds": list(self.kinds), "effects": list(self.effects)}

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Self:
        """Return the plan that ``to_json`` gave."""
        return cls(**document)
