"""Acquisition: files of every kind, raw hits and the FRFs made of them, in SI units."""

from typing import TYPE_CHECKING

from acquisition.lazy import load_on_demand

if TYPE_CHECKING:
    from acquisition.columns import (
        Layout,
        layout_from,
        propose_layout,
        read_columns,
        read_frf_columns,
        read_layout,
    )
    from acquisition.dof import Dof
    from acquisition.errors import EstimationError, InputError, ModalkitError, StudyError
    from acquisition.form import FORMS
    from acquisition.frfs.bootstrap import bootstrap_frfs
    from acquisition.frfs.estimators import estimate_frfs, random_error
    from acquisition.frfs.frf import FrfSet
    from acquisition.frfs.line_shape import FRF_WINDOWS, FrfWindow, LineShape
    from acquisition.frfs.reciprocity import reciprocity
    from acquisition.frfs.scatter import HitGroup, HitScatter, variance_of_groups
    from acquisition.frfs.sensor_mass import remove_sensor_mass
    from acquisition.frfs.spectra import ESTIMATORS, Estimator
    from acquisition.geometry import Geometry
    from acquisition.hits.force_noise import pulses_alone
    from acquisition.hits.hammer import HammerTest, Hits
    from acquisition.hits.quality import judge_hits
    from acquisition.hits.splitting import holds_several_hits, propose_trigger, split_hits
    from acquisition.hits.verdicts import (
        ForceRange,
        HitVerdict,
        decide,
        force_range,
        hits_table,
        rejected_points,
        verdicts_of,
    )
    from acquisition.hits.windows import (
        Windows,
        apply_windows,
        force_noise_decay,
        state_window,
        unstated_window,
    )
    from acquisition.mat.read import read_mat
    from acquisition.modal_data import ModalData
    from acquisition.modes.read import read_modes
    from acquisition.own_readers import installed_readers, register_reader
    from acquisition.readers import read_test, written_as_uff
    from acquisition.synthetic import HammerPlan, ModalSystem, hammer_test, modal_system
    from acquisition.uff import DatasetInfo, UffContent, read_functions, read_uff, write_uff

__all__ = [
    "ESTIMATORS",
    "FORMS",
    "FRF_WINDOWS",
    "DatasetInfo",
    "Dof",
    "EstimationError",
    "Estimator",
    "ForceRange",
    "FrfSet",
    "FrfWindow",
    "Geometry",
    "HammerPlan",
    "HammerTest",
    "HitGroup",
    "HitScatter",
    "HitVerdict",
    "Hits",
    "InputError",
    "Layout",
    "LineShape",
    "ModalData",
    "ModalSystem",
    "ModalkitError",
    "StudyError",
    "UffContent",
    "Windows",
    "apply_windows",
    "bootstrap_frfs",
    "decide",
    "estimate_frfs",
    "force_noise_decay",
    "force_range",
    "hammer_test",
    "hits_table",
    "holds_several_hits",
    "installed_readers",
    "judge_hits",
    "layout_from",
    "modal_system",
    "propose_layout",
    "propose_trigger",
    "pulses_alone",
    "random_error",
    "read_columns",
    "read_frf_columns",
    "read_functions",
    "read_layout",
    "read_mat",
    "read_modes",
    "read_test",
    "read_uff",
    "reciprocity",
    "register_reader",
    "rejected_points",
    "remove_sensor_mass",
    "split_hits",
    "state_window",
    "unstated_window",
    "variance_of_groups",
    "verdicts_of",
    "write_uff",
    "written_as_uff",
]

load_on_demand(
    __name__,
    {
        ".frfs.bootstrap": "bootstrap_frfs",
        ".columns": "Layout layout_from propose_layout read_columns read_frf_columns read_layout",
        ".dof": "Dof",
        ".errors": "EstimationError InputError ModalkitError StudyError",
        ".frfs.estimators": "estimate_frfs random_error",
        ".form": "FORMS",
        ".frfs.frf": "FrfSet",
        ".geometry": "Geometry",
        ".hits.force_noise": "pulses_alone",
        ".hits.hammer": "HammerTest Hits",
        ".mat.read": "read_mat",
        ".modal_data": "ModalData",
        ".modes.read": "read_modes",
        ".hits.quality": "judge_hits",
        ".own_readers": "installed_readers register_reader",
        ".readers": "read_test written_as_uff",
        ".frfs.reciprocity": "reciprocity",
        ".frfs.scatter": "HitGroup HitScatter variance_of_groups",
        ".frfs.sensor_mass": "remove_sensor_mass",
        ".frfs.line_shape": "FRF_WINDOWS FrfWindow LineShape",
        ".frfs.spectra": "ESTIMATORS Estimator",
        ".hits.splitting": "holds_several_hits propose_trigger split_hits",
        ".synthetic": "HammerPlan ModalSystem hammer_test modal_system",
        ".uff": "DatasetInfo UffContent read_functions read_uff write_uff",
        ".hits.verdicts": "ForceRange HitVerdict decide force_range hits_table rejected_points verdicts_of",
        ".hits.windows": "Windows apply_windows force_noise_decay state_window unstated_window",
    },
)
