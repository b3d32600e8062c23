"""Figures of an update."""
