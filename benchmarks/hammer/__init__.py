"""Kinds of test for `bench_hammer.py`, one a module."""
