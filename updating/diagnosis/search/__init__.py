"""Sets of effects: their best parameters, their evidence, and which are examined."""
