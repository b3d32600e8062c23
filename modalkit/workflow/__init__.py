"""From files and studies to results: the chain that every command walks a part of."""
