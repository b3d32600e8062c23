"""Changes hidden by hand in the structures of `examples`: which are named, by part and size.

    python benchmarks/bench_structures.py [--seed N] [frame|machine|bracket] [NUMBER ...]

Each change is made in the bars themselves, or in the cards of a finer deck of other elements that CalculiX solves, not
by the effects; the specimen is hit, and the study, which does not hold the change, diagnosed. All stiffness and all
mass of the specimen scatter as the study's tolerances say.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "examples" / name) for name in ("matrices", "deck")]

import bracket  # noqa: E402
import frame  # noqa: E402
import machine  # noqa: E402
from bars import Structure, rows_of  # noqa: E402
from hits import hit  # noqa: E402

from modalkit.workflow.diagnosis import diagnose_studies  # noqa: E402
from updating import Diagnosis  # noqa: E402

SCATTER = (0.01, 0.003)
"""Of modulus and density, relative: the tolerances of a study that states none [-]."""

NEAR = 0.15
"""A body named so near to where it sits is there, as a share of the longest side of what is hit [-]."""

SIZES = 0.15
"""A size so near to the hidden one is right [-]."""


@dataclass(frozen=True)
class Hidden:
    """A change of a specimen, and what a right answer says.

    Parameters
    ----------
    answers : tuple of (effect, place, parameter, value)
        What was done, in the words of the effects.
    stiffness, mass : mapping
        Factors on parts.
    turned : mapping
        Options of the example's own structure: joints that turn, feet.
    further : callable, optional
        What is done to the structure of bars.
    cards : callable, optional
        Takes the number of a node nearest to a place [mm] to what is added to the deck.
    face : float
        Where the upper face of a bracket's web is [mm].
    stated : str
        What the study says besides.
    reach : float
        Longest side of the structure [m].
    also : mapping
        Other names of an effect that are as right: a hypothesis.
    """

    answers: tuple[tuple[str, str, str, float], ...]
    stiffness: Mapping[str, float] = field(default_factory=dict)
    mass: Mapping[str, float] = field(default_factory=dict)
    turned: Mapping[str, float] = field(default_factory=dict)
    further: Callable[[Structure], None] | None = None
    also: Mapping[str, str] = field(default_factory=dict)
    cards: Callable[[Callable[..., int]], str] | None = None
    face: float = bracket.SIDES[1]
    stated: str = ""
    reach: float = 0.7


def body(node: int, mass: float) -> Callable[[Structure], None]:
    """Put a steel cube on a node [kg]."""
    inertia = mass * (mass / 7850.0) ** (2 / 3) / 6
    return lambda made: made.body("hidden", node, mass, (inertia,) * 3)


def spring(node: int, axis: int, stiffness: float) -> Callable[[Structure], None]:
    """Hold a node by a spring to the ground [N/m]."""

    def hold(made: Structure) -> None:
        unit = np.zeros((6, 6))
        unit[axis, axis] = stiffness
        made.stiffness.setdefault("hidden", []).append((rows_of(node), unit))

    return hold


def turning_foot(node: int, stiffness: float) -> Callable[[Structure], None]:
    """Let a held node turn about y on a spring [N m/rad]."""

    def turn(made: Structure) -> None:
        made.held.discard(node)
        springs = np.diag([1e12, 1e12, 1e12, 1e10, stiffness, 1e10])
        made.stiffness.setdefault("hidden", []).append((rows_of(node), springs))

    return turn


def soft(region: str, left: float) -> tuple[str, str, str, float]:
    """Return the answer for a region with so much of its stiffness left."""
    return ("local_stiffness", region, "loss", 1 - left)


def heavy(region: str, factor: float) -> tuple[str, str, str, float]:
    """Return the answer for a region so many times as heavy."""
    return ("local_mass", region, "factor", factor)


def frame_node(x: float, z: float) -> int:
    """Return the first node of the frame at a place."""
    return 1 + next(
        i for i, at in enumerate(frame.frame()[0].places) if np.allclose(at, (x, 0.0, z), atol=1e-9)
    )


def machine_node(x: float, y: float, z: float) -> int:
    """Return the first node of the machine at a place."""
    return 1 + next(
        i for i, at in enumerate(machine.machine()[0].places) if np.allclose(at, (x, y, z), atol=1e-9)
    )


FRAME = (
    Hidden((soft("column_left_1", 0.85),), {"column_left_1": 0.85}),
    Hidden((soft("beam_2", 1.2),), {"beam_2": 1.2}),
    Hidden((heavy("beam_1", 1.15),), mass={"beam_1": 1.15}),
    Hidden((heavy("column_right_2", 0.9),), mass={"column_right_2": 0.9}),
    Hidden((("joint", "joint_2", "of_modelled_turning", 0.1),), turned={"joint_2": 0.1},
           also={"joint": "joint 2 is loose"}),
    Hidden((("joint", "joint_4", "of_modelled_turning", 5.0),), turned={"joint_4": 5.0}),
    Hidden((("clamp_rotation", "foot_right", "stiffness", 5000.0),),
           further=turning_foot(frame_node(frame.WIDTH, 0.0), 5000.0)),
    Hidden((("lumped_mass", f"{frame.WIDTH / 3}, 0.0, 0.4", "mass", 0.08),),
           further=body(frame_node(frame.WIDTH / 3, 0.4), 0.08)),
    Hidden((soft("column_left_1", 0.85), soft("beam_2", 0.8)), {"column_left_1": 0.85, "beam_2": 0.8}),
    Hidden((soft("column_right_1", 1.2), heavy("beam_1", 1.2)), {"column_right_1": 1.2}, {"beam_1": 1.2}),
)  # fmt: skip

FOOT = ("foot_rear_left", "foot_front_right", "foot_front_left")
MACHINE = (
    Hidden((soft(FOOT[0], 0.67),), {FOOT[0]: 0.67}),
    Hidden((soft(FOOT[1], 1.4),), {FOOT[1]: 1.4}),
    Hidden((soft("rail_left", 0.9),), {"rail_left": 0.9}),
    Hidden((soft("legs", 1.15),), {f"leg_{name}": 1.15 for name in machine.CORNERS}),
    Hidden((("lumped_mass", "0.4, 0.25, 0.3", "mass", 2.0),), further=body(machine_node(0.4, 0.25, 0.3), 2.0)),
    Hidden((heavy("rail_right", 1.15),), mass={"rail_right": 1.15}),
    Hidden((("ground_spring", "0.4, 0.25, 0.3", "stiffness", 1e6),),
           further=spring(machine_node(0.4, 0.25, 0.3), 2, 1e6)),
    Hidden((("lumped_mass", "0.8, 0.5, 0.3", "mass", 0.8),), further=body(machine_node(0.8, 0.5, 0.3), 0.8)),
    Hidden((soft(FOOT[0], 0.67), soft(FOOT[1], 0.75)), {FOOT[0]: 0.67, FOOT[1]: 0.75}),
    Hidden((soft(FOOT[2], 0.7), heavy("rail_left", 1.2)), {FOOT[2]: 0.7}, {"rail_left": 1.2}),
)  # fmt: skip

CORNER, RIM = (0.0, 60.0, 80.0), (8.0, 30.0, 80.0)
"""Of the bracket's wall: an upper corner, and the middle of its upper edge [mm]."""

