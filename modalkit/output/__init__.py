"""Results as text and records, and files that are written whole or not at all."""
