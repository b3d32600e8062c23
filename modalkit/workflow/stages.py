"""Names of the stages of long work: the terminal and the app use the same.

A diagnosis names its own: :func:`updating.diagnose` passes them to ``progress``.
"""

from __future__ import annotations

READING = "reading the files"
JUDGING = "judging the hits"
AVERAGING = "averaging the hits"
IDENTIFYING = "identifying"
PREPARING = "reading and identifying"
"""All that precedes the work with a model: files, FRFs and modes of a study."""

UPDATING = "updating"
REDRAWING = "redrawing the hits"
UPDATING_DRAWS = "updating every draw"
REPORTING = "writing the report"
DRAWING = "drawing the figures"
PLANNING = "reading the test"
TRIALS = "blind trials"
REAL = "real structures"
STUDIES = "studies"
SEARCHING = "searching for studies"
REGIONS = "comparing the regions"
TABLES = "computing the tables"
SIMULATING = "simulating the hits"
SECOND_OPINION = "computing the poles of sdypy-EMA"


def solving(basis: str) -> str:
    """Return the stage in which a forecast solves the model of a study, or the beam that stands for it."""
    return f"solving {basis}"