THIN = """
[[hypothesis]]
name = "web is milled"
parameter = "WEBFACE.y"
range = ["-0.75 mm", "0 mm"]
"""


def weight(place: tuple[float, float, float], mass: float) -> Callable[[Callable[..., int]], str]:
    """Put a mass on a node of a deck [g]."""
    return lambda node: (
        f"*ELEMENT, TYPE=MASS, ELSET=HIDDEN\n900001, {node(*place)}\n*MASS, ELSET=HIDDEN\n{mass * 1e-6:g}\n"
    )


def stay(
    place: tuple[float, float, float], axis: int, stiffness: float
) -> Callable[[Callable[..., int]], str]:
    """Hold a node of a deck by a spring to the ground [N/mm]."""
    return lambda node: (
        f"*ELEMENT, TYPE=SPRING1, ELSET=HIDDEN\n900001, {node(*place)}\n"
        f"*SPRING, ELSET=HIDDEN\n{axis}\n{stiffness:.1f}\n"
    )


def metres(place: tuple[float, float, float]) -> str:
    """Write a place of a deck as answers are looked for [m]."""
    return ", ".join(f"{c / 1000:g}" for c in place)


BRACKET = (
    Hidden((("web is milled", "", "value", -4e-4),), face=bracket.SIDES[1] - 0.4, stated=THIN),
    Hidden((soft("WALL", 0.88),), {"WALL": 0.88}),
    Hidden((soft("BASE", 1.15),), {"BASE": 1.15}),
    Hidden((soft("WEB", 0.8),), {"WEB": 0.8}),
    Hidden((heavy("WALL", 1.1),), mass={"WALL": 1.1}),
    Hidden((("lumped_mass", metres(CORNER), "mass", 0.02),), cards=weight(CORNER, 20.0)),
    Hidden((("lumped_mass", metres(RIM), "mass", 0.02),), cards=weight(RIM, 20.0)),
    Hidden((("ground_spring", metres((0.0, 10.0, 80.0)), "stiffness", 5e5),),
           cards=stay((0.0, 10.0, 80.0), 1, 500.0)),
    Hidden((soft("WALL", 0.85), soft("BASE", 1.2)), {"WALL": 0.85, "BASE": 1.2}),
    Hidden((soft("WEB", 0.75), ("lumped_mass", metres(CORNER), "mass", 0.02)), {"WEB": 0.75},
           cards=weight(CORNER, 20.0)),
)  # fmt: skip


