"""Kinds of test for `bench_hammer.py`, and how one is simulated and counted."""
