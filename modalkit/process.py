"""From files to FRFs to modes to cases: the chain that every command walks, as far as it needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from acquisition import (
    FrfSet,
    HitVerdict,
    InputError,
    ModalData,
    StudyError,
    UffContent,
    estimate_frfs,
    judge_hits,
    read_modes,
    read_uff,
)
from identification import ModalModel, identify
from modalkit.study import MeasurementTable, Study
from updating import Case, Measured, measured_from_identified, measured_from_modes

MAX_UNCOMMON = 1e-6
"""Frequency axes that differ by more than this, relative to their end, do not go together."""


@dataclass(frozen=True, eq=False)
class Processed:
    """A test, turned into FRFs.

    Parameters
    ----------
    content : UffContent
        What the files held.
    frfs : FrfSet
        FRFs, estimated from the hits or read.
    hits : tuple of HitVerdict
        What is thought of every hit; empty where the files held FRFs.
    warnings : tuple of str
        What the user ought to know.
    """

    content: UffContent
    frfs: FrfSet
    hits: tuple[HitVerdict, ...]
    warnings: tuple[str, ...]

    def identify(self, *, band: tuple[float, float] | None = None, order: int | None = None) -> ModalModel:
        """Identify the modes of a band; see :func:`identification.identify`."""
        return identify(self.frfs, band=band, order=order)


def read(path: Path | str | Sequence[Path | str], *, decay: float = 0.0) -> Processed:
    """Read UFF files as one test and turn hits into FRFs.

    Parameters
    ----------
    path : path or sequence of paths
        The files.
    decay : float
        Decay rate of an exponential window applied before the files were written, where they do not say it
        themselves [1/s].

    Returns
    -------
    Processed

    Raises
    ------
    InputError
        If the files hold neither raw hits nor FRFs.
    """
    content = read_uff(path)
    hits: list[HitVerdict] = []
    sets: list[FrfSet] = []
    for test in content.tests:
        stated = test if test.decay or not decay else replace(test, decay=decay)
        verdicts = judge_hits(stated)
        hits += verdicts
        sets.append(estimate_frfs(stated, verdicts=verdicts))
    warnings = list(content.warnings)
    if content.frfs is not None:
        read_frfs = content.frfs
        if decay and not read_frfs.decay:
            read_frfs = replace(read_frfs, decay=decay)
        if not sets:
            sets = [read_frfs]
        else:
            warnings.append("the files hold raw hits and FRFs; the FRFs were made afresh from the hits")
    if not sets:
        names = ", ".join(str(p) for p in (path if isinstance(path, list | tuple) else [path]))
        raise InputError(f"{names}: neither raw hits nor FRFs in it; `modalkit inspect` lists what is")
    return Processed(content, _together(sets), tuple(hits), tuple(dict.fromkeys(warnings)))


def _together(sets: list[FrfSet]) -> FrfSet:
    """Join FRF sets on one frequency axis."""
    first = sets[0]
    for other in sets[1:]:
        same = len(other.frequency) == len(first.frequency) and np.allclose(
            other.frequency, first.frequency, rtol=MAX_UNCOMMON, atol=0
        )
        if not same or other.form != first.form or other.decay != first.decay:
            raise InputError(
                f"{first.source}: the hits were recorded with different rates, lengths or quantities; "
                "process them as separate tests"
            )
    if len(sets) == 1:
        return first
    joined = {
        name: None
        if any(getattr(s, name) is None for s in sets)
        else np.concatenate([getattr(s, name) for s in sets])
        for name in ("values", "coherence", "variance", "averages")
    }
    return replace(
        first,
        responses=tuple(d for s in sets for d in s.responses),
        references=tuple(d for s in sets for d in s.references),
        **joined,  # type: ignore[arg-type]
    )


@dataclass(frozen=True, eq=False)
class Session:
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
        What the user ought to know.
    """

    study: Study
    case: Case
    processed: Processed | None
    identified: ModalModel | None
    warnings: tuple[str, ...]


def open_study(study: Study) -> Session:
    """Work out the case of a study: process and identify its test and its baseline.

    Raises
    ------
    StudyError
        If the study names no data.
    """
    test, processed, identified = _measure(study, study.test, "test")
    baseline = None if study.baseline is None else _measure(study, study.baseline, "baseline")[0]
    case = Case(
        study.name,
        study.spec(),
        test,
        baseline,
        study.doubts(),
        study.surroundings(),
        study.accepted(),
    )
    warnings: tuple[str, ...] = ()
    if processed is not None and identified is not None:
        warnings = tuple(dict.fromkeys([*processed.warnings, *identified.warnings]))
    return Session(study, case, processed, identified, warnings)


def process(study: Study) -> tuple[Processed, ModalModel]:
    """Return FRFs and modes of a study's test.

    Raises
    ------
    StudyError
        If the study's test has no files.
    """
    if not study.test.files:
        raise StudyError(f"{study.path}: [test] names no files to identify; add files = [...]")
    processed = read([study.file(f) for f in study.test.files], decay=study.test.exponential_window)
    return processed, processed.identify(band=study.test.band)


def _measure(
    study: Study, table: MeasurementTable, name: str
) -> tuple[Measured, Processed | None, ModalModel | None]:
    options: dict[str, float | str] = {
        "calibration": table.calibration,
        "repeatability": table.repeatability,
        "position_sigma": table.position_sigma,
        "title": f"{study.name}, {name}" if name == "baseline" else study.name,
    }
    axes, spec = study.axes(table), study.spec()
    if table.modes is not None:
        return measured_from_modes(_modal_data(study.file(table.modes)), axes, spec, **options), None, None
    if not table.files:
        raise StudyError(f'{study.path}: [{name}] names no data; add files = [...] or modes = "..."')
    processed = read([study.file(f) for f in table.files], decay=table.exponential_window)
    identified = processed.identify(band=table.band)
    return measured_from_identified(identified, axes, spec, **options), processed, identified


def _modal_data(path: Path) -> ModalData:
    """Read modal data from a CSV file or from data set 55."""
    if path.suffix.lower() in {".csv", ".txt"}:
        return read_modes(path)
    modal = read_uff(path).modal
    if modal is None:
        raise InputError(
            f"{path}: no modes (data set 55) in it; give a CSV file of modes or another UFF file"
        )
    return modal
