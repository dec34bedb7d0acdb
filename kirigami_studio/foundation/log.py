"""Topic loggers, ``topic("lattice")`` for one, and the silence of other libraries."""

from __future__ import annotations

import logging
import sys


def topic(name: str) -> logging.Logger:
    """Return the logger of one package, e.g. ``topic("export")``."""
    return logging.getLogger(f"kirigami_studio.{name}")


def quiet_libraries() -> None:
    """Keep other libraries' logs and warnings off standard error; this program's still go there.

    Python writes warnings of libraries to standard error where no program has said otherwise.  For programs, not for
    whoever imports this one; asked for by ``python -W``, warnings are shown.
    """
    logging.getLogger().addHandler(logging.NullHandler())
    if logging.lastResort is not None:
        logging.getLogger("kirigami_studio").addHandler(logging.lastResort)
    if not sys.warnoptions:
        logging.captureWarnings(True)
