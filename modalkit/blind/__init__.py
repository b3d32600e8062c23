"""The rig that keeps secrets: blind trials of the diagnosis, and their score.

It shares no model code with the candidates: it imports nothing from the room that holds them.
"""

from modalkit.blind.run import BlindResult, Outcome, diagnose_in_subprocess, run_blind, run_trial
from modalkit.blind.scoring.score import Score, score
from modalkit.blind.seal import Seal, open_seal, seal
from modalkit.blind.trial import Trial, Truth, draw_trial, write_trial

__all__ = [
    "BlindResult",
    "Outcome",
    "Score",
    "Seal",
    "Trial",
    "Truth",
    "diagnose_in_subprocess",
    "draw_trial",
    "open_seal",
    "run_blind",
    "run_trial",
    "score",
    "seal",
    "write_trial",
]
