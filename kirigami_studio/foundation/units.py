"""Units at the edges: degrees on screen, mm in cut plans and files."""

from __future__ import annotations

MM_PER_INCH = 25.4