def of_bars(
    make: Callable[[Path], Path],
    build: Callable[..., tuple[Structure, Mapping[int, tuple[str, ...]]]],
    points: Mapping[int, object],
) -> Callable[[Hidden, Path, np.random.Generator], Path]:
    """Return what hides a change in bars, hits them, and returns the study of the unchanged ones."""

    def prepare(hidden: Hidden, folder: Path, rng: np.random.Generator) -> Path:
        study = make(folder)
        nominal, sets = build()
        (folder / "nodes.csv").write_text(nominal.table(sets), encoding="ascii")  # with the sides of joints
        specimen, _ = build(hidden.turned or None)
        if hidden.further is not None:
            hidden.further(specimen)
        factors = 1 + np.array(SCATTER) * rng.standard_normal(2)
        own = [part for part in specimen.parts if part != "hidden"]
        pair = (
            specimen.matrix("stiffness", factors={p: factors[0] * hidden.stiffness.get(p, 1.0) for p in own}),
            specimen.matrix("mass", factors={p: factors[1] * hidden.mass.get(p, 1.0) for p in own}),
        )
        hit(folder / "hits.uff", specimen, *pair, points, rate=2048.0, rng=rng)
        return study

    return prepare  # fmt: skip


def of_bricks(hidden: Hidden, folder: Path, rng: np.random.Generator) -> Path:
    """Hide a change in the finer deck of a bracket, hit it, and return the study of the unchanged one."""
    study = bracket.make(folder)
    study.write_text(study.read_text() + hidden.stated)
    modulus, density = (210000.0, 7.85e-9) * (1 + np.array(SCATTER) / (2, 1) * rng.standard_normal(2))
    text = bracket.deck(1, face=hidden.face, kind="C3D20")
    for part in ("BASE", "WALL", "WEB"):
        text = text.replace(
            f"ELSET={part}, MATERIAL=STEEL\n",
            f"ELSET={part}, MATERIAL=OF_{part}\n*MATERIAL, NAME=OF_{part}\n"
            f"*ELASTIC\n{modulus * hidden.stiffness.get(part, 1.0):.9g}, 0.3\n"
            f"*DENSITY\n{density * hidden.mass.get(part, 1.0):.9g}\n",
        )
    nodes = np.array([line.split(",") for line in text.split("*ELEMENT")[0].splitlines()[1:]], dtype=float)

    def nearest(x: float, y: float, z: float) -> int:
        return int(nodes[np.argmin(np.linalg.norm(nodes[:, 1:] - (x, y, z), axis=1)), 0])

    if hidden.cards is not None:
        text = text.replace("*BOUNDARY", f"{hidden.cards(nearest)}*BOUNDARY")
    specimen = folder / "specimen.inp"
    specimen.write_text(text, encoding="ascii")
    bracket.hit(specimen, folder, rng)
    specimen.unlink()
    return study


STRUCTURES = {
    "frame": (of_bars(frame.make, frame.frame, frame.POINTS), FRAME),
    "machine": (of_bars(machine.make, machine.machine, machine.POINTS), MACHINE),
    "bracket": (of_bricks, BRACKET),
}


