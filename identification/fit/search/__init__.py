"""Modes that a fit lacks or has too many: residual peaks, completion, split modes, the user's own selection."""
