"""From a study to the region of its model in which each method puts the error."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from threadpoolctl import threadpool_limits

from modalkit.study.read import Study
from modalkit.workflow.case import Session, sessions_of
from updating.diagnosis.diagnose import pose
from updating.localisation import METHODS, Kind, Localisation, localise


def localise_study(
    study: Session | Study | Path | str,
    *,
    methods: Sequence[str] = tuple(METHODS),
    kind: Kind = "stiffness",
) -> Localisation:
    """State which region of a study's model each method suspects, before anything is updated.

    Parameters
    ----------
    study : Session, Study or path
        The study, with its test worked out or not yet; where it has a baseline, the model is corrected by it first.
    methods : sequence of str
        Names in ``updating.localisation.METHODS``.
    kind : {"stiffness", "mass", "damping"}
        What of a region may be wrong.

    Raises
    ------
    InputError
        If there is no such method, or none can be used on this model and this test.
    EstimationError
        If no measured mode has a partner in the model.
    """
    (session,) = sessions_of([study])
    with threadpool_limits(1, user_api="blas"):
        problem, warnings = pose(session.case)
        return localise(
            problem,
            methods=methods,
            kind=kind,
            title=session.study.name,
            warnings=[*warnings, *session.warnings],
        )
