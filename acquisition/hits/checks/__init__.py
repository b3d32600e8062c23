"""What the records of a hit show: its pulse, a second hit, overload, a channel gone dead, an outlier."""

from acquisition.hits.checks.broken import why_broken
from acquisition.hits.checks.drift import without_drift
from acquisition.hits.checks.dropout import dead_from, dropouts, left_at_end
from acquisition.hits.checks.outliers import agreement, odd_responses, unexplained
from acquisition.hits.checks.overload import at_common_limit, clipped, flat_pulse, flat_waves
from acquisition.hits.checks.pulse import (
    force_bands,
    noise_level,
    pulse_ends,
    pulse_spectrum,
    pulse_width,
    upright,
)
from acquisition.hits.checks.ringing import pushes
from acquisition.hits.checks.second import second_hits
from acquisition.hits.checks.slanted import top_decay

__all__ = [
    "agreement",
    "at_common_limit",
    "clipped",
    "dead_from",
    "dropouts",
    "flat_pulse",
    "flat_waves",
    "force_bands",
    "left_at_end",
    "noise_level",
    "odd_responses",
    "pulse_ends",
    "pulse_spectrum",
    "pulse_width",
    "pushes",
    "second_hits",
    "top_decay",
    "unexplained",
    "upright",
    "why_broken",
    "without_drift",
]
