"""How a blind run is scored: what was hidden beside what was said."""
