"""The chain behind a table: universal file, FRFs, poles, pairs, update."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from acquisition import InputError
from modalkit.papers.a.printed import TABLES, Printed, PrintedTable
from modalkit.samples import sample_file
from modalkit.study.read import read_study
from modalkit.workflow.case import Session, open_study
from updating import Case
from updating.update import Update, update


def sample_folder() -> Path:
    """Return the folder of the sample studies, in the clone or in the installed package."""
    return sample_file("beam_dry/study.toml").parents[1]


@dataclass(frozen=True, eq=False)
class Walked:
    """A printed model's counterpart, worked out.

    Parameters
    ----------
    identified : (n_modes,) array
        Identified frequencies of the paper's modes [Hz].
    pairs : DataFrame
        Rows of the update's pairs, one for each of the paper's modes.
    result : Update
        The update with unit weights on relative frequency.
    case : Case
        The test beside the model.
    """

    identified: np.ndarray
    pairs: pd.DataFrame
    result: Update
    case: Case


@dataclass(frozen=True, eq=False)
class Walk:
    """A table's test with all its models.

    Parameters
    ----------
    table : PrintedTable
        As printed.
    session : Session
        The test, identified.
    models : tuple of Walked
        The models, in the order of the table.
    """

    table: PrintedTable
    session: Session
    models: tuple[Walked, ...]


def walk_all(folder: Path) -> tuple[Walk, ...]:
    """Work out all tests of paper A."""
    return tuple(_walk_table(table, folder) for table in TABLES)


def _walk_table(table: PrintedTable, folder: Path) -> Walk:
    session = open_test(table, folder)
    return Walk(table, session, tuple(walk(table, printed, session) for printed in table.models))


def open_test(table: PrintedTable, folder: Path) -> Session:
    """Identify the test of a table from its universal file; the baseline has no part in it."""
    study = read_study(folder / table.study / "study.toml")
    return open_study(study, with_baseline=False)


def walk(table: PrintedTable, printed: Printed, session: Session) -> Walked:
    """Pair and update one model of a table, with unit weights on the modes that the paper updated.

    Raises
    ------
    InputError
        If a published mode was not identified or has no partner.
    """
    case = replace(session.case, spec=printed.model(session.case.spec))
    frequency = case.measured.frequency
    nearest = np.array([int(np.argmin(np.abs(frequency - f))) for f in table.test])
    used = np.array([f is not None for f in printed.after])
    weights = np.zeros(len(frequency))
    weights[nearest[used]] = 1.0
    result = update(case, parameters=[table.parameter], weights=weights.tolist())
    by_mode = result.pairs.set_index("test_mode")
    missing = [m for m, row in zip(table.modes, nearest, strict=True) if row + 1 not in by_mode.index]
    if missing or len(set(nearest.tolist())) < len(nearest):
        raise InputError(
            f"{session.study.path}: mode(s) {missing or list(table.modes)} were not identified or paired"
        )
    return Walked(frequency[nearest], by_mode.loc[nearest + 1].reset_index(), result, case)
