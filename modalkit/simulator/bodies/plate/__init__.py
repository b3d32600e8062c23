"""The simulator's plate: Reissner-Mindlin on quintic elements, dry or in water."""
