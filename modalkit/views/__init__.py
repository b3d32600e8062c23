"""Pages as data: pure functions from what is computed to JSON documents."""
