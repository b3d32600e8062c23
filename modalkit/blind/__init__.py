"""The rig with hidden effects: blind trials of the diagnosis, and their score.

It shares no model code with the candidates: it imports nothing from the room that holds them.
"""

from modalkit.blind.diagnoser import Diagnose, Diagnoser, diagnosers
from modalkit.blind.outcome import Outcome
from modalkit.blind.run import BlindResult, run_blind
from modalkit.blind.scoring.score import Score, score
from modalkit.blind.seal import Seal, open_seal, seal
from modalkit.blind.single import run_trial
from modalkit.blind.store import Checked, Store, check_store
from modalkit.blind.trial import Trial, Truth, draw_trial, write_trial
from modalkit.simulator.drawing.ranges import DrawRanges

__all__ = [
    "BlindResult",
    "Checked",
    "Diagnose",
    "Diagnoser",
    "DrawRanges",
    "Outcome",
    "Score",
    "Seal",
    "Store",
    "Trial",
    "Truth",
    "check_store",
    "diagnosers",
    "draw_trial",
    "open_seal",
    "run_blind",
    "run_trial",
    "score",
    "seal",
    "write_trial",
]
