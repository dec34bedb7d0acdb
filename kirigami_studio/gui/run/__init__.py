"""A run of the generator: its settings, its button, its progress, and what its target and start are read as."""
