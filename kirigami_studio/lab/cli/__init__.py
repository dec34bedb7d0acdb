"""Commands of the lab: ``train``, ``dataset`` and ``benchmark``, found by name."""
