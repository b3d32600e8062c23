"""One effect at one severity and place, hidden to check a forecast."""

from __future__ import annotations

from dataclasses import dataclass

from modalkit.planning.family import Family, Values


@dataclass(frozen=True, eq=False)
class Case:
    """One effect at one severity and place, and what is forecast of it.

    Parameters
    ----------
    family : Family
        The effect.
    q : float
        Severity [SI].
    place : float
        Where [m], or which form.
    now, then : float
        Distance to the nearest rival, as the test is and once the advice is followed [-].
    rival_now, rival_then : str
        Who that is.
    """

    family: Family
    q: float
    place: float
    now: float
    then: float
    rival_now: str
    rival_then: str

    @property
    def values(self) -> Values:
        """Parameters under the contract's names [SI]."""
        return dict(self.family.values(self.q, self.place))

    @property
    def severity_text(self) -> str:
        """Severity in words."""
        known = {key: value for key, value in self.values.items() if value}
        words = [
            f"{key} {value:.3g}" if isinstance(value, float) else f"{key} {value}"
            for key, value in known.items()
        ]
        return ", ".join(words) or self.family.name
