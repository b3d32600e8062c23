"""Effects that the forecast leaves out, and why."""

from __future__ import annotations

NOT_FORECAST = {
    "polarity": "a reversed sign stands out in every test with three points or more",
    "swapped_points": "as a point far from its stated place",
    "time_delay": "it turns the constants and nothing else does: seen from some 0.01 rad on",
    "absorber": "it makes a mode of its own, which no other effect does: seen wherever that lies in the band",
    "drift": "it shows in how points differ in measuring order: seen from twice what a laboratory and re-mounting do",
    "shear": "it is there or not: the theory of the model neglects it",
    "suspension": "cords lift the modes of the rigid body, which tests in the band of the elastic ones leave out",
    "joint_nonlinearity": "it shows in how single hits differ, and needs hits of different force",
}
"""Effects that the forecast leaves out, and why."""
