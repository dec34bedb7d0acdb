"""What a sheet that was trimmed to a target with holes covers is what its match says."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load


@pytest.mark.parametrize("name", ["ring", "frame", "letter-b"])
def test_that_the_silhouette_has_the_match_of_the_trim(name: str) -> None:
    target, motion = load(name), deploy(RatioField(np.ones((11, 11))))
    pose = align(motion.outline(0.0), target.points)
    cut = trim(motion, target, 0.0, pose)
    posed = PosedDesign(motion, pose, 0.0, cut)
    outer, *holes = posed.silhouette(0.0)
    shown = shapely.Polygon(outer, holes)
    common = shown.intersection(target.polygon).area
    assert common / (shown.area + target.polygon.area - common) == pytest.approx(cut.iou, abs=1e-6)
    assert cut.iou > cut.untrimmed_iou + 0.02
    assert holes
