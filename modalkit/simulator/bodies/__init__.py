"""What stands on the rig: bodies of higher fidelity than any candidate, and what is fixed to them."""
