"""reportlab, imported without the files of the user's home folder that it would run.

On import it executes ``~/.reportlab_mods`` and ``~/.reportlab_settings``, or modules of these names from anywhere on
the path, and fails where the home folder is none.  Whatever needs reportlab imports this module first.
"""

from __future__ import annotations

import sys
from types import ModuleType

#: Modules that reportlab looks for before it opens the files; empty ones take their place while it is imported.
_SOUGHT = ("reportlab_mods", "reportlab_settings")
_placed = [name for name in _SOUGHT if name not in sys.modules]
sys.modules.update({name: ModuleType(name) for name in _placed})
try:
    from reportlab.lib.units import mm
    from reportlab.lib.utils import ImageReader
    from reportlab.pdfgen.canvas import Canvas
    from reportlab.pdfgen.pathobject import PDFPathObject
finally:
    for name in _placed:
        del sys.modules[name]

__all__ = ["Canvas", "ImageReader", "PDFPathObject", "mm"]
