"""Runs for targets with holes: fits to the filled silhouette, trims without being asked, grids fine enough."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.geometry import box

from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.auto_grid import choose_grid, panels_for_holes
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import Construction, FabricationSettings
from kirigami_studio.studio.designing import request_for, why_untrimmed


def square(*holes: tuple[float, float, float]) -> Outline:
    """A square with square holes at (x, y), so wide."""
    rings = [shapely.get_coordinates(box(x - w / 2, y - w / 2, x + w / 2, y + w / 2))[:-1] for x, y, w in holes]
    return Outline.from_points(shapely.get_coordinates(box(-0.5, -0.5, 0.5, 0.5))[:-1], "square", holes=rings)


def test_that_a_run_opens_the_hole_without_being_asked_to_trim() -> None:
    request = Request(square((0.0, 0.0, 0.42)), (6, 6), k=1, polish=5)
    assert not request.trim and request.trims and not request.silhouette.holes
    result = best_of(request, pool=Pool(1))
    first = result.best
    assert first.trim is not None and first.trim.iou > 0.95 and not first.trim.closed_holes
    assert first.score.iou_exact < 0.85 and why_untrimmed(result) is None
    why, *_ = result.ranking.reasons(result.candidates)
    assert why.code == "rank.holes_cut_out"


def test_that_a_small_hole_needs_a_finer_grid() -> None:
    coarse, fine = choose_grid(square((0.1, 0.1, 0.4)).filled), choose_grid(square((0.1, 0.1, 0.12)))
    assert np.prod(fine.grid) > np.prod(coarse.grid) and fine.code == "grid.finer_for_holes"
    panels = (fine.grid[0] + 1) * (fine.grid[1] + 1)
    assert panels >= min(panels_for_holes(square((0.1, 0.1, 0.12))), 0.9 * 17 * 17)


def test_that_a_thin_wall_between_holes_counts_as_well() -> None:
    apart = square((-0.2, 0.0, 0.25), (0.2, 0.0, 0.25))
    near = square((-0.14, 0.0, 0.25), (0.14, 0.0, 0.25))
    assert panels_for_holes(near) > panels_for_holes(apart) > panels_for_holes(apart.filled) == 0.0


def test_that_pieces_on_pins_are_not_trimmed_for_a_hole() -> None:
    cut = FabricationSettings(material="plywood-co2", construction=Construction.PINNED, width_mm=300.0)
    request = request_for(square((0.0, 0.0, 0.4)), DesignSettings(), cut)
    assert request.pinned and request.target.holes and not request.trims and not request.silhouette.holes
