"""Warm processes: modalkit loaded once, one command after another, each in a fork of its own."""

from modalkit.workers.client import ATTEMPTS, COMMAND, TIMEOUT, WarmProcess

__all__ = ["ATTEMPTS", "COMMAND", "TIMEOUT", "WarmProcess"]
