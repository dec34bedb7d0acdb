"""Importing large packages in the worker without freezing the UI; warming up before the first run.

Python code releases the interpreter's lock every few milliseconds; three things do not, and each is a UI freeze:
mapping a large library, a garbage collection among the hundreds of thousands of objects that imports have made, and the
later collections that look at all of them again.  Measured with ``tests/performance/test_ui_freeze.py``: 315 ms while
the generator was loaded and 170 to 200 ms in later collections, without what is done here.

Each package is imported once: what is garbage at that moment is never collected, so this must not be done at every job.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, partial

from kirigami_studio.foundation.steps import Cancel


@contextmanager
def quietly() -> Iterator[None]:
    """Collect no garbage during imports, and exempt everything made until then from later collections."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if collecting:
            gc.enable()


@contextmanager
def collecting_between() -> Iterator[Callable[[], object]]:
    """Collect garbage only when the function that is yielded is called, and only among what was made since then.

    Files that are read back make and drop very many objects: collections that come by themselves look at the whole
    program's, too, and hold up the window for 50 to 150 ms.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield partial(gc.collect, 1)
    finally:
        if collecting:
            gc.enable()


@cache
def settle() -> None:
    """The first window is built: what the start has made stays, and is exempt from later collections.

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
def import_verdicts() -> None:
    """Verdicts on cards, which are there as soon as a project is open."""
    with quietly():
        from kirigami_studio.studio import verdict as _verdict  # noqa: F401


@cache
def import_as_cut() -> None:
    """What closes sheets as cut, judges them, and tries fixes."""
    with quietly():
        from kirigami_studio.studio import fixes as _fixes  # noqa: F401
        from kirigami_studio.studio import looking_ahead as _looking_ahead  # noqa: F401


@cache
def import_generator() -> None:
    """What draws designs, fits them and ranks them as cut: torch, and the parts of SciPy that are imported where they
    are needed.
    """
    import_as_cut()
    with quietly():
        from scipy import interpolate as _interpolate  # noqa: F401
        from scipy import optimize as _optimize  # noqa: F401

        from kirigami_studio.generator.libraries import map_libraries

        map_libraries()
        from kirigami_studio.generator import sampler as _sampler  # noqa: F401
        from kirigami_studio.pipeline import run as _run  # noqa: F401


def warming(cancel: Cancel) -> Iterator[tuple[str, ...]]:
    """Import what the first run needs, before anyone waits for it; the last report is the generators on offer.

    There is a report after every import, so that a file which is opened meanwhile need not wait for all of them.
    """
    import_pictures()
    yield ()
    import_exporters()
    yield ()
    import_as_cut()
    yield ()
    import_generator()
    yield ()
    from kirigami_studio.generator.weights import variants

    yield variants()
