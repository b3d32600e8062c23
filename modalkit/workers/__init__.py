"""Warm processes: modalkit loaded once, one command after another, each in a fork of its own.

Why not a new interpreter for each command: loading modalkit takes two thirds of the CPU that the diagnosis of a beam
takes (6 s, 9 s). Why not the forkserver of multiprocessing, or loky: both hand the asker's command line (with the seed
of a blind run), its environment, module path, current folder and main script, which is run again, to every child, and
draw the hashes that order a set anew. Beyond that a child of the forkserver keeps descriptors that are not its own and
outlives an asker that is killed; a process of loky runs one command after another; and in a pool of either, where one
process is killed, the commands of all others fail.
"""

from modalkit.workers.client import ATTEMPTS, COMMAND, TIMEOUT, WarmProcess

__all__ = ["ATTEMPTS", "COMMAND", "TIMEOUT", "WarmProcess"]
