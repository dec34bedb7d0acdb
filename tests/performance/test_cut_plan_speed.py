"""Speed promise of fabrication: a large sheet is planned, checked and turned into a file while one waits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from stopwatch import fastest

from kirigami_studio.export.dxf import dxf_bytes
from kirigami_studio.export.profile import DEFAULT_PROFILE, find_profile
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

VOIDS = 24


@pytest.mark.parametrize("style", list(ConnectorStyle))
def test_that_576_voids_are_planned_checked_and_written_while_one_waits(style: ConnectorStyle) -> None:
    field = RatioField.from_log10(np.random.default_rng(0).uniform(-0.7, 0.7, (VOIDS, VOIDS)))
    design, options = deploy(field), CutOptions(style=style, tabs=4)
    profile = find_profile(DEFAULT_PROFILE)
    plan = plan_cuts(design, 240.0, options=options)
    report = check_plan(plan, phi=math.pi / 4)
    assert report.ok and report.pieces == 1
    planning = fastest(lambda: plan_cuts(design, 240.0, options=options), 3)
    checking = fastest(lambda: check_plan(plan, phi=math.pi / 4), 3)
    writing = fastest(lambda: dxf_bytes(plan, "R2010", profile), 3)
    print(
        f"\n{style.value}: plan {planning:.2f} s, check {checking:.2f} s, DXF {writing:.2f} s, {len(plan.paths)} paths"
    )
    # Twelve hundred holes, arcs or bars more take their time; two seconds are promised for straight ends.
    assert planning + checking + writing < (2.0 if style is ConnectorStyle.STRAIGHT else 3.0)
