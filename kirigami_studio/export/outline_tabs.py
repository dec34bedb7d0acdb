"""The outline of a file that says it has tabs: gaps that are meant, and none besides."""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry import Polygon

from kirigami_studio.export.dxf_content import DxfContent
from kirigami_studio.fabricate.cut_plan import Layer
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.tabs import joined_ring

#: A tab may differ from the width that the file speaks of by this much (mm).
TAB_TOLERANCE_MM = 1e-3


def tabbed_outline(content: DxfContent, problems: list[Problem]) -> Polygon | None:
    """Return the area inside the outline with its tabs closed; note gaps that are no tabs.

    Parameters
    ----------
    content : DxfContent
        Its facts hold ``TABS``, ``TAB_MM`` and ``KERF_MM``.
    problems : list of Problem
        Findings are added to it.
    """
    parts = [drawn for drawn in content.paths if drawn.layer == Layer.OUTLINE.value]
    if not parts and content.facts["TABS"].isdecimal():
        # A file with everything on one layer: its outline comes last.
        parts = content.paths[-int(content.facts["TABS"]) :]
    closed = sum(drawn.closed for drawn in parts)
    if closed or f"{len(parts)}" != content.facts["TABS"]:
        text = (
            f"The file speaks of {content.facts['TABS']} tabs, but its outline consists of {len(parts)} paths, "
            f"{closed} of them closed; write the file again."
        )
        x, y = parts[0].points[-1] if parts else (0.0, 0.0)
        problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
        return None
    wanted = _number(content, "TAB_MM") + _number(content, "KERF_MM")
    ends = np.array([drawn.points[[0, -1]] for drawn in parts]).reshape(-1, 2)
    away = np.linalg.norm(ends[:, None] - ends, axis=2)
    np.fill_diagonal(away, np.inf)
    gaps = away.min(axis=1)
    # Not above, so that a fact that is no number counts as a fault.
    if not np.all(np.abs(gaps - wanted) <= TAB_TOLERANCE_MM):
        worst = int(np.argmax(np.abs(gaps - wanted)))
        x, y = ends[worst]
        text = (
            f"The outline is open by {gaps[worst]:.3f} mm at x = {x:.2f}, y = {y:.2f}, where the file speaks of tabs "
            f"with gaps of {wanted:.3f} mm; write the file again."
        )
        problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
        return None
    return Polygon(joined_ring([drawn.points for drawn in parts]))


def _number(content: DxfContent, key: str) -> float:
    try:
        return float(content.facts.get(key, "nan"))
    except ValueError:
        return math.nan
