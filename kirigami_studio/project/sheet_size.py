"""The size of the opened shape and the width of the flat sheet: one was asked for, the other one follows.

Which one was asked for is :attr:`FabricationSettings.opened_mm`.  Where the opened shape has a size, every design gets
the flat sheet that opens to it; before there is a design, the width is expected by area: panels are rigid, so a sheet
that closes again covers at the target angle what its panels and the open voids between them cover.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.opened_size import OpenedSize
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.sheet import anchor_points
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.polish.flat_sheet import width_in_cells
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import LARGEST_SHEET_MM, FabricationSettings

#: Widths this near (relative) are one width.
SAME_WIDTH = 1e-9


def sized(document: Document) -> Document:
    """The document with the flat sheet as wide as opens its chosen design to the size that was asked for."""
    target, cut = document.target, document.fabrication
    if target is None or cut.opened_mm is None:
        return document
    width = _width_mm(cut.opened_mm, flat_width(target, document.settings, document.candidate), target)
    if math.isclose(width, cut.width_mm, rel_tol=SAME_WIDTH):
        return document
    return replace(document, fabrication=replace(cut, width_mm=width))


def cut_for(document: Document, candidate: Candidate) -> FabricationSettings:
    """How a design of the document would be cut if it were the chosen one."""
    target, cut = document.target, document.fabrication
    if target is None or cut.opened_mm is None:
        return cut
    width = _width_mm(cut.opened_mm, flat_width(target, document.settings, candidate), target)
    return replace(cut, width_mm=width)


def size_of(document: Document) -> OpenedSize | None:
    """How large the document's sheet shows its target, as far as is known; None without a target."""
    target = document.target
    if target is None:
        return None
    flat = flat_width(target, document.settings, document.candidate)
    return OpenedSize.of(target, flat, document.fabrication.width_mm)


def set_opened_size(document: Document, longer_mm: float) -> Edit:
    """Let the longer side of the opened shape be so many mm; the target has that size from now on.

    Raises
    ------
    UsageError
        No length that a shape can have.
    """
    cut = replace(document.fabrication, opened_mm=longer_mm)
    target, drawing = document.target, document.drawing
    if target is not None:
        width, height = np.ptp(target.points, axis=0).tolist()
        scale = longer_mm / max(width, height)
        target, drawing = _resized(target, drawing, (scale * width, scale * height))
    changed = replace(document, target=target, fabrication=cut, drawing=drawing)
    return Edit(tr("Change the size of the opened shape"), sized(changed), merge_key="fabrication:opened_mm")


def target_as_cut(document: Document) -> tuple[Outline | None, tuple[Outline, ...]]:
    """The target and its objects, as large as the sheet shows them once it is cut."""
    target, size = document.target, size_of(document)
    if target is None or size is None or size.agrees:
        return target, document.drawing
    return _resized(target, document.drawing, size.opened)


def _resized(
    target: Outline, drawing: tuple[Outline, ...], size: tuple[float, float]
) -> tuple[Outline, tuple[Outline, ...]]:
    """A target of another width and height, mm, with the objects it was drawn of around it."""
    placed = Placed.on_board(target)
    factor = size[0] / placed.size[0]
    objects = (Placed.on_board(each).enlarged(factor, placed.centre) for each in drawing)
    return replace(target, size=size, unit="mm"), tuple(each.outline for each in objects)


def flat_width(target: Outline, settings: DesignSettings, candidate: Candidate | None) -> float:
    """Width of the flat sheet in the target's frame, where the target has area 1: of a design, or as expected."""
    if candidate is not None:
        anchors = anchor_points(candidate.final_sheet)
        return float(np.ptp(anchors[:, 0])) * candidate.final_pose.scale
    rows, columns = settings.grid
    cells = width_in_cells(settings.grid, settings.start)
    return cells / math.sqrt((rows + 1) * (columns + 1) * (1.0 + math.sin(settings.phi)))


def _width_mm(longer_mm: float, flat: float, target: Outline) -> float:
    return min(longer_mm * flat / float(np.ptp(target.points, axis=0).max()), LARGEST_SHEET_MM)
