"""What may be hidden: each secret draws its parameters, changes the rig, and knows what answers are right."""

from modalkit.blind.secrets.base import Secret, Values
from modalkit.blind.secrets.chain import CHAIN
from modalkit.blind.secrets.local import LOCAL
from modalkit.blind.secrets.losses import LOSSES
from modalkit.blind.secrets.material import MATERIAL
from modalkit.blind.secrets.outside import OUTSIDE
from modalkit.blind.secrets.supports import SUPPORTS

SECRETS: dict[str, Secret] = {
    secret.name: secret for secret in (*MATERIAL, *SUPPORTS, *LOCAL, *LOSSES, *CHAIN, *OUTSIDE)
}
"""All of them by name; two at once act in this order."""

__all__ = ["SECRETS", "Secret", "Values"]
