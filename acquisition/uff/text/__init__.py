"""The bytes and lines of a universal file, before anything is understood."""
