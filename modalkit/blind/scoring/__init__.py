"""How a blind run is scored: hidden effects compared with the answers."""
