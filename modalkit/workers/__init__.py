"""Warm processes: modalkit loaded once, one command after another, each in a fork of its own.

Why not the forkserver of multiprocessing, or loky: both hand the asker's command line (with the seed of a blind run),
its environment, module path, current folder and main script to every child. Beyond that a child of the forkserver keeps
descriptors that are not its own and outlives an asker that is killed; a process of loky runs one command after another,
and where one of them is killed all others fail.
"""

from modalkit.workers.client import ATTEMPTS, COMMAND, TIMEOUT, WarmProcess

__all__ = ["ATTEMPTS", "COMMAND", "TIMEOUT", "WarmProcess"]
