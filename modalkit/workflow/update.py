"""From studies to an updated model: which method, which parameters, which data."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from acquisition import FrfSet, bootstrap_frfs
from acquisition.arrays import FloatArray
from acquisition.errors import EstimationError, StudyError
from acquisition.hits.windows import Windows
from identification import ModalModel
from modalkit.study.read import Study
from modalkit.workflow.case import Session, sessions_of
from modalkit.workflow.judged_hits import Judged
from modalkit.workflow.processed import Processed
from modalkit.workflow.stages import REDRAWING, UPDATING, UPDATING_DRAWS
from updating.frf_update import FrfUpdate, bootstrap_frf_update, update_frfs
from updating.steps import Steps
from updating.test_data.measured_frfs import MeasuredFrfs, measured_frfs, redrawn
from updating.update import Update, bootstrap, redrawn_frequencies, update
from updating.update.data.system import Weights


def update_studies(
    studies: Sequence[Session | Study | Path | str],
    shared: Sequence[str] = (),
    *,
    draws: int = 0,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    part: Callable[[float], None] | None = None,
) -> Update:
    """Update the models of one or several studies as their ``[update]`` tables state.

    Parameters
    ----------
    studies : sequence of Session, Study or path
        Studies, with their tests worked out or not yet.
    shared : sequence of str
        Parameters that have one value in all studies; they are updated in all of them.
    draws : int
        How often hits are drawn anew for bootstrap intervals; where a test has no hits, its stated scatter is
        drawn [-].
    seed : int
        Of these draws.
    progress : function, optional
        Called with the name of every stage as it begins.
    part : function, optional
        Called with how much of a stage is done, from 0 to 1, in those that draw.

    Returns
    -------
    Update
        By FRFs, an :class:`updating.frf_update.FrfUpdate`.

    Raises
    ------
    StudyError
        If the tables do not go together, or name what there is not.
    EstimationError
        If no measured mode has a partner.
    """
    steps = Steps.to(progress, part)
    sessions = sessions_of(studies, with_baseline=False)
    steps.begin(UPDATING)
    methods = {session.study.update.method for session in sessions}
    if methods == {"frf"} and len(sessions) == 1 and not shared:
        return _by_frfs(sessions[0], draws, seed, steps)
    return _by_modes(sessions, shared, draws, seed, steps)


def _by_modes(
    sessions: Sequence[Session], shared: Sequence[str], draws: int, seed: int, steps: Steps
) -> Update:
    """Update by frequencies, and what else of the modes the studies name."""
    tables = [session.study.update for session in sessions]
    by_frfs = [session for session in sessions if session.study.update.method == "frf"]
    if by_frfs:
        raise StudyError(
            f'{by_frfs[0].study.path}: updating by FRFs takes one study at a time; use method = "eigenvalue" for '
            "several, or for shared parameters"
        )
    for session, table in zip(sessions, tables, strict=True):
        if table.stages is not None or table.lines is not None:
            raise StudyError(f'{session.study.path}: [update] stages and lines need method = "frf"')
    weights = _weights(sessions)
    own = [list(dict.fromkeys([*table.named, *shared])) for table in tables]
    if len({tuple(table.data) for table in tables}) > 1:
        raise StudyError("[update] data: the studies name different data; name the same in all")
    cases = [session.case for session in sessions]
    if not draws:
        return update(cases, parameters=own, shared=shared, weights=weights, data=tables[0].data)
    if tables[0].data != ["frequencies"]:
        raise StudyError("--bootstrap resamples frequencies only; leave data out of [update]")
    rng = np.random.default_rng(seed)
    steps.begin(REDRAWING)
    frequencies = [_frequencies(session, rng, draws, steps) for session in sessions]
    steps.begin(UPDATING_DRAWS)
    return bootstrap(
        cases, rng=rng, n=draws, frequencies=frequencies, parameters=own, shared=shared, weights=weights,
        steps=steps,
    ).update  # fmt: skip


def _weights(sessions: Sequence[Session]) -> Weights:
    """Return the weights of one study, or those of several put together."""
    tables = [session.study.update for session in sessions]
    if len(tables) > 1 and any(isinstance(table.weights, list) for table in tables):
        return [weight for session in sessions for weight in _listed(session)]
    if len({str(table.weights) for table in tables}) > 1:
        kinds = ", ".join(
            f'"{table.weights}" in {s.study.path}' for s, table in zip(sessions, tables, strict=True)
        )
        raise StudyError(f"[update] weights: {kinds}; use one kind in all studies")
    return tables[0].weights


def _listed(session: Session) -> list[float]:
    """Return a study's weights as a list beside those of other studies; "relative" is a list of ones."""
    weights = session.study.update.weights
    if isinstance(weights, list):
        return weights
    if weights == "relative":
        return [1.0] * len(session.case.measured.frequency)
    raise StudyError(
        f'{session.study.path}: [update] weights = "{weights}" cannot be combined with the numbers that another '
        'study lists; use numbers or "relative" in all'
    )


def _by_frfs(session: Session, draws: int, seed: int, steps: Steps) -> FrfUpdate:
    if session.identified is None:
        raise StudyError(f'{session.study.path}: [update] method = "frf" needs FRFs; give files in [test]')
    table, case = session.study.update, session.case
    if table.data != ["frequencies"] or table.weights != "covariance":
        raise StudyError(f'{session.study.path}: [update] weights and data need method = "eigenvalue"')
    frfs = measured_frfs(session.identified, case.measured)
    if not draws:
        return update_frfs(case, frfs, parameters=table.named, stages=table.stages, lines=table.lines)
    rng = np.random.default_rng(seed)
    steps.begin(UPDATING_DRAWS)
    return bootstrap_frf_update(
        case, frfs, rng=rng, n=draws, draws=_receptances(session, frfs, rng, draws),
        parameters=table.named, stages=table.stages, lines=table.lines, steps=steps,
    ).update  # fmt: skip


def _hits(session: Session) -> tuple[Judged, Processed, ModalModel] | None:
    """Return the hits that can be drawn anew: those of a test that is nothing but one set of raw hits."""
    processed, identified = session.processed, session.identified
    if processed is None or identified is None or len(processed.judged) != 1:
        return None
    if processed.content.frfs is not None or processed.processing.sensor_masses:
        return None
    return processed.judged[0], processed, identified


def _drawn(judged: Judged, processed: Processed, rng: np.random.Generator, n: int) -> Iterator[FrfSet]:
    processing = processed.processing
    windows = Windows(decay=processing.window) if processing.window else None
    return bootstrap_frfs(
        judged.test, rng=rng, n=n, estimator=processing.estimator, verdicts=judged.verdicts, windows=windows
    )


def _frequencies(session: Session, rng: np.random.Generator, n: int, steps: Steps) -> FloatArray | None:
    found = _hits(session)
    if found is None:
        return None
    judged, processed, identified = found
    processing = processed.processing
    windows = Windows(decay=processing.window) if processing.window else None
    try:
        return redrawn_frequencies(
            identified, judged.test, rng=rng, n=n, steps=steps,
            estimator=processing.estimator, verdicts=judged.verdicts, windows=windows,
        )  # fmt: skip
    except EstimationError as error:
        raise EstimationError(f"--bootstrap: {error}") from error


def _receptances(
    session: Session, frfs: MeasuredFrfs, rng: np.random.Generator, n: int
) -> Iterator[MeasuredFrfs] | None:
    found = _hits(session)
    if found is None:
        return None
    judged, processed, identified = found
    drawn = _drawn(judged, processed, rng, n)
    return (redrawn(frfs, identified, session.case.measured, one) for one in drawn)
