"""Claims of speed and quality -> figures that a command reproduces.

Vocabulary
----------
suite
    One set of measurements that belong together; returns a frozen value, the host prints it.
reference path
    The slow, readable way of computing the same thing; speeds are quoted as ratios to it.

May import every package but ``gui`` and ``training``.
"""
