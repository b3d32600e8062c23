"""Modal data from tables, JSON and universal files, checked."""
