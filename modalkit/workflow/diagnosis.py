"""From studies to a diagnosis: one specimen, or several whose gaps have causes in common."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from acquisition.errors import InputError
from modalkit.study.read import Study
from modalkit.workflow.case import Session, sessions_of
from updating import Diagnosis, diagnose, diagnose_together
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.effects import LIBRARY, Effect
from updating.steps import SingleCause


def diagnose_studies(
    studies: Sequence[Session | Study | Path | str],
    shared: Sequence[str] = (),
    without: Sequence[str] = (),
    *,
    rules: DecisionRules = DEFAULT_RULES,
    progress: Callable[[str], None] | None = None,
    part: Callable[[float], None] | None = None,
    found: Callable[[SingleCause], None] | None = None,
) -> Diagnosis:
    """Diagnose one study, or several together.

    Parameters
    ----------
    studies : sequence of Session, Study or path
        Studies, with their tests worked out or not yet.
    shared : sequence of str
        Effects of one and the same size in all studies; those of all others are free in each.
    without : sequence of str
        Effects of the library that are left out, as if it did not have them.
    rules : DecisionRules
        What the verdict is decided by.
    progress : function, optional
        Called with the name of every stage as it begins.
    part : function, optional
        Called with how much of a stage is done, from 0 to 1, in those that compare causes.
    found : function, optional
        Called with every single cause as it is compared, no cause first.

    Raises
    ------
    InputError
        If effects are shared with nobody, or there are no such effects, or none is left.
    EstimationError
        If no measured mode of a study has a partner in its model.
    """
    library, sessions = _library(without), sessions_of(studies)
    if len(sessions) > 1:
        cases = [session.case for session in sessions]
        return diagnose_together(
            cases, shared=shared, library=library, rules=rules, progress=progress, part=part, found=found
        )
    if shared:
        raise InputError(f"--shared {','.join(shared)}: there is one study only; give those that share it")
    return diagnose(sessions[0].case, library=library, rules=rules, progress=progress, part=part, found=found)


def _library(without: Sequence[str]) -> list[Effect]:
    for name in without:
        if name not in LIBRARY:
            raise InputError(f"--without {name}: there is no such effect; `modalkit effects` lists them")
    left = [effect for name, effect in LIBRARY.items() if name not in without]
    if not left:
        raise InputError("--without names every effect there is; leave at least one in the library")
    return left


def warnings_of(sessions: Sequence[Session]) -> list[str]:
    """Return the warnings of all studies; of several, with the study they belong to."""
    if len(sessions) == 1:
        return list(sessions[0].warnings)
    return [f"{session.study.name}: {warning}" for session in sessions for warning in session.warnings]
