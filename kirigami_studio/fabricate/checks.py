"""The physics check of a plan: one piece, connectors as wide as asked, nothing cut twice; each problem has a place."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.finished_sheet import overlap_length, remaining_pieces, smallest_ligament

#: Tolerance (mm) for finished widths; coordinates are rounded to a tenth of it.
WIDTH_TOLERANCE_MM = 1e-3
#: Overlaps shorter than this (mm) are rounding.
OVERLAP_TOLERANCE_MM = 1e-6


class Severity(Enum):
    """An error spoils the sheet; a warning may."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Problem:
    """One finding.

    Attributes
    ----------
    text : str
        What is wrong and what to try.
    severity : Severity
    where : (x, y) or None, mm
        A place to look at, in the frame of the plan or file.
    """

    text: str
    severity: Severity = Severity.ERROR
    where: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Report:
    """What the check found.

    Attributes
    ----------
    problems : tuple of Problem
    pieces : int
        Pieces that the sheet is in after cutting; must be 1.
    min_connector_mm : float
        Smallest finished connector.
    min_ligament_mm : float
        Smallest finished distance between any two cuts.
    overlap_mm : float
        Length cut more than once.
    """

    problems: tuple[Problem, ...]
    pieces: int
    min_connector_mm: float
    min_ligament_mm: float
    overlap_mm: float

    @property
    def ok(self) -> bool:
        """No errors; there may be warnings."""
        return not any(problem.severity is Severity.ERROR for problem in self.problems)


def check_plan(plan: CutPlan, kerf_mm: float | None = None) -> Report:
    """Cut the plan in the computer and look at what is left.

    Parameters
    ----------
    plan : CutPlan
    kerf_mm : float, optional
        The kerf the machine really has; the plan's own unless given.
    """
    kerf = plan.kerf_mm if kerf_mm is None else kerf_mm
    cuts = [LineString(path.points) for path in plan.paths if not path.closed]
    outline = plan.on_layer(Layer.OUTLINE)[0]
    boundary = Polygon(outline.points)
    pieces = remaining_pieces(boundary, cuts, kerf)
    ligament = smallest_ligament(cuts, boundary.exterior, kerf)
    overlap = overlap_length([*cuts, boundary.exterior])
    problems = [*_piece_problems(pieces, kerf), *_connector_problems(plan, kerf)]
    if overlap > OVERLAP_TOLERANCE_MM:
        problems.append(Problem(f"{overlap:.4f} mm would be cut twice; report this design, it should not happen."))
    if ligament is not None and ligament.width_mm < plan.min_connector_mm - plan.kerf_mm + kerf - WIDTH_TOLERANCE_MM:
        problems.append(
            Problem(
                f"Two cuts leave only {ligament.width_mm:.3f} mm of material at x = {ligament.where[0]:.2f}, "
                f"y = {ligament.where[1]:.2f} mm, less than the connectors; a larger sheet "
                f"or a calmer design widens it.",
                Severity.ERROR if ligament.width_mm <= 0 else Severity.WARNING,
                ligament.where,
            )
        )
    return Report(
        problems=tuple(problems),
        pieces=len(pieces),
        min_connector_mm=plan.min_connector_mm + plan.kerf_mm - kerf,
        min_ligament_mm=ligament.width_mm if ligament is not None else float("inf"),
        overlap_mm=max(overlap, 0.0),
    )


def _piece_problems(pieces: list[Polygon], kerf: float) -> list[Problem]:
    if len(pieces) == 1:
        return []
    if not pieces:
        return [Problem(f"Nothing is left of the sheet with a kerf of {kerf:g} mm; use a smaller kerf.")]
    loose = pieces[1].representative_point()
    return [
        Problem(
            f"With a kerf of {kerf:g} mm the sheet falls into {len(pieces)} pieces, one of them at x = {loose.x:.2f}, "
            f"y = {loose.y:.2f} mm; widen the connectors or use a smaller kerf.",
            Severity.ERROR,
            (float(loose.x), float(loose.y)),
        )
    ]


def _connector_problems(plan: CutPlan, kerf: float) -> list[Problem]:
    """Connectors narrower than asked (an error) or than the material bears (a warning)."""
    hinges = plan.hinges
    if not len(hinges):
        return []
    finished = hinges.finished_mm + plan.kerf_mm - kerf
    problems = []
    short = hinges.requested_mm - finished
    if np.any(short > WIDTH_TOLERANCE_MM):
        worst = int(np.argmax(short))
        x, y = hinges.position[worst]
        problems.append(
            Problem(
                f"{int(np.sum(short > WIDTH_TOLERANCE_MM))} connectors come out narrower than asked, the worst "
                f"{finished[worst]:.3f} instead of {hinges.requested_mm[worst]:.3f} mm at x = {x:.2f}, y = {y:.2f} mm; "
                f"plan the cuts with the kerf that the machine really has.",
                Severity.ERROR,
                (float(x), float(y)),
            )
        )
    thinnest = int(np.argmin(finished))
    if finished[thinnest] <= 0.0:
        x, y = hinges.position[thinnest]
        problems.append(
            Problem(
                f"Nothing is left of the connector at x = {x:.2f}, y = {y:.2f} mm: the sheet would fall into "
                f"pieces there; widen the connectors.",
                Severity.ERROR,
                (float(x), float(y)),
            )
        )
    elif finished[thinnest] < plan.material.min_ligament_mm - WIDTH_TOLERANCE_MM:
        x, y = hinges.position[thinnest]
        problems.append(
            Problem(
                f"The connector at x = {x:.2f}, y = {y:.2f} mm is {finished[thinnest]:.3f} mm wide; "
                f"{plan.material.name!r} is known to bear {plan.material.min_ligament_mm:g} mm.",
                Severity.WARNING,
                (float(x), float(y)),
            )
        )
    return problems
