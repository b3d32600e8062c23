"""What is attacked: small whole files of every format that is read, by our own writers and by hand, as families."""

from __future__ import annotations

from corpus_exchanged import exchanged_families
from corpus_hdf5 import hdf5_families
from corpus_labelled import labelled_families
from corpus_matlab import matlab_families
from corpus_matrices import matrix_families
from corpus_nastran import nastran_families
from corpus_recorders import recorder_families
from corpus_stores import store_families
from corpus_text import table_families
from corpus_uff import uff_families
from family import Family


def families() -> list[Family]:
    """Return every family that is attacked."""
    return [
        *uff_families(),
        *table_families(),
        *recorder_families(),
        *hdf5_families(),
        *exchanged_families(),
        *matrix_families(),
        *nastran_families(),
        *labelled_families(),
        *matlab_families(),
        *store_families(),
    ]
