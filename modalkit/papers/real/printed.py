"""Structures of which others print the frequencies; the numbers stand here, so that no folder is needed.

Models, tolerances and standard deviations are ours. Of each the rules of judging stand in docs/trust/real.md; they were
written before any of these was diagnosed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from modalkit.papers.real.case import PUBLISHED, Case, Fact, Sets, Source, sets

_WATER = Fact("fluid_added_mass.fluid_density", 990.0, 1000.0, "water, 990 to 1000 kg/m3")
_ONE_FACTOR = ("E", "density", "thickness")


def _alone_or_with(effect: str, others: Sequence[str]) -> Sets:
    """Return a set of one effect, and that with each of others."""
    return sets(effect, *(f"{effect} + {other}" for other in others))


def modes_table(frequencies: Sequence[float], digit: float, relative: float) -> str:
    """Return a table of modes.

    Parameters
    ----------
    frequencies : sequence of float
        As printed [Hz].
    digit : float
        Value of the last digit printed [Hz].
    relative : float
        Standard deviation of a frequency that is identified, relative to it [-].

    Returns
    -------
    str
        Frequency and standard deviation; that of the last digit is its width over the square root of twelve.
    """
    rows = [f"{f:g},{(digit**2 / 12.0 + (relative * f) ** 2) ** 0.5:.4g}" for f in frequencies]
    return "\n".join(["frequency,sigma", *rows]) + "\n"


def study_text(model: str, *, baseline: bool, repeatability: float, air: bool = False) -> str:
    """Return a study on ``after.csv``, with ``before.csv`` as its baseline where it has one."""
    before = ["[baseline]", 'modes = "before.csv"', f"repeatability = {repeatability}"] if baseline else []
    around = ["[environment]", "fluid_density = 1.2"] if air else []
    test = ["[test]", 'modes = "after.csv"', f"repeatability = {repeatability}"]
    return "\n".join([*test, *before, model.strip(), *around]) + "\n"


def _source(model: str, after: str, before: str = "", *, repeatability: float, air: bool = False) -> Source:
    text = study_text(model, baseline=bool(before), repeatability=repeatability, air=air)
    return Source(text=text, tables=(("after.csv", after), *((("before.csv", before),) if before else ())))


def _case(name: str, source: Source, known: str, origin: str, accepted: Sets, **others: Any) -> Case:
    plain = {"name": name, "kind": PUBLISHED, "sources": (source,), "known": known, "source": origin}
    return Case(**{**plain, "accepted": accepted, **others})


_SUNDQVIST = (
    "L. Monterrubio and P. Krysl, Natural frequencies of submerged structures, J. Vib. Acoust. 141 (2019) 021008, "
    "Tables 1 and 2, columns Test, after Sundqvist; whole Hz; how deep it hung and how it was held is not printed there"
)
_THICK = """
[model]
type = "plate"
length = 0.27
width = 0.1495
thickness = 0.00896
elements = [27, 15]
clamped = []
theory = "{theory}"
[model.material]
E = 208.8e9
density = 7797.0
poisson = 0.3
[tolerances]
E = 0.01
density = 0.003
thickness = 0.005
length = 0.002
width = 0.002
"""
_THICK_DRY = modes_table((641.0, 712.0, 1577.0, 1766.0, 2139.0), 1.0, 0.001)
_THICK_WET = modes_table((497.0, 575.0, 1293.0, 1408.0, 1758.0), 1.0, 0.001)


def _thick_plate() -> Iterator[Case]:
    thin, thick = _THICK.format(theory="kirchhoff"), _THICK.format(theory="mindlin")
    yield _case(
        "thick free plate, thin-plate model",
        _source(thin, _THICK_DRY, repeatability=0.001, air=True),
        "shear and rotary inertia, 9 mm on 150 by 270 mm",
        f"{_SUNDQVIST}; a thin plate's frequencies there are 1.1 to 3.3 % above those of a solid of the same steel",
        _alone_or_with("shear", _ONE_FACTOR),
        withheld="shear and rotary inertia",
    )
    yield _case(
        "thick free plate, model with shear",
        _source(thick, _THICK_DRY, repeatability=0.001, air=True),
        "nothing: within 1.4 % of a solid, all modes on one side",
        _SUNDQVIST,
        (frozenset(),),
        withheld="nothing",
    )
    water = _case(
        "thick free plate in water",
        _source(thick, _THICK_WET, _THICK_DRY, repeatability=0.001),
        "water (997 kg/m3)",
        _SUNDQVIST,
        sets("fluid_added_mass"),
        withheld="the water; the dry test is the baseline",
        why="none: one factor of mass leaves 2.2 %",
        facts=(_WATER,),
    )
    yield water
    yield replace(
        water,
        name="thick free plate in water, no baseline",
        sources=(_source(thick, _THICK_WET, repeatability=0.001),),
        withheld="the water, and the dry test",
        accepted=_alone_or_with("fluid_added_mass", _ONE_FACTOR),
    )


_LINDHOLM = (
    "the same paper, Tables 4 and 5, columns Test, after Lindholm, Kana, Chu and Abramson 1965: angular frequencies "
    "to 0.01 rad/s, scaled there to a plate of 10 m; depth and tank are not printed there"
)
_SQUARE = """
[model]
type = "plate"
length = 10.0
width = 10.0
thickness = 0.238
elements = [24, 24]
clamped = ["x0"]
[model.material]
E = 206e9
density = 7850.0
poisson = 0.3
[tolerances]
E = 0.02
density = 0.005
thickness = 0.01
length = 0.002
width = 0.002
"""
_TURN = 6.283185307179586
_SQUARE_DRY = modes_table([w / _TURN for w in (12.30, 30.78, 75.46, 99.84, 110.57)], 0.01 / _TURN, 0.003)
_SQUARE_WET = modes_table([w / _TURN for w in (6.56, 19.66, 45.32, 68.18, 74.69)], 0.01 / _TURN, 0.003)
_DRY_CAUSES = (*_ONE_FACTOR, "length", "clamp_rotation", "clamp_translation", "taper", "sensor_mass")


def _square_plate() -> Iterator[Case]:
    water = _case(
        "square cantilever plate in water",
        _source(_SQUARE, _SQUARE_WET, _SQUARE_DRY, repeatability=0.001),
        "water (1000 kg/m3)",
        _LINDHOLM,
        sets("fluid_added_mass"),
        withheld="the water; the dry test is the baseline",
        why="none: one factor of mass leaves 9 %",
        facts=(_WATER,),
    )
    yield water
    yield replace(
        water,
        name="square cantilever plate in water, no baseline",
        sources=(_source(_SQUARE, _SQUARE_WET, repeatability=0.001),),
        withheld="the water, and the dry test, which misses its model by 0.5 to 4 %",
        known="water, and what the dry one lacks",
        accepted=sets(*(f"fluid_added_mass + {cause}" for cause in _DRY_CAUSES)),
    )


_MASSENZIO = (
    "M. Massenzio, E. Jacquelin and P.-A. Ovigne 2005, Tables 1 and 2, as reprinted in the thesis of github "
    "mabdulrafea101, FEM-MS, section 4.2.8; tens of Hz where intact"
)
_CONCRETE = """
[model]
type = "beam"
length = 0.77
width = 0.05
thickness = 0.085
elements = 44
clamped = []
theory = "{theory}"
[model.material]
E = 33e9
density = 2350.0
poisson = 0.2
[tolerances]
E = 0.05
density = 0.02
thickness = 0.01
length = 0.002
width = 0.01
"""
_INTACT = modes_table((530.0, 1340.0, 2460.0, 3750.0, 5100.0), 10.0, 0.003)
_CRACKED = modes_table((407.0, 1070.0, 2083.0, 3079.0, 4245.0), 1.0, 0.003)
_CRACKS = _alone_or_with("local_stiffness", ("local_stiffness", *_ONE_FACTOR))


def _concrete_beam() -> Iterator[Case]:
    slender, deep = _CONCRETE.format(theory="euler-bernoulli"), _CONCRETE.format(theory="timoshenko")
    yield _case(
        "concrete beam, slender model",
        _source(slender, _INTACT, repeatability=0.005),
        "shear and rotary inertia, 85 mm on 770 mm",
        f"{_MASSENZIO}; a slender beam of these sizes has 552 to 7369 Hz, 4 to 44 % above",
        _alone_or_with("shear", _ONE_FACTOR),
        withheld="shear and rotary inertia",
    )
    cracked = _case(
        "concrete beam, cracked",
        _source(deep, _CRACKED, _INTACT, repeatability=0.005),
        "cracks of bending between supports 670 mm apart, under 10 kN",
        f"{_MASSENZIO}; number, depth and places of the cracks are not in the text read",
        _CRACKS,
        withheld="the cracks; the beam before is the baseline",
        why="none: one factor of stiffness leaves 2.7 %",
        places=((0.05, 0.72),),
    )
    yield cracked
    yield replace(
        cracked,
        name="concrete beam, cracked, no baseline",
        sources=(_source(deep, _CRACKED, repeatability=0.005),),
        withheld="the cracks, and the beam before",
    )


_FRITSCH = (
    "L. Fritsch, M. Bittner and J. Grashorn, Bayesian model updating benchmark, Zenodo 21803039 (CC BY-NC 4.0), "
    "measurements_br: a hundred tests of one frame; that nothing was changed between those of one series is our "
    "reading; 0.25 % is the scatter of all hundred"
)
_TESTS = {
    "30 after 11": (
        (15.56617781, 44.69788696, 70.47846973, 87.21605198),
        (15.47014662, 44.37577525, 70.33643402, 86.76591202),
    ),
    "60 after 41": (
        (15.57818421, 44.72189976, 70.75257585, 87.36411090),
        (15.55619249, 44.64387817, 70.64854039, 87.21204985),
    ),
    "100 after 81": (
        (15.58418741, 44.85194908, 70.97665530, 87.47212849),
        (15.53618182, 44.78791495, 70.75258, 87.31608530),
    ),
}
_STOREYS = 4
_STOREY = 2 * 12 * 2.1e11 * 0.0255 * 0.00045**3 / 12 / 0.0475**3
"""Two rulers of steel, 0.45 by 25.5 mm, 47.5 mm between floors [N/m]."""
_FLOOR = 0.1122
"""Mass of a floor [kg]."""


def _matrix(entries: dict[tuple[int, int], float]) -> str:
    """Return a symmetric matrix as MatrixMarket text, from its lower triangle."""
    rows = [f"{i} {j} {value:.10g}" for (i, j), value in sorted(entries.items())]
    head = ["%%MatrixMarket matrix coordinate real symmetric", f"{_STOREYS} {_STOREYS} {len(rows)}"]
    return "\n".join([*head, *rows]) + "\n"


def _storey(number: int) -> dict[tuple[int, int], float]:
    """Return the stiffness of the storey below a floor."""
    below = number - 1
    own = {(number, number): _STOREY}
    return own if not below else {**own, (below, below): _STOREY, (number, below): -_STOREY}


def _frame_files() -> tuple[tuple[str, str], ...]:
    floors = range(1, _STOREYS + 1)
    whole: dict[tuple[int, int], float] = {}
    for number in floors:
        for place, value in _storey(number).items():
            whole[place] = whole.get(place, 0.0) + value
    nodes = [f"{i},0,0,{0.0475 * i:.4f},1,{i},floor_{i}" for i in floors]
    return (
        ("K.mtx", _matrix(whole)),
        ("M.mtx", _matrix({(i, i): _FLOOR for i in floors})),
        ("nodes.csv", "\n".join(["node,x,y,z,direction,row,sets", *nodes]) + "\n"),
        *((f"k{i}.mtx", _matrix(_storey(i))) for i in floors),
        *((f"m{i}.mtx", _matrix({(i, i): _FLOOR})) for i in floors),
    )


def _frame_model() -> str:
    parts = {letter: ", ".join(f'"{letter}{i}.mtx"' for i in range(1, _STOREYS + 1)) for letter in "km"}
    regions = [f'[[model.region]]\nname = "storey_{i}"' for i in range(1, _STOREYS + 1)]
    model = [
        "[model]",
        'type = "matrices"',
        'stiffness = "K.mtx"',
        'mass_matrix = "M.mtx"',
        'nodes = "nodes.csv"',
        f"stiffness_parts = [{parts['k']}]",
        f"mass_parts = [{parts['m']}]",
    ]
    return "\n".join([*model, *regions, "[tolerances]", "E = 0.02", "density = 0.01"])


def _frame() -> Iterator[Case]:
    for tests, (before, after) in _TESTS.items():
        tables = [modes_table(row, 0.0, 0.0025) for row in (after, before)]
        source = _source(_frame_model(), *tables, repeatability=0.0005)
        yield _case(
            f"four-storey frame, test {tests}",
            replace(source, tables=(*source.tables, *_frame_files())),
            "nothing: the same frame again",
            _FRITSCH,
            (frozenset(),),
            withheld="nothing",
        )


_UBERTINI = (
    "F. Ubertini and others, Eng. Struct. 60 (2014) 265-275, Table 3, lateral modes, and section 4: cracked at "
    "mid-span in earlier work, its supports seen to roll on their bases; how deep and how soft is not stated"
)
_ROLLING = """
[model]
type = "beam"
length = 4.0
width = 0.3
thickness = 0.2
elements = 40
clamped = ["x0", "x1"]
theory = "timoshenko"
[model.material]
E = 30e9
density = 2500.0
poisson = 0.2
[tolerances]
E = 0.1
density = 0.02
thickness = 0.01
length = 0.005
width = 0.01
"""
_LATERAL = modes_table((32.71, 93.75, 192.1, 322.8, 477.3), 0.1, 0.003)
_HOLDS = ("clamp_translation", "clamp_rotation", "local_stiffness")
_ROLLED = sets(*_HOLDS, *(f"{a} + {b}" for a in _HOLDS for b in (*_HOLDS, *_ONE_FACTOR)))


def _rolling_beam() -> Iterator[Case]:
    yield _case(
        "concrete beam on supports that roll",
        _source(_ROLLING, _LATERAL, repeatability=0.002),
        "supports that give way, cracks at mid-span",
        _UBERTINI,
        _ROLLED,
        withheld="that the supports roll, and the cracks",
    )


PRINTED: tuple[Case, ...] = (
    *_thick_plate(),
    *_square_plate(),
    *_concrete_beam(),
    *_frame(),
    *_rolling_beam(),
)
"""The library is whole."""

PRINTED_LEFT_OUT: tuple[Case, ...] = tuple(
    one.left_out()
    for one in PRINTED
    if one.name in ("thick free plate in water", "square cantilever plate in water", "concrete beam, cracked")
)
"""The true effects are taken out of it."""
