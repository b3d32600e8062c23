"""The effects that are looked at: those of the library that the rig's body can have and the test's data can show."""

from __future__ import annotations

from modalkit.planning.family import Family, Maker
from modalkit.planning.known import Told
from modalkit.planning.local import LAYERS, LOCAL, POINTS
from modalkit.planning.whole import DAMPING, WHOLE

NOT_FORECAST = {
    "polarity": "a reversed sign stands out in every test with three points or more",
    "swapped_points": "as a point far from where it is said to be",
    "time_delay": "it turns the constants and nothing else does: seen from some 0.01 rad on",
    "joint_nonlinearity": "it shows in how single hits differ, and needs hits of different force",
}
"""Effects that the forecast leaves out, and why."""


def families(told: Told) -> tuple[Family, ...]:
    """Return all effects that a test is asked about.

    Parameters
    ----------
    told : Told
        The test.
    """
    makers: tuple[Maker, ...] = (*WHOLE, *LOCAL)
    if told.damping_known or told.setup.baseline:
        makers += (*DAMPING, *LAYERS)
    if told.shapes:
        makers += POINTS
    made = [maker(told.setup) for maker in makers]
    hidden = told.without if told.shapes else (*told.without, "calibration_gain")
    return tuple(one for one in made if one is not None and one.name not in hidden)
