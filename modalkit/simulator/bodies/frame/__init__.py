"""Frames: bars between joints, hit across their plane."""
