"""Paper B: a free steel beam with adhesive tape on a part of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from modalkit.papers.real.case import PUBLISHED, SYNTHETIC, Case, Fact, Source, sets

_TAPE = (0.5, 0.8)
_MIRRORED = (0.2, 0.5)

_TAPED = Case(
    name="beam with tape",
    kind=PUBLISHED,
    sources=(Source(Path("tape_taped/published.toml")),),
    withheld="the tape",
    known="tape on x = 0.5 to 0.8 m",
    source="adhesive tape on both faces of segments 6 to 8; paper B, Tables 3 and 5",
    accepted=sets("damping_patch"),
    equivalent=sets("uniform_damping"),
    stands_in=sets("uniform_damping"),
    why="six damping ratios without shapes do not determine where the damping is",
    facts=(Fact("damping_patch.extent", 0.3, 0.3, "0.3 m of tape"),),
    places=(_TAPE, _MIRRORED),
)
_TAPED_FILE = replace(
    _TAPED,
    name="beam with tape, FRFs",
    kind=SYNTHETIC,
    sources=(Source(Path("tape_taped/study.toml")),),
    withheld="the tape; the bare beam is the baseline",
    known="tape on x = 0.5 to 0.8 m, loss factor 0.03",
    source="tape, loss factor and bare beam were made; frequencies and damping are the printed ones; "
    "sample_data/README.md",
    equivalent=(),
    stands_in=sets("uniform_damping"),
    why="the same loss, spread over the beam",
    facts=(
        Fact("damping_patch.extent", 0.3, 0.3, "0.3 m of tape"),
        Fact("damping_patch.loss_factor", 0.03, 0.03, "loss factor 0.03"),
    ),
    places=(_TAPE,),
)

PAPER_B: tuple[Case, ...] = (_TAPED, _TAPED_FILE)
"""The library is whole."""

PAPER_B_LEFT_OUT: tuple[Case, ...] = (_TAPED.left_out(), _TAPED_FILE.left_out())
"""The true effects are taken out of it."""
