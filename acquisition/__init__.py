"""Acquisition: universal files, raw hits and the FRFs made of them, in SI units."""

from acquisition.dof import Dof
from acquisition.errors import EstimationError, InputError, ModalkitError, StudyError
from acquisition.estimators import estimate_frfs, random_error
from acquisition.frf import FORMS, FrfSet
from acquisition.geometry import Geometry
from acquisition.hammer import HammerTest, Hits
from acquisition.modal_data import ModalData
from acquisition.modal_files import read_modes
from acquisition.quality import HitVerdict, hits_table, judge_hits, rejected_points
from acquisition.synthetic import HammerPlan, ModalSystem, hammer_test, modal_system
from acquisition.uff import DatasetInfo, UffContent, read_functions, read_uff, write_uff
from acquisition.windows import Windows, apply_windows

__all__ = [
    "FORMS",
    "DatasetInfo",
    "Dof",
    "EstimationError",
    "FrfSet",
    "Geometry",
    "HammerPlan",
    "HammerTest",
    "HitVerdict",
    "Hits",
    "InputError",
    "ModalData",
    "ModalSystem",
    "ModalkitError",
    "StudyError",
    "UffContent",
    "Windows",
    "apply_windows",
    "estimate_frfs",
    "hammer_test",
    "hits_table",
    "judge_hits",
    "modal_system",
    "random_error",
    "read_functions",
    "read_modes",
    "read_uff",
    "rejected_points",
    "write_uff",
]
