"""Run modalkit as ``python -m modalkit``."""

from modalkit.cli import main

if __name__ == "__main__":
    main()
