"""Specimens with one hidden cause, simulated by another theory on another mesh than the diagnosis has."""
