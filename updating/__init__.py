"""Models, effects, updating and diagnosis."""

from typing import TYPE_CHECKING

from acquisition.lazy import load_on_demand

if TYPE_CHECKING:
    from updating.case import Case
    from updating.diagnosis.answer.result import Diagnosis
    from updating.diagnosis.answer.rules import DecisionRules
    from updating.diagnosis.diagnose import diagnose, diagnose_together
    from updating.effects import LIBRARY, Effect, Parameter, register
    from updating.environment import Environment
    from updating.models import Damping, Material, PointMass, Region, Spec, Structure, build_structure
    from updating.prediction.predict import Predictor
    from updating.prediction.prediction import Prediction
    from updating.test_data.axes import Axes
    from updating.test_data.measured import Measured
    from updating.test_data.taken import measured_from_identified, measured_from_modes
    from updating.tolerances import Tolerances

__all__ = [
    "LIBRARY",
    "Axes",
    "Case",
    "Damping",
    "DecisionRules",
    "Diagnosis",
    "Effect",
    "Environment",
    "Material",
    "Measured",
    "Parameter",
    "PointMass",
    "Prediction",
    "Predictor",
    "Region",
    "Spec",
    "Structure",
    "Tolerances",
    "build_structure",
    "diagnose",
    "diagnose_together",
    "measured_from_identified",
    "measured_from_modes",
    "register",
]

load_on_demand(
    __name__,
    {
        ".test_data.axes": "Axes",
        ".case": "Case",
        ".diagnosis.diagnose": "diagnose diagnose_together",
        ".diagnosis.answer.result": "Diagnosis",
        ".diagnosis.answer.rules": "DecisionRules",
        ".effects": "LIBRARY Effect Parameter register",
        ".environment": "Environment",
        ".test_data.measured": "Measured",
        ".test_data.taken": "measured_from_identified measured_from_modes",
        ".models": "Damping Material PointMass Region Spec Structure build_structure",
        ".prediction.predict": "Predictor",
        ".prediction.prediction": "Prediction",
        ".tolerances": "Tolerances",
    },
)
