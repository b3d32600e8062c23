"""What units are in SI: the few that files of measurements and matrices state, each once.

Plain numbers, since every import meets them; what a study or a layout writes behind a number (``"376 mm"``) goes
through the table of pint, which is loaded where such a text is met (:mod:`acquisition.si_units`).
"""

GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s^2]."""

INCH, FOOT = 0.0254, 0.3048
"""[m]."""

POUND, POUNDAL = 4.4482216152605, 0.138254954376
"""Pound-force and poundal [N]."""

LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": INCH, "ft": FOOT}
"""Units of length [m]."""

FORCES = {"N": 1.0, "kN": 1e3, "mN": 1e-3, "lbf": POUND, "lb": POUND, "kgf": GRAVITY}
"""Units of force [N]."""
