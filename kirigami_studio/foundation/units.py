"""Units at the edges: radians in code, degrees on screen; unit cells in layouts, mm in cut plans and files."""

from __future__ import annotations

MM_PER_INCH = 25.4
