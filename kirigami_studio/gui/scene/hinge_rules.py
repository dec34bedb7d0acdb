"""Rules that pick many connectors at once, each named as in the menu."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.slits import SHEET_EDGE
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.words import tr

#: The part of all connectors that counts as being at short or at long cuts.
QUARTER = 0.25


def every_hinge(plan: CutPlan) -> frozenset[int]:
    """All connectors."""
    return frozenset(range(len(plan.hinges)))


def edge_hinges(plan: CutPlan) -> frozenset[int]:
    """Connectors beside the sheet's edge: of slits that end there, and of cuts that open there."""
    opening = [path.cut for path in plan.on_layer(Layer.EDGE_SLITS)]
    hinges = plan.hinges
    return _numbers((hinges.through == SHEET_EDGE) | np.isin(hinges.cut, opening))


def hinges_of_short_cuts(plan: CutPlan) -> frozenset[int]:
    """The quarter of all connectors whose cuts are shortest: those of the small panels."""
    length = _cut_lengths(plan)
    return _numbers(length <= np.quantile(length, QUARTER))


def hinges_of_long_cuts(plan: CutPlan) -> frozenset[int]:
    """The quarter of all connectors whose cuts are longest: those of the large panels."""
    length = _cut_lengths(plan)
    return _numbers(length >= np.quantile(length, 1.0 - QUARTER))


#: Menu text, tooltip, rule.
RULES: tuple[tuple[str, str, Callable[[CutPlan], frozenset[int]]], ...] = (
    (tr("&All connectors"), tr("Select every connector of the sheet"), every_hinge),
    (tr("&Edge connectors"), tr("Select the connectors beside the sheet's edge"), edge_hinges),
    (tr("At &short cuts"), tr("Select the quarter of the connectors with the shortest cuts"), hinges_of_short_cuts),
    (tr("At &long cuts"), tr("Select the quarter of the connectors with the longest cuts"), hinges_of_long_cuts),
)


def _cut_lengths(plan: CutPlan) -> FloatArray:
    """Length (mm) of the cut that each hinge shortens: (H,); of a cut in several parts, of all together."""
    lengths = np.zeros(int(plan.hinges.cut.max()) + 1)
    for path in plan.paths:
        if path.cut >= 0 and path.layer is not Layer.RELIEF:
            lengths[path.cut] += path.length
    chosen: FloatArray = lengths[plan.hinges.cut]
    return chosen


def _numbers(chosen: BoolArray) -> frozenset[int]:
    return frozenset(np.flatnonzero(chosen).tolist())
