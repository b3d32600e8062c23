"""Serve commands on standard input and output: ``python -m modalkit.workers``."""

from modalkit.workers.server import serve_standard

if __name__ == "__main__":
    serve_standard()
