"""A synthetic hammer test: from poles and residues to raw time records with the faults of real ones."""

from acquisition.synthetic.procedure import BAD_HITS, BadHit, HammerPlan
from acquisition.synthetic.records import hammer_test
from acquisition.synthetic.system import ModalSystem, modal_system

__all__ = ["BAD_HITS", "BadHit", "HammerPlan", "ModalSystem", "hammer_test", "modal_system"]
