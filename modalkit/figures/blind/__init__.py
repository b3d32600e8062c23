"""Figures of the score of a blind run."""
