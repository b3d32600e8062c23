"""The score as tables of words: what the command prints and the docs carry."""

from __future__ import annotations

from collections.abc import Callable

from modalkit.blind.scoring import answered, stated
from modalkit.blind.scoring.score import Score
from modalkit.blind.scoring.section import Section

_MAKERS: tuple[Callable[[Score], Section], ...] = (
    answered.headline_section,
    answered.groups_section,
    answered.effects_section,
    answered.pairs_section,
    answered.unknowable_section,
    answered.taken_for_section,
    answered.abstention_section,
    stated.calibration_section,
    stated.cover_section,
    stated.severity_section,
    stated.places_section,
    stated.points_section,
    stated.channels_section,
    stated.closing_section,
    stated.silence_section,
    answered.rates_section,
)


def sections(score: Score) -> tuple[Section, ...]:
    """Return the score as tables of words, what matters first.

    Parameters
    ----------
    score : Score
        Of a blind run.

    Returns
    -------
    tuple of Section
        Those that something can be said in.
    """
    return tuple(section for make in _MAKERS if len((section := make(score)).table))
