"""Nodes, coordinate systems and trace lines: data sets 15, 18, 82, 2411, 2412, 2420, and units 164."""
