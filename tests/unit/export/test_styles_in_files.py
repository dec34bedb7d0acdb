"""Slit ends of every style, tabs and removed connectors through every profile, each file read by two readers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.lightburn import write_lightburn
from kirigami_studio.export.pdf import write_pdf
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]


@pytest.mark.parametrize(("tabs", "removed"), [(0, ()), (3, (6, 11))])
@pytest.mark.parametrize("style", ConnectorStyle)
def test_that_every_style_passes_in_every_profile(
    style: ConnectorStyle, tabs: int, removed: tuple[int, ...], make_design: MakeDesign, tmp_path: Path
) -> None:
    design = make_design(3, 4, seed=1, spread=0.3)
    plan = plan_cuts(design, 200.0, options=CutOptions(style=style, tabs=tabs, removed=removed))
    for profile in PROFILES:
        for extension in (".dxf", ".svg"):
            path = export(replace(ExportJob(design, plan=plan), profile=profile), tmp_path / f"{profile}{extension}")
            report = verify_export(plan, path, profile)
            assert report.ok, (profile, extension, [finding.text for finding in report.findings if not finding.ok])
            assert report.pieces == 1
            if path.suffix == ".dxf":
                found = check_file(path)
                assert found.ok, (profile, [problem.text for problem in found.problems])
    write_lightburn(plan, tmp_path / "sheet.lbrn2")
    write_pdf(plan, tmp_path / "sheet.pdf", "a4")
