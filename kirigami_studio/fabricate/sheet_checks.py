"""Checks of single properties of a plan: pieces, connectors, panels and tabs; each finding has a place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely.geometry import Polygon

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.panel_sizes import SmallPlace, trimmed_neck_below
from kirigami_studio.foundation.arrays import FloatArray

#: Tolerance (mm) for finished widths; coordinates are rounded to a tenth of it.
WIDTH_TOLERANCE_MM = 1e-3


def piece_problems(pieces: Sequence[Polygon], boundary: Polygon, kerf_mm: float, removed: int) -> list[Problem]:
    """Errors of a sheet that does not stay in one piece; ``removed`` connectors are named as a possible reason."""
    if len(pieces) == 1:
        return []
    if not pieces:
        text = f"Nothing is left of the sheet with a kerf of {kerf_mm:g} mm; use a smaller kerf."
        return [Problem(text, Severity.ERROR, (float(boundary.centroid.x), float(boundary.centroid.y)))]
    loose = pieces[1].representative_point()
    reason = f"; {removed} connectors were removed, so put some of them back" if removed else ""
    return [
        Problem(
            f"With a kerf of {kerf_mm:g} mm the sheet falls into {len(pieces)} pieces, one of them at "
            f"x = {loose.x:.2f}, y = {loose.y:.2f} mm{reason or '; widen the connectors or use a smaller kerf'}.",
            Severity.ERROR,
            (float(loose.x), float(loose.y)),
        )
    ]


def connector_problems(plan: CutPlan, kerf_mm: float) -> list[Problem]:
    """Connectors narrower than asked (an error) or than the material bears (a warning); removed ones are as asked."""
    hinges = plan.hinges
    there = np.flatnonzero(~hinges.removed)
    problems = _uncut(plan)
    if not there.size:
        return problems
    finished = hinges.finished_mm[there] + plan.kerf_mm - kerf_mm
    short = hinges.requested_mm[there] - finished
    if np.any(short > WIDTH_TOLERANCE_MM):
        worst = int(np.argmax(short))
        x, y = hinges.position[there[worst]]
        problems.append(
            Problem(
                f"{int(np.sum(short > WIDTH_TOLERANCE_MM))} connectors come out narrower than asked, the worst "
                f"{finished[worst]:.3f} instead of {hinges.requested_mm[there[worst]]:.3f} mm at x = {x:.2f}, "
                f"y = {y:.2f} mm; plan the cuts with the kerf that the machine really has.",
                Severity.ERROR,
                (float(x), float(y)),
            )
        )
    thinnest = int(np.argmin(finished))
    return problems + _thin(plan, float(finished[thinnest]), hinges.position[there[thinnest]])


def _thin(plan: CutPlan, finished_mm: float, position: FloatArray) -> list[Problem]:
    x, y = float(position[0]), float(position[1])
    if finished_mm <= 0.0:
        text = (
            f"Nothing is left of the connector at x = {x:.2f}, y = {y:.2f} mm: the sheet would fall into "
            f"pieces there; widen the connectors."
        )
        return [Problem(text, Severity.ERROR, (x, y))]
    if finished_mm < plan.material.min_ligament_mm - WIDTH_TOLERANCE_MM:
        text = (
            f"The connector at x = {x:.2f}, y = {y:.2f} mm is {finished_mm:.3f} mm wide; "
            f"{plan.material.name!r} is known to bear {plan.material.min_ligament_mm:g} mm."
        )
        return [Problem(text, Severity.WARNING, (x, y))]
    return []


def _uncut(plan: CutPlan) -> list[Problem]:
    """Removed connectors of which something is left."""
    hinges = plan.hinges
    left = np.flatnonzero(hinges.removed & (hinges.finished_mm > 0.0))
    if not left.size:
        return []
    x, y = (float(value) for value in hinges.position[left[0]])
    text = (
        f"{left.size} removed connectors are not cut through, the first at x = {x:.2f}, y = {y:.2f} mm; "
        f"keep them or make the sheet larger."
    )
    return [Problem(text, Severity.WARNING, (x, y))]


def panel_problems(plan: CutPlan, kerf_mm: float, edge: SmallPlace | None, neck: SmallPlace | None) -> list[Problem]:
    """Warn about panels smaller than what the material bears."""
    least = plan.material.min_ligament_mm
    problems = []
    for name, small in (("edge", edge), ("neck", neck)):
        if small is not None and small.size_mm < least - WIDTH_TOLERANCE_MM:
            x, y = small.where
            text = (
                f"A panel at x = {x:.2f}, y = {y:.2f} mm has a finished {name} of {small.size_mm:.3f} mm; "
                f"{plan.material.name!r} is known to bear {least:g} mm. A larger sheet, a calmer design or a least "
                f"panel size in the fit widens it."
            )
            problems.append(Problem(text, Severity.WARNING, small.where))
    place = trimmed_neck_below(plan.panels, kerf_mm, least)
    if place is not None:
        text = (
            f"A trimmed panel at x = {place[0]:.2f}, y = {place[1]:.2f} mm has a neck below the {least:g} mm that "
            f"{plan.material.name!r} is known to bear; keep more material when trimming or make the sheet larger."
        )
        problems.append(Problem(text, Severity.WARNING, place))
    return problems


def tab_problems(plan: CutPlan) -> list[Problem]:
    """Errors of an outline with other gaps than its tabs."""
    paths = plan.on_layer(Layer.OUTLINE)
    tabs = plan.options.tabs
    opened = [path for path in paths if not path.closed]
    if len(opened) != tabs or len(paths) != max(tabs, 1):
        where = (opened or paths)[0].points[-1] if paths else np.zeros(2)
        text = (
            f"The outline consists of {len(paths)} paths, {len(opened)} of them open, but the plan has {tabs} tabs; "
            f"report this design, it should not happen."
        )
        return [Problem(text, Severity.ERROR, (float(where[0]), float(where[1])))]
    wanted = plan.options.tab_mm + plan.kerf_mm
    for path, following in zip(opened, [*opened[1:], *opened[:1]], strict=True):
        gap = float(np.linalg.norm(following.points[0] - path.points[-1]))
        if abs(gap - wanted) > WIDTH_TOLERANCE_MM:
            x, y = 0.5 * (following.points[0] + path.points[-1])
            text = (
                f"The tab at x = {x:.2f}, y = {y:.2f} mm is {gap - plan.kerf_mm:.3f} instead of "
                f"{plan.options.tab_mm:g} mm wide; report this design, it should not happen."
            )
            return [Problem(text, Severity.ERROR, (float(x), float(y)))]
    return []
