"""From a study file to its case: the chain that every command with a model walks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from acquisition import ModalData, StudyError, Windows, read_mat, read_modes
from acquisition.display import Animated
from acquisition.warned import prefixed
from identification import ModalModel, frf_health, level_dependence
from modalkit.study.read import Study, read_study
from modalkit.study.tables import MeasurementTable
from modalkit.workflow.files import Progress
from modalkit.workflow.identification import read_frfs
from modalkit.workflow.processed import Processed
from modalkit.workflow.processing_options import ProcessingOptions
from modalkit.workflow.stated_places import with_places
from updating import Case, Measured, measured_from_identified, measured_from_modes
from updating.problem.stated_doubts import check_doubts
from updating.test_data.measured import NO_PARTNER, UNSTATED

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Session(Animated):
    """A study with everything that was worked out on the way to a case.

    Parameters
    ----------
    study : Study
        The study.
    case : Case
        Test beside model.
    processed, identified : Processed, ModalModel, optional
        FRFs and identification of the test, where it has FRFs.
    warnings : tuple of str
        What the user should know.
    """

    study: Study
    case: Case
    processed: Processed | None
    identified: ModalModel | None
    warnings: tuple[str, ...]

    def _headline(self) -> str:
        return self.case._headline()

    def _frame(self) -> pd.DataFrame:
        return self.case.measured._frame()


def open_study(
    study: Study | Path | str,
    *,
    with_baseline: bool = True,
    known: tuple[Processed, ModalModel] | None = None,
) -> Session:
    """Work out the case of a study: process and identify its test and its baseline.

    Parameters
    ----------
    study : Study or path
        The study, or its file.
    with_baseline : bool
        Whether the baseline is worked out too; only a diagnosis needs it.
    known : (Processed, ModalModel), optional
        FRFs and modes of the test, as :func:`process` gives them, where they are there already.

    Raises
    ------
    StudyError
        If the study names no data.
    """
    study = study if isinstance(study, Study) else read_study(study)
    test, processed, identified = _measure(study, study.test, "test", known)
    baseline, *before = (
        _measure(study, study.baseline, "baseline")
        if study.baseline is not None and with_baseline
        else (None, None, None)
    )
    with _naming(study):
        own = [name for stage in study.update.stages or [] for name in stage]
        check_doubts(study.doubts(), study.spec(), [*study.update.named, *own])
    case = Case(
        study.name,
        study.spec(),
        test,
        baseline=baseline,
        tolerances=study.doubts(),
        environment=study.surroundings(),
        accepted=study.accepted(),
        since_baseline=study.since_baseline(),
        baseline_stated=study.baseline_stated(),
    )
    own = [w for part in (processed, identified) if part is not None for w in part.warnings]
    own += _health(processed, identified)
    own += [prefixed("baseline: ", w) for part in before if part is not None for w in part.warnings]
    return Session(study, case, processed, identified, tuple(dict.fromkeys(own)))


def sessions_of(
    studies: Sequence[Session | Study | Path | str], *, with_baseline: bool = True
) -> list[Session]:
    """Return studies worked out; those that are already stay as they are.

    Parameters
    ----------
    studies : sequence of Session, Study or path
        The studies, or their files.
    with_baseline : bool
        Whether the baselines are worked out too.

    Raises
    ------
    StudyError
        If there is no study.
    """
    if not studies:
        raise StudyError("no study is given; name one or more study files")
    return [s if isinstance(s, Session) else open_study(s, with_baseline=with_baseline) for s in studies]


def process(
    study: Study,
    *,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    add: Sequence[float] = (),
    drop: Sequence[float] = (),
    progress: Progress | None = None,
    stage: Callable[[str], None] | None = None,
) -> tuple[Processed, ModalModel]:
    """Return FRFs and modes of a study's test.

    Parameters
    ----------
    study : Study
        The study.
    band, order : tuple of float and int, optional
        Instead of what the study states.
    add, drop : sequence of float
        Beside what the study states: modes to keep and to leave out [Hz].
    progress : function, optional
        Called with the part of the files that is read, from 0 to 1.
    stage : function, optional
        Called with the name of every stage of the identification as it begins.

    Raises
    ------
    StudyError
        If the study's test has no files.
    """
    if not study.test.files:
        raise StudyError(f"{study.path}: [test] names no files to identify; add files = [...]")
    return _identified(
        study, study.test, band=band, order=order, add=add, drop=drop, progress=progress, stage=stage
    )


def _identified(
    study: Study,
    table: MeasurementTable,
    *,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    add: Sequence[float] = (),
    drop: Sequence[float] = (),
    progress: Progress | None = None,
    stage: Callable[[str], None] | None = None,
) -> tuple[Processed, ModalModel]:
    files = [study.file(f) for f in table.files]
    processed = read_frfs(files, processing=processing_of(study, table), progress=progress)
    return processed, processed.identify(
        band=band or table.band,
        order=order or table.order,
        add=[*table.add, *add],
        drop=[*table.drop, *drop],
        progress=stage,
    )


def processing_of(study: Study, table: MeasurementTable) -> ProcessingOptions:
    """Return how a study wants the records of a test to be treated."""
    return ProcessingOptions(
        decay=table.exponential_window,
        window_on=table.window_on,
        window=table.window,
        estimator=table.estimator,
        use=tuple(table.use),
        leave=tuple(table.leave),
        layout=None if table.layout is None else study.file(table.layout),
        sensor_masses=tuple(table.sensor_masses.items()),
        references=tuple(table.references),
        frf_window=table.frf_window,
    )


def _measure(
    study: Study,
    table: MeasurementTable,
    name: str,
    known: tuple[Processed, ModalModel] | None = None,
) -> tuple[Measured, Processed | None, ModalModel | None]:
    options: dict[str, float | str] = {
        "calibration": table.calibration,
        "repeatability": table.repeatability,
        "position_sigma": table.position_sigma,
        "title": f"{study.name}, {name}" if name == "baseline" else study.name,
    }
    axes, spec, near = study.axes(table), study.spec(), table.match_tolerance
    if table.modes is not None:
        modes, below, beyond = modes_in_band(study, table, name)
        with _naming(study):
            modes, placed = with_places(modes, table, axes, spec)
            measured = measured_from_modes(
                modes, axes, spec, shape_sigma=table.shape_sigma, match_tolerance=near, **options
            )
        measured = _with_pairs(study, table, measured)
        return replace(measured, warnings=(*measured.warnings, *placed, *beyond), below=below), None, None
    if not table.files:
        raise StudyError(f'{study.path}: [{name}] names no data; add files = [...] or modes = "..."')
    processed, identified = _identified(study, table) if known is None else known
    with _naming(study):
        modal, placed = with_places(identified.modal, table, axes, spec)
        measured = measured_from_identified(
            replace(identified, modal=modal), axes, spec, match_tolerance=near, **options
        )
        measured = replace(measured, warnings=(*measured.warnings, *placed))
    measured = _with_pairs(study, table, measured)
    return _with_levels(measured, processed, identified), processed, identified


PAIRED = 0.01
"""Relative distance within which a stated pair means a measured mode: that of modes to drop [-]."""


def _with_pairs(study: Study, table: MeasurementTable, measured: Measured) -> Measured:
    """Return a test with the pairs that are stated of it.

    Raises
    ------
    StudyError
        If there is no mode where one is paired, or two with one model mode.
    """
    if not table.pairs:
        return measured
    partners = np.full(len(measured.frequency), UNSTATED)
    for hertz, mode in table.pairs:
        distance = np.abs(measured.frequency / hertz - 1)
        if distance.min() > PAIRED:
            found = ", ".join(f"{f:.5g}" for f in measured.frequency)
            raise StudyError(
                f"{study.path}: pairs name a mode at {hertz:g} Hz; those of the test are at {found} Hz"
            )
        partners[distance.argmin()] = mode - 1 if mode else NO_PARTNER
    stated = partners[partners >= 0]
    if len(set(stated.tolist())) < len(stated):
        raise StudyError(f"{study.path}: pairs give one model mode to two measured modes; keep one of them")
    return replace(measured, partners=partners)


def modes_in_band(study: Study, table: MeasurementTable, name: str) -> tuple[ModalData, int, tuple[str, ...]]:
    """Return the modes of a measurement's table that lie in its band, how many lie below it, and what to say of it.

    Raises
    ------
    StudyError
        If it names none, or none lies in the band.
    """
    assert table.modes is not None
    path = study.file(table.modes)
    modes = read_modes(path) if table.layout is None else _modes_of_mat(path, study.file(table.layout))
    if table.band is None:
        return modes, 0, ()
    low, high = table.band
    inside = (modes.frequency >= low) & (modes.frequency <= high)
    if not inside.any():
        raise StudyError(
            f"{study.path}: [{name}] band = [{low:g}, {high:g}] Hz holds none of the {len(modes)} modes of {path}; "
            f"they reach from {modes.frequency.min():g} to {modes.frequency.max():g} Hz"
        )
    if inside.all():
        return modes, 0, ()
    left = (
        f"{int(np.sum(~inside))} of {len(modes)} modes of {table.modes} lie outside the band and are left out"
    )
    return modes.modes(inside), int(np.sum(modes.frequency < low)), (left,)


def _modes_of_mat(path: Path, layout: Path) -> ModalData:
    modes = read_mat(path, layout)
    if not isinstance(modes, ModalData):
        raise StudyError(
            f"{layout}: its [mat] names FRFs, but modes are asked for; name shapes and dofs, or use files"
        )
    return modes


def _health(processed: Processed | None, identified: ModalModel | None) -> tuple[str, ...]:
    if processed is None or identified is None:
        return ()
    return frf_health(identified, processed.hits)


def _with_levels(measured: Measured, processed: Processed, identified: ModalModel) -> Measured:
    """Add how frequencies follow the force of the hits, where these show it.

    FRFs freed from the mass of a sensor are not those of single hits, so they are not reported.
    """
    stated = processed.processing
    if stated.sensor_masses or not processed.judged:
        return measured
    windows = Windows(decay=stated.window) if stated.window else None
    judged = [(j.test, j.verdicts) for j in processed.judged]
    found = identified.levels or level_dependence(identified, judged, windows=windows)
    if found is None:
        return measured
    return replace(measured, slope=found.slope, slope_sigma=found.slope_sigma, level=found.level)


@contextmanager
def _naming(study: Study) -> Iterator[None]:
    """Put the study's path before an error of the rooms below, which do not know it."""
    try:
        yield
    except StudyError as error:
        raise StudyError(f"{study.path}: {error}") from error
