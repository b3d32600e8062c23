"""From studies to a diagnosis: one specimen, or several whose gaps have causes in common."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition.errors import InputError
from modalkit.process import Session
from updating import Diagnosis, diagnose, diagnose_together


def diagnose_studies(sessions: Sequence[Session], shared: Sequence[str] = ()) -> Diagnosis:
    """Diagnose one study, or several together.

    Parameters
    ----------
    sessions : sequence of Session
        Studies with their tests worked out.
    shared : sequence of str
        Effects of one and the same size in all studies; those of all others are free in each.

    Raises
    ------
    InputError
        If effects are shared with nobody, or there are no such effects.
    EstimationError
        If no measured mode of a study has a partner in its model.
    """
    if len(sessions) > 1:
        return diagnose_together([session.case for session in sessions], shared=shared)
    if shared:
        raise InputError(f"--shared {','.join(shared)}: there is one study only; give those that share it")
    return diagnose(sessions[0].case)


def warnings_of(sessions: Sequence[Session]) -> list[str]:
    """Return the warnings of all studies; of several, with the study they belong to."""
    if len(sessions) == 1:
        return list(sessions[0].warnings)
    return [f"{session.study.name}: {warning}" for session in sessions for warning in session.warnings]
