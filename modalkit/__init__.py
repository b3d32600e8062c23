"""modalkit: from hammer hits to modes, to an updated model, to the cause of the gap between them."""

from __future__ import annotations

import importlib
import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

_ROOMS = ("acquisition", "identification", "updating")


def _check_rooms() -> None:
    """Refuse to start when Python finds somebody else's module under the name of one of our rooms."""
    home = Path(__file__).resolve().parent.parent
    for room in _ROOMS:
        spec = importlib.util.find_spec(room)
        found = Path(spec.origin).resolve() if spec is not None and spec.origin else None
        if found is None or found.parent != home / room:
            raise ImportError(
                f"modalkit needs its own package {room!r} but Python finds {found}; "
                "rename that file or run from another folder"
            )


_check_rooms()

from acquisition import (  # noqa: E402
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
from identification import ModalModel, cmif, identify  # noqa: E402
from modalkit.comparing import compare, mac, modes_of  # noqa: E402
from modalkit.diagnosing import diagnose_studies  # noqa: E402
from modalkit.existing import Modes  # noqa: E402
from modalkit.fitting import update_studies  # noqa: E402
from modalkit.handling import Handling  # noqa: E402
from modalkit.process import Session, open_study  # noqa: E402
from modalkit.reading import Processed, read  # noqa: E402
from modalkit.saving import write_modes  # noqa: E402
from modalkit.simulate import simulate_test  # noqa: E402
from modalkit.study import Study, read_study  # noqa: E402
from updating import Case, Diagnosis, diagnose, register  # noqa: E402
from updating.correlation import correlate  # noqa: E402

if TYPE_CHECKING:
    from modalkit import figures
    from modalkit.figures import draw

__version__ = "0.1.0"

__all__ = [
    "Case",
    "Diagnosis",
    "FrfSet",
    "Geometry",
    "HammerTest",
    "Handling",
    "InputError",
    "ModalData",
    "ModalModel",
    "ModalkitError",
    "Modes",
    "Processed",
    "Session",
    "Study",
    "StudyError",
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
    "mac",
    "modes_of",
    "open_study",
    "read",
    "read_study",
    "read_uff",
    "reciprocity",
    "register",
    "remove_sensor_mass",
    "simulate_test",
    "split_hits",
    "update_studies",
    "write_modes",
    "write_uff",
]


def __getattr__(name: str) -> Any:
    """Load the figures, and matplotlib with them, when they are first asked for."""
    if name not in {"draw", "figures"}:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = importlib.import_module("modalkit.figures")
    return module if name == "figures" else module.draw
