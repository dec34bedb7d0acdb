"""Edge cuts as a file has them: they do not come back to the outline, where they would leave less than a connector."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import export
from kirigami_studio.foundation.resources import resource
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import with_choices
from kirigami_studio.studio.making import CutRequest, planned
from tests.panel_reader import edge_cuts

WIDE_MM = 1.0
#: By how much (mm) a cut may come back to the outline that it came from while it is nearer than a connector is wide.
BACK_MM = 0.02


@pytest.mark.parametrize("design", [0, 5])
def test_that_no_edge_cut_curls_back_to_the_outline(design: int, tmp_path: Path) -> None:
    document = load(resource("examples", "heart.kiri"))
    asked = CutRequest.of(replace(document, chosen=design))
    asked = replace(asked, settings=with_choices(asked.settings, {"connector_mm": WIDE_MM, "style": "centred"}))
    plan = planned(asked).plan
    path = export(ExportJob.of(asked.candidate, None, plan), tmp_path / "cut.dxf")
    cuts, outline = edge_cuts(path)
    assert cuts
    for cut in cuts:
        places = shapely.line_interpolate_point(cut, np.linspace(0.0, cut.length, 400))
        away = shapely.distance(places, outline)
        # From the outline on inwards.
        inside = away[int(np.argmin(away)) :]
        farthest = np.maximum.accumulate(inside)
        near = inside < WIDE_MM + plan.kerf_mm - BACK_MM
        assert float((farthest - inside)[near].max(initial=0.0)) < BACK_MM, cut.wkt
