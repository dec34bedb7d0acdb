"""Importing large rooms in the worker without holding the window up.

Python code gives the interpreter's lock away every few milliseconds; three things do not, and each is a freeze: mapping
a large library, a collection of garbage among hundreds of thousands of objects that imports have made, and the
collections that come later and look at all of them again.  ``tests/performance/test_ui_freeze.py`` measured 315 ms
while the generator was loaded and 170 to 200 ms in later collections, without what is done here.

Each room is imported once: what is garbage at that moment is never collected, so this must not be done at every job.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache


@contextmanager
def quietly() -> Iterator[None]:
    """Collect no garbage while rooms are imported, and never again look at what has been made until then."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if collecting:
            gc.enable()


@cache
def settle() -> None:
    """The first window stands: what the start has made stays, and no collection need look at it again.

    Without it the first collections after the start took 50 ms each.
    """
    gc.freeze()


@cache
def import_pictures() -> None:
    """What reads pictures."""
    with quietly():
        from kirigami_studio.outlines import read_image as _read_image  # noqa: F401


@cache
def import_exporters() -> None:
    """What writes files, and reads them back."""
    with quietly():
        from kirigami_studio.export import verification as _verification  # noqa: F401


@cache
def import_generator() -> None:
    """What draws designs, torch included."""
    with quietly():
        from kirigami_studio.generator.libraries import map_libraries

        map_libraries()
        from kirigami_studio.generator import sampler as _sampler  # noqa: F401
        from kirigami_studio.pipeline import run as _run  # noqa: F401
