"""Topic loggers: ``topic("lattice")`` is the logger ``kirigami_studio.lattice``."""

from __future__ import annotations

import logging


def topic(name: str) -> logging.Logger:
    """Return the logger of one package, e.g. ``topic("export")``."""
    return logging.getLogger(f"kirigami_studio.{name}")
