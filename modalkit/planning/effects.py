"""The effects that are looked at: those of the library that the rig's body can have and the test's data can show."""

from __future__ import annotations

from modalkit.planning.family import Family, Maker
from modalkit.planning.known import KnownTest
from modalkit.planning.local import LAYERS, LOCAL, POINTS
from modalkit.planning.whole import DAMPING, WHOLE

NOT_FORECAST = {
    "polarity": "a reversed sign stands out in every test with three points or more",
    "swapped_points": "as a point far from where it is said to be",
    "time_delay": "it turns the constants and nothing else does: seen from some 0.01 rad on",
    "absorber": "it makes a mode of its own, which no other effect does: seen wherever that lies in the band",
    "drift": "it shows in how points differ in measuring order: seen from twice what a laboratory and re-mounting do",
    "joint_nonlinearity": "it shows in how single hits differ, and needs hits of different force",
}
"""Effects that the forecast leaves out, and why."""


def families(known_test: KnownTest) -> tuple[Family, ...]:
    """Return all effects that a test is asked about.

    Parameters
    ----------
    known_test : KnownTest
        The test.
    """
    makers: tuple[Maker, ...] = (*WHOLE, *LOCAL)
    if known_test.damping_known or known_test.setup.baseline:
        makers += (*DAMPING, *LAYERS)
    if known_test.shapes:
        makers += POINTS
    made = [maker(known_test.setup) for maker in makers]
    hidden = known_test.without if known_test.shapes else (*known_test.without, "calibration_gain")
    return tuple(one for one in made if one is not None and one.name not in hidden)
