"""What may be hidden: each hidden effect draws its parameters, changes the test, and states which answers are right."""

from dataclasses import replace

from modalkit.simulator.hidden.base import HiddenEffect, Values
from modalkit.simulator.hidden.block import KINDS as BLOCKS
from modalkit.simulator.hidden.block import OF_BLOCKS
from modalkit.simulator.hidden.chain import CHAIN
from modalkit.simulator.hidden.frame import OF_FRAMES, SHARED
from modalkit.simulator.hidden.local import LOCAL
from modalkit.simulator.hidden.losses import LOSSES
from modalkit.simulator.hidden.material import MATERIAL
from modalkit.simulator.hidden.outside import OUTSIDE
from modalkit.simulator.hidden.supports import SUPPORTS

HIDDEN_EFFECTS: dict[str, HiddenEffect] = {
    hidden_effect.name: hidden_effect
    for hidden_effect in (*MATERIAL, *SUPPORTS, *LOCAL, *LOSSES, *CHAIN, *OUTSIDE)
}
"""All of beams, plates and bricks by name; two at once act in this order."""

FRAME_EFFECTS: dict[str, HiddenEffect] = {
    **{name: replace(HIDDEN_EFFECTS[name], kinds=("frame",)) for name in SHARED},
    **{hidden_effect.name: hidden_effect for hidden_effect in OF_FRAMES},
}
"""All of frames by name."""

BLOCK_EFFECTS: dict[str, HiddenEffect] = {
    **{name: replace(HIDDEN_EFFECTS[name], kinds=BLOCKS) for name in SHARED},
    **{hidden_effect.name: hidden_effect for hidden_effect in OF_BLOCKS},
}
"""All of ribbed plates and brackets by name."""


def effects_of(kind: str) -> dict[str, HiddenEffect]:
    """Return what may be hidden in a kind of specimen, by name."""
    if kind in BLOCKS:
        return BLOCK_EFFECTS
    return FRAME_EFFECTS if kind == "frame" else HIDDEN_EFFECTS


__all__ = ["BLOCK_EFFECTS", "FRAME_EFFECTS", "HIDDEN_EFFECTS", "HiddenEffect", "Values", "effects_of"]
