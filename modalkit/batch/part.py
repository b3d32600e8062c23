"""One part of a fleet: its modes, its updated factors, and the cause of its gap, as one record."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from acquisition import ModalData
from acquisition.errors import ModalkitError
from modalkit.output.documents import diagnosis_document
from modalkit.output.update import to_json
from modalkit.study.read import Study, read_study
from modalkit.workflow.case import Session, modes_in_band, open_study, process
from modalkit.workflow.diagnosis import diagnose_studies, warnings_of
from modalkit.workflow.update import update_studies
from updating import Measured

SCHEMA = "modalkit.part/1"


def part_document(path: Path | str) -> dict[str, Any]:
    """Identify a study, update it where it has an ``[update]``, and diagnose it where it has a ``[model]``.

    Parameters
    ----------
    path : path
        The study file.

    Returns
    -------
    dict
        ``{"schema", "title", "modes", "update", "update_failure", "diagnosis", "warnings"}``; an update that
        fails does not hold up the diagnosis.

    Raises
    ------
    ModalkitError
        If the study cannot be read, identified or diagnosed.
    """
    study = read_study(path)
    record: dict[str, Any] = {
        "schema": SCHEMA,
        "title": study.name,
        "update": None,
        "update_failure": None,
        "diagnosis": None,
    }
    if study.model is None:
        modes, warnings = _modes_alone(study)
        return record | {"modes": modes, "warnings": warnings}
    session = open_study(study)
    if "update" in study.model_fields_set:
        record |= _updated(session)
    diagnosis = diagnose_studies([session])
    return record | {
        "modes": _modes(session.case.measured),
        "diagnosis": diagnosis_document(diagnosis),
        "warnings": [*diagnosis.warnings, *warnings_of([session])],
    }


def _updated(session: Session) -> dict[str, Any]:
    """Update as ``modalkit update`` does, which does not look at the baseline."""
    alone = replace(session, case=replace(session.case, baseline=None))
    try:
        return {"update": to_json(update_studies([alone]))}
    except ModalkitError as error:
        return {"update_failure": str(error)}


def _modes_alone(study: Study) -> tuple[list[dict[str, float]], list[str]]:
    if study.test.modes is not None:
        modes, _, beyond = modes_in_band(study, study.test, "test")
        return _modes(modes), [*modes.doubts(), *beyond]
    processed, identified = process(study)
    warnings = dict.fromkeys([*processed.warnings, *identified.warnings])
    return _modes(identified.modal), list(warnings)


def _modes(modes: Measured | ModalData) -> list[dict[str, float]]:
    """Return frequencies and damping ratios with their standard deviations."""
    unknown = np.full(len(modes.frequency), np.nan)
    columns = {
        "frequency_hz": modes.frequency,
        "frequency_sigma_hz": modes.frequency_sigma,
        "damping_ratio": modes.damping,
        "damping_sigma": modes.damping_sigma,
    }
    filled = {name: unknown if values is None else np.asarray(values) for name, values in columns.items()}
    return [{name: float(values[r]) for name, values in filled.items()} for r in range(len(modes.frequency))]
