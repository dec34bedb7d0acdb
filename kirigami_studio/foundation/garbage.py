"""Collections of garbage in programs that end with their work.

Python looks for objects that refer to each other after every 700 new ones, and at all objects several times when it
ends.  A command and its workers make very many, hardly any of them in cycles: that took a tenth of their time.
"""

from __future__ import annotations

import atexit
import gc

#: New objects before Python looks at them, and how often it does before it looks at older ones, and at all.
OBJECTS, YOUNG, OLDER = 100_000, 20, 20


def collect_seldom() -> None:
    """Look for garbage seldom from now on, and not at all when the program ends.

    Not for the window: one look at so many objects holds it up.
    """
    gc.set_threshold(OBJECTS, YOUNG, OLDER)
    atexit.register(gc.freeze)
