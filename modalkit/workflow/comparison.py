"""Modes of any two sources side by side: MAC, pairs, who has no partner."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

import numpy as np
import pandas as pd

from acquisition import InputError, ModalData
from acquisition.arrays import AnyArray
from identification import Correlation, ModalModel, mac_table
from identification import correlate as correlate_modes
from identification import mac as mac_of_shapes
from modalkit.study.read import Study, read_study
from modalkit.workflow.case import Session, modes_in_band, process
from modalkit.workflow.existing import Modes
from modalkit.workflow.identification import read
from modalkit.workflow.processed import Processed

ModesOf: TypeAlias = ModalData | ModalModel | Modes | Processed | Session | Study | Path | str
"""What modes can be had of."""


def modes_of(source: ModesOf) -> ModalData:
    """Return the modes of anything that has some.

    Parameters
    ----------
    source : ModalData, ModalModel, Modes, Processed, Session, Study or path
        Modes; FRFs, which are identified first; a file of any of these, or a study, whose test is meant.

    Raises
    ------
    InputError
        If there are none.
    StudyError
        If a study cannot be read.
    """
    if isinstance(source, Path | str):
        is_study = Path(source).suffix.lower() == ".toml"
        return modes_of(read_study(source) if is_study else read(source))
    if isinstance(source, Processed):
        return source.identify().modal
    if isinstance(source, Session):
        return modes_of(source.study if source.identified is None else source.identified)
    if isinstance(source, Study):
        named = source.test.modes is not None
        return modes_in_band(source, source.test, "test")[0] if named else process(source)[1].modal
    if isinstance(source, ModalData):
        return source
    if isinstance(source, ModalModel | Modes):
        return source.modal
    raise InputError(f"{type(source).__name__} has no modes; give modes, FRFs, a study or a file of these")


def mac(first: ModesOf | AnyArray, second: ModesOf | AnyArray | None = None) -> pd.DataFrame:
    """MAC of two sets of modes at the degrees of freedom both have, or of one set with itself.

    Parameters
    ----------
    first, second : anything `modes_of` takes, or (n_dofs, n_modes) arrays
        The modes of rows and columns; left out, the second is the first. Arrays have the same degrees of freedom.

    Returns
    -------
    DataFrame
        Between 0 and 1; nan where only one degree of freedom is in common [-].

    Raises
    ------
    InputError
        If there are no shapes, or no degree of freedom is in common.
    """
    other = first if second is None else second
    if isinstance(first, np.ndarray) and isinstance(other, np.ndarray):
        values = mac_of_shapes(first, other)
        rows, columns = (pd.RangeIndex(1, n + 1, name="mode") for n in values.shape)
        return pd.DataFrame(values, rows, columns)
    if isinstance(first, np.ndarray) or isinstance(other, np.ndarray):
        raise InputError(
            "an array of shapes has no degrees of freedom; give arrays for both, or modes for both"
        )
    return mac_table(modes_of(first), None if second is None else modes_of(other))


def compare(first: ModesOf, second: ModesOf) -> Correlation:
    """Pair the modes of two tests by shape and frequency.

    Parameters
    ----------
    first, second : anything `modes_of` takes
        The two tests; the second takes the part of the model in what is returned.

    Returns
    -------
    identification.Correlation
        Pairs, MAC, modes without a partner, close modes that are mixed.
    """
    return correlate_modes(modes_of(first), modes_of(second))
