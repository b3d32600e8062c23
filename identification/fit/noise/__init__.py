"""How noisy FRFs are, and what noise that is not independent does to the evidence and to poles."""
