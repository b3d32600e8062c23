"""Paper B: a free steel beam with adhesive tape on a part of it."""
