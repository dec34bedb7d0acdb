"""Kirigami Studio: from a silhouette to a cutter-ready kirigami sheet.

>>> import kirigami_studio as ks
>>> ks.load_target("heart")
<Target 'heart': 114 points>

The names in ``__all__`` are the Python API, told in ``docs/python-api.md``; each is loaded when it is first asked for.
``__init__.pyi`` says the same to type checkers and editors.
"""

import importlib
from difflib import get_close_matches

__version__ = "0.2.0"

_MODULES = {
    "api.target": ("Target", "load_target", "target_names"),
    "api.design": ("Sheet", "decode", "Design", "score", "siou", "Cuts", "Pieces", "Exported", "share"),
    "api.designs": ("Designs", "design", "load_project", "machine_names", "material_names", "preview"),
    "api.parts": ("ExportedParts", "Parts", "design_parts", "load_parts"),
    "api.simulation": ("Simulation",),
    "api.checked_file": ("CheckedFile", "check"),
    "evaluate.feasibility": ("Feasibility",),
    "evaluate.score": ("Score",),
    "studio.verdict": ("Verdict",),
    "pipeline.events": ("Progress",),
    "foundation.errors": ("KirigamiError",),
}
_HOMES = {name: module for module, names in _MODULES.items() for name in names}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        near = get_close_matches(name, __all__, 1)
        meant = f". Did you mean: {near[0]!r}?" if near else ""
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{meant}")
    value = getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
