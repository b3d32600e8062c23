"""Structures that others have measured; their data are not part of the project."""

from __future__ import annotations

from pathlib import Path

from modalkit.papers.real.case import MEASURED, Case, Source, sets

_MODELAB = Case(
    name="measured free beam",
    kind=MEASURED,
    sources=(Source(Path("frf/ModeLAB/study.toml")),),
    withheld="shear and rotary inertia",
    known="shear and rotary inertia, 36 mm on 1.29 m",
    source="length and section were not published: stiffness and level are left wide open; ModeLAB, nine FRFs of a "
    "beam as its authors measured them; four frequencies miss Euler-Bernoulli's pattern by "
    "+1.19 to -1.46 %, that with shear by 0.015 %",
    accepted=sets("shear"),
    why="none: nothing else lowers all bending modes the more the higher they are, with the shapes of a uniform beam",
    in_data=True,
)

_SLENDER_STUDY = """
[test]
modes = "modes.csv"
repeatability = 0.001
[model]
type = "beam"
length = 1.0
width = 0.03
thickness = 0.0097
elements = 40
clamped = []
theory = "euler-bernoulli"
[model.material]
E = 210e9
density = 7850.0
poisson = 0.3
[tolerances]
E = 0.2
density = 0.05
thickness = 0.1
length = 0.01
"""
_SLENDER_MODES = """frequency,sigma
51.517,0.05
142.176,0.05
278.662,0.05
460.395,0.05
687.165,0.05
958.544,0.05
"""
_SLENDER = Case(
    name="measured slender free beam",
    kind=MEASURED,
    sources=(
        Source(
            Path("uff/pyuff/measurement.uff"), text=_SLENDER_STUDY, tables=(("modes.csv", _SLENDER_MODES),)
        ),
    ),
    withheld="nothing",
    known="nothing: a uniform free beam within 0.18 %",
    source="length and section were not published: E is left wide open, only the ratios of the frequencies count; "
    "0.1 % of repeatability stands for lines 1 Hz apart; pyuff, measurement.uff (three FRFs of a free beam), modes "
    "by sdypy-EMA; theory 2.757 5.404 8.933 "
    "13.344 18.638",
    accepted=(frozenset(),),
    in_data=True,
)

MEASURED_CASES: tuple[Case, ...] = (_MODELAB, _SLENDER)
"""The library is whole."""

MEASURED_LEFT_OUT: tuple[Case, ...] = (_MODELAB.left_out(),)
"""The true effects are taken out of it."""
