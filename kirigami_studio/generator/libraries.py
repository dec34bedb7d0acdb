"""torch's shared libraries, mapped before torch is imported, while other threads go on.

An import maps them with the interpreter's lock held: a quarter of a second in which a window stands still.  A call
through ctypes lets go of the lock, and the import that follows finds them mapped.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
import sys
from pathlib import Path

from kirigami_studio.foundation.log import topic

log = topic("generator")

#: In the order in which they need each other; the large ones, what else they need comes with them.
LIBRARIES = ("libtorch_global_deps", "libc10", "libtorch_cpu", "libtorch_python")


def map_libraries() -> tuple[str, ...]:
    """Map what there is of torch's libraries and return their names; none once torch is imported, none on Windows.

    On Windows torch maps them itself through ctypes.  A library that is missing or cannot be mapped is left to the
    import, which says what is wrong with it.
    """
    found = importlib.util.find_spec("torch")
    if "torch" in sys.modules or found is None or found.origin is None or sys.platform == "win32":
        return ()
    folder = Path(found.origin).parent / "lib"
    suffix = ".dylib" if sys.platform == "darwin" else ".so"
    # Not ctypes.CDLL(path): that one holds the lock in the versions of Python that this program runs on.
    open_ = ctypes.CDLL(None).dlopen
    open_.restype, open_.argtypes = ctypes.c_void_p, (ctypes.c_char_p, ctypes.c_int)
    mapped = []
    for name in LIBRARIES:
        path = folder / f"{name}{suffix}"
        scope = os.RTLD_GLOBAL if name == LIBRARIES[0] else os.RTLD_LOCAL
        if path.is_file() and open_(os.fsencode(path), os.RTLD_NOW | scope):
            mapped.append(name)
        else:
            log.info("%s was not mapped ahead", path)
    return tuple(mapped)
