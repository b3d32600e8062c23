"""What the JSON documents hold: names, types, units, meaning, and where in a result each field is taken from.

A class is an object of a document, an annotation a field: its type, then a sentence, which ends with the unit of its
numbers in brackets and states when it may be null, then :class:`modalkit.output.fields.Of` where the result calls it
otherwise. :func:`modalkit.output.fields.fill` makes the object of a result; tests hold what comes of it to the types.
The page `docs/reference/json.md` is made of these.
"""

from modalkit.output.schemas.blind import BlindDocument
from modalkit.output.schemas.correlation import ComparisonDocument, CorrelationDocument
from modalkit.output.schemas.diagnosis import DiagnosisDocument
from modalkit.output.schemas.effects import EffectsDocument
from modalkit.output.schemas.localisation import LocalisationDocument
from modalkit.output.schemas.modes import ModesDocument
from modalkit.output.schemas.plan import PlanDocument
from modalkit.output.schemas.real import RealDocument
from modalkit.output.schemas.update import UpdateDocument

DOCUMENTS = (
    ModesDocument,
    CorrelationDocument,
    ComparisonDocument,
    LocalisationDocument,
    UpdateDocument,
    DiagnosisDocument,
    EffectsDocument,
    PlanDocument,
    BlindDocument,
    RealDocument,
)
"""Every document that a command writes as JSON, in the order of the work."""
