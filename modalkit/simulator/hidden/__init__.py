"""What may be hidden: each secret draws its parameters, changes the rig, and knows what answers are right."""

from modalkit.simulator.hidden.base import HiddenEffect, Values
from modalkit.simulator.hidden.chain import CHAIN
from modalkit.simulator.hidden.local import LOCAL
from modalkit.simulator.hidden.losses import LOSSES
from modalkit.simulator.hidden.material import MATERIAL
from modalkit.simulator.hidden.outside import OUTSIDE
from modalkit.simulator.hidden.supports import SUPPORTS

HIDDEN_EFFECTS: dict[str, HiddenEffect] = {
    hidden_effect.name: hidden_effect
    for hidden_effect in (*MATERIAL, *SUPPORTS, *LOCAL, *LOSSES, *CHAIN, *OUTSIDE)
}
"""All of them by name; two at once act in this order."""

__all__ = ["HIDDEN_EFFECTS", "HiddenEffect", "Values"]
