"""Commands of the lab: ``train``, ``dataset`` and ``benchmark``, found by name when they are called."""
