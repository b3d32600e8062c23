"""modalkit: from hammer hits to modes, to an updated model, to the cause of the gap between them."""

from modalkit.module_path import HOME, leave_current_folder, started_as_module

if started_as_module(
    "modalkit"
):  # before anything is imported that a file in the current folder could stand for
    leave_current_folder()

import importlib.util
import os
from typing import TYPE_CHECKING

_ROOMS = ("acquisition", "identification", "updating")


def _check_rooms() -> None:
    """Refuse to start when Python finds somebody else's module under the name of one of our rooms."""
    for room in _ROOMS:
        spec = importlib.util.find_spec(room)
        found = os.path.realpath(spec.origin) if spec is not None and spec.origin else None
        if found is None or os.path.dirname(found) != os.path.join(HOME, room):  # noqa: PTH118, PTH120
            raise ImportError(
                f"modalkit needs its own package {room!r} but Python finds {found}; "
                "rename that file or run from another folder"
            )


_check_rooms()

from acquisition.display import draw_by  # noqa: E402
from acquisition.lazy import load_on_demand  # noqa: E402
from modalkit.version import __version__  # noqa: E402

draw_by("modalkit.notebook", answers="modalkit.output.summary")

if TYPE_CHECKING:
    from acquisition import (
        FrfSet,
        Geometry,
        HammerTest,
        InputError,
        ModalData,
        ModalkitError,
        StudyError,
        bootstrap_frfs,
        decide,
        estimate_frfs,
        hits_table,
        judge_hits,
        read_uff,
        reciprocity,
        remove_sensor_mass,
        split_hits,
        write_uff,
    )
    from identification import ModalModel, cmif, identify, mvmif
    from modalkit import figures
    from modalkit.figures import draw
    from modalkit.output.modes import write_modes
    from modalkit.samples import sample_file
    from modalkit.simulation.simulate import simulate_test
    from modalkit.study.read import Study, read_study
    from modalkit.workflow.case import Session, open_study
    from modalkit.workflow.comparison import compare, mac, modes_of
    from modalkit.workflow.diagnosis import diagnose_studies
    from modalkit.workflow.existing import Modes
    from modalkit.workflow.identification import read
    from modalkit.workflow.localisation import localise_study
    from modalkit.workflow.processed import Processed
    from modalkit.workflow.processing_options import ProcessingOptions
    from modalkit.workflow.update import update_studies
    from updating import Case, DecisionRules, Diagnosis, diagnose, register
    from updating.correlation.correlate import correlate


__all__ = [
    "Case",
    "DecisionRules",
    "Diagnosis",
    "FrfSet",
    "Geometry",
    "HammerTest",
    "InputError",
    "ModalData",
    "ModalModel",
    "ModalkitError",
    "Modes",
    "Processed",
    "ProcessingOptions",
    "Session",
    "Study",
    "StudyError",
    "__version__",
    "bootstrap_frfs",
    "cmif",
    "compare",
    "correlate",
    "decide",
    "diagnose",
    "diagnose_studies",
    "draw",
    "estimate_frfs",
    "figures",
    "hits_table",
    "identify",
    "judge_hits",
    "localise_study",
    "mac",
    "modes_of",
    "mvmif",
    "open_study",
    "read",
    "read_study",
    "read_uff",
    "reciprocity",
    "register",
    "remove_sensor_mass",
    "sample_file",
    "simulate_test",
    "split_hits",
    "update_studies",
    "write_modes",
    "write_uff",
]

load_on_demand(
    __name__,
    {
        "acquisition": (
            "FrfSet Geometry HammerTest InputError ModalData ModalkitError StudyError bootstrap_frfs decide "
            "estimate_frfs hits_table judge_hits read_uff reciprocity remove_sensor_mass split_hits "
            "write_uff"
        ),
        "identification": "ModalModel cmif identify mvmif",
        "modalkit": "figures",
        ".workflow.comparison": "compare mac modes_of",
        ".workflow.diagnosis": "diagnose_studies",
        ".workflow.existing": "Modes",
        ".workflow.localisation": "localise_study",
        ".figures": "draw",
        ".workflow.update": "update_studies",
        ".workflow.processing_options": "ProcessingOptions",
        ".workflow.case": "Session open_study",
        ".workflow.identification": "read",
        ".workflow.processed": "Processed",
        ".output.modes": "write_modes",
        ".samples": "sample_file",
        ".simulation.simulate": "simulate_test",
        ".study.read": "Study read_study",
        "updating": "Case DecisionRules Diagnosis diagnose register",
        "updating.correlation.correlate": "correlate",
    },
)
