"""Modes: data sets 55 and 2414."""
