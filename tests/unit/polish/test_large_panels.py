"""Large panels: areas as polygons have them, exact slopes, and fits with more even panels at the same match."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.evenness import evenness
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.polish import even_panels
from kirigami_studio.polish.continuation import cooled
from kirigami_studio.polish.flat_sheet import uniform_sheet
from kirigami_studio.polish.large_panels import OVER_EVEN, over_even, panel_areas
from kirigami_studio.polish.levenberg import polish

GRID = 4, 5


def sheet(seed: int) -> Sheet:
    ratios = RatioField.from_log10(np.random.default_rng(seed).uniform(-0.8, 0.8, GRID))
    return uniform_sheet(GRID, start_shape("triangle")).with_field(ratios)


def test_that_areas_are_those_of_the_panels_over_their_mean() -> None:
    design = deploy(sheet(seed=2))
    area = shapely.area(shapely.polygons(design.panels(np.pi).reshape(-1, 4, 2)))
    assert panel_areas(design.compact, *GRID, area.mean()).area == pytest.approx(area / area.mean(), abs=1e-9)


def test_that_slopes_are_exact() -> None:
    nodes, step = deploy(sheet(seed=3)).compact, 1e-6
    large = panel_areas(nodes, *GRID, 0.9).area > 1.2
    found = panel_areas(nodes, *GRID, 0.9).larger(1.2)
    along_x, along_y = found.reach(len(nodes))
    move = np.random.default_rng(1).normal(size=nodes.shape)
    ahead, behind = (panel_areas(nodes + way * step * move, *GRID, 0.9).area for way in (1, -1))
    assert 0 < len(found) < large.size
    slope = (ahead - behind)[large] / (2 * step)
    assert along_x @ move[:, 0] + along_y @ move[:, 1] == pytest.approx(slope, abs=1e-7)


def test_that_only_other_starts_than_rectangles_of_square_cells_have_the_term() -> None:
    plain, square = uniform_sheet((4, 4)), uniform_sheet((4, 5), start_shape("square"))
    assert [over_even(one) for one in (plain, square, sheet(1))] == [0.0, OVER_EVEN, OVER_EVEN]


def test_that_a_fit_with_the_term_has_more_even_panels_at_nearly_the_same_match() -> None:
    target, first = load("star"), uniform_sheet((8, 9), start_shape("triangle"))

    def fitted(over: float) -> tuple[float, float]:
        with patch.object(even_panels, "over_even", lambda sheet: over):
            design = deploy(polish(first, target, phases=cooled(3e-4), free_rim=True).sheet)
        return evenness(design).area_cv, evaluate(design, target).iou_exact

    (uneven, iou), (even, beside) = fitted(0.0), fitted(OVER_EVEN)
    assert even < 0.85 * uneven
    assert beside > iou - 0.003
