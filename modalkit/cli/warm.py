"""Serve the command line to one who asks: ``python -m modalkit.cli.warm`` is what a warm process runs."""

from modalkit.cli import main
from modalkit.cli.on_demand import load_all
from modalkit.workers.server import serve_standard

if __name__ == "__main__":
    load_all()
    serve_standard(main)
