"""The simulator's solid bodies, solved by CalculiX."""
