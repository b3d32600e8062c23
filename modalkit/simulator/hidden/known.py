"""What of the rig a diagnosis is expected to know, and under which name of its library."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

KNOWN_SINCE: Mapping[str, str] = MappingProxyType(
    {
        "ground_spring": "ground_spring",
        "tip_spring": "ground_spring",
        "dashpot": "ground_spring",
        "suspension": "suspension",
        "channel_gain": "channel_gain",
        "taper": "taper",
        "absorber": "absorber",
        "drift": "drift",
    }
)
"""Effects that were drawn as effects outside the library, and that the library has gained since: its name for each.

They are drawn as before, among those outside, so that seeds keep their trials; what answer is right goes by this list.
"""
