"""Serve commands on standard input and output: ``python -m modalkit.serving``."""

from modalkit.serving.server import serve_standard

if __name__ == "__main__":
    serve_standard()
