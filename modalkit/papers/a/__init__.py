"""Paper A: a cantilever beam and a cantilever plate of steel, dry and in a tank of water."""