def outcome(diagnosis: Diagnosis, hidden: Hidden) -> str:
    """Return named, class, unknown or wrong; of one named, whether its size is right."""
    if diagnosis.verdict in ("unknown", "none"):
        return "unknown" if diagnosis.verdict == "unknown" else "missed"
    found = [right(diagnosis, names, hidden) for names in diagnosis.sets]
    if not any(found):
        return "wrong"
    if diagnosis.verdict == "class":
        return "class"
    return "named" if found[0] == "size" else "named, size off"


def right(diagnosis: Diagnosis, names: tuple[str, ...], hidden: Hidden) -> str:
    """Return ``size`` where a set is the hidden one in place and size, ``place`` in place alone, else nothing."""
    row = next(row for row in diagnosis.ranking if row.effects == names)
    left, sizes = list(hidden.answers), True
    for i, name in enumerate(names):
        key = name + (f"#{names[:i].count(name) + 1}" if name in names[:i] else "")
        own = row.of(key)
        match = next((a for a in left if fits(name, row.forms[i], own, a, hidden)), None)
        if match is None:
            return ""
        left.remove(match)
        value = own.get(match[2])
        if value is not None and isinstance(value.value, float):
            sizes &= abs(value.value - match[3]) <= SIZES * abs(match[3])
    return "" if left else "size" if sizes else "place"


def fits(name: str, form: Mapping[str, object], own: Mapping[str, object], answer: tuple[str, str, str, float],
         hidden: Hidden) -> bool:  # fmt: skip
    """Tell whether an effect, where it is, is what was hidden."""
    effect, place = answer[:2]
    if hidden.also.get(effect) == name:
        return True
    if name != effect:
        return False
    if "," in place:
        at = [float(form[n]) for n in "xyz"]  # type: ignore[arg-type]
        return (
            float(np.linalg.norm(np.subtract(at, [float(c) for c in place.split(",")])))
            <= NEAR * hidden.reach
        )
    return not place or place in (form.get(label) for label in ("region", "joint", "support", "at"))


def answer(diagnosis: Diagnosis) -> str:
    """Return the answer in a few words."""
    said = []
    for names in diagnosis.sets[:4]:
        row = next(row for row in diagnosis.ranking if row.effects == names)
        told = {n: e for n, e in row.parameters.items() if not e.aside and isinstance(e.value, float | str)}
        sizes = [
            f"{n.partition('.')[2]} {e}" for n, e in told.items() if not n.endswith(("bulk", "compliance"))
        ]
        said.append(f"{' + '.join(names)} ({'; '.join(sizes)})")
    return " | ".join(said) or diagnosis.verdict


def run(name: str, number: int, seed: int, folder: Path) -> None:
    """Hide one change, hit, diagnose, and write a line."""
    prepare, every = STRUCTURES[name]
    hidden = replace(every[number - 1], reach=0.1 if name == "bracket" else 0.7)
    rng = np.random.default_rng((seed, number, len(name)))
    study = prepare(hidden, folder, rng)
    start = time.process_time()
    diagnosis = diagnose_studies([study])
    took = time.process_time() - start
    done = "; ".join(
        f"{effect} {place} {parameter} {value:.3g}" for effect, place, parameter, value in hidden.answers
    )
    cells = (f"{name} {number}", done, outcome(diagnosis, hidden), answer(diagnosis), f"{took:.0f} s")
    sys.stdout.write(f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |\n")
    sys.stdout.flush()


def main() -> None:
    """Run all changes, or those asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("wanted", nargs="*", help="frame, machine, bracket, numbers of changes")
    parser.add_argument("--seed", type=int, default=0, help="of scatter and noise")
    options = parser.parse_args()
    chosen = [word for word in options.wanted if word in STRUCTURES] or list(STRUCTURES)
    numbers = [int(word) for word in options.wanted if word.isdecimal()]
    sys.stdout.write("| specimen | hidden | outcome | answer | CPU |\n|---|---|---|---|---|\n")
    for name in chosen:
        for number in numbers or range(1, len(STRUCTURES[name][1]) + 1):
            with tempfile.TemporaryDirectory() as folder:
                run(name, number, options.seed, Path(folder))


if __name__ == "__main__":
    main()
