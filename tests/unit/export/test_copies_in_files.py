"""Several sheets in one file: every kind of file holds them, and its readers find as many pieces as copies."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.export.dxf_check import _are_alike, check_file
from kirigami_studio.export.dxf_reading import FilePath
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.lightburn import layer_lengths
from kirigami_studio.export.paper import tile
from kirigami_studio.export.pdf import MARGIN_MM, read_pages
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.export.provenance import sidecar_record
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.options import AS_MANY_AS_FIT, ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment

COPIES = 5


@pytest.fixture(scope="module")
def design(make_design: Callable[..., Deployment]) -> Deployment:
    return make_design(2, 3, seed=1, spread=0.3)


def job_of(design: Deployment, profile: str = "any", **options: object) -> ExportJob:
    chosen = CutOptions(**({"style": ConnectorStyle.CENTRED, "copies": COPIES} | options))  # type: ignore[arg-type]
    return ExportJob(design, plan=plan_cuts(design, 60.0, kerf_mm=0.1, options=chosen), profile=profile)


def pieces_of(path: Path, plan: CutPlan) -> int:
    """Pieces that a bed-sized board falls into but for what surrounds the sheets: by ezdxf and shapely alone."""
    lines = []
    for entity in ezdxf.readfile(path).modelspace():
        points = [(x, y) for x, y, *_ in ezdxf.path.make_path(entity).flattening(1e-3)]
        lines.append(LineString(points))
    outlines = [line for line in lines if line.is_closed]
    inner = [line for line in lines if not line.is_closed]
    sheets = shapely.union_all([Polygon(line) for line in outlines])
    burned = shapely.union_all(shapely.buffer([*inner, *outlines], 0.5 * plan.kerf_mm))
    return sum(part.area > 0.01 for part in shapely.get_parts(sheets.difference(burned)))


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_every_profile_holds_the_copies_and_both_readers_and_the_check_find_them(
    profile: str, version: str, design: Deployment, tmp_path: Path
) -> None:
    job = replace(job_of(design, profile), dxf_version=version)
    plan = job.required_plan
    assert len(plan.copies) == COPIES
    path = export(job, tmp_path / "sheets.dxf")
    found = verify_export(plan, path, profile, version, design)
    assert found.ok, [finding.text for finding in found.findings if not finding.ok]
    assert found.pieces == COPIES
    assert found.size_mm == pytest.approx(plan.copies.spread_mm, abs=0.5)
    said = [finding.text for finding in found.findings if finding.code == "verify.copies"]
    assert said == ["The file holds 5 copies of the sheet, alike and 5 mm apart: cutting it leaves 5 pieces."]
    report = check_file(path)
    assert report.ok and report.pieces == COPIES, [problem.text for problem in report.problems]


def test_that_the_dxf_falls_into_as_many_pieces_as_copies_for_strangers_too(design: Deployment, tmp_path: Path) -> None:
    job = job_of(design)
    assert pieces_of(export(job, tmp_path / "sheets.dxf"), job.required_plan) == COPIES


def test_that_the_first_copy_is_the_sheet_itself(design: Deployment, tmp_path: Path) -> None:
    def strokes(job: ExportJob) -> list[list[tuple[float, ...]]]:
        path = export(job, tmp_path / "sheet.dxf")
        return [[tuple(point) for point in entity.get_points("xyb")] for entity in ezdxf.readfile(path).modelspace()]

    alone, several = strokes(job_of(design, copies=1)), strokes(job_of(design))
    assert len(several) == COPIES * len(alone)
    assert several[: len(alone)] == alone
    place = job_of(design).required_plan.copies.places[-1]
    np.testing.assert_allclose(np.array(several[-1])[:, :2], np.array(alone[-1])[:, :2] + place, atol=1e-9)


def test_that_svg_is_verified_and_lightburn_and_pdf_hold_all_lengths(design: Deployment, tmp_path: Path) -> None:
    job = job_of(design)
    plan = job.required_plan
    svg = export(job, tmp_path / "sheets.svg")
    found = verify_export(plan, svg, "any", "R2010", design)
    assert found.ok and found.pieces == COPIES
    assert found.cut_length_mm == pytest.approx(COPIES * plan.cut_length_mm, rel=1e-5)
    lengths = layer_lengths(export(replace(job, markers=True), tmp_path / "sheets.lbrn2"))
    assert sum(lengths.values()) == pytest.approx(COPIES * plan.cut_length_mm, rel=1e-4)
    circles = re.findall(r'Type="Ellipse"', (tmp_path / "sheets.lbrn2").read_text())
    assert len(circles) == COPIES * len(plan.hinges)
    (page,) = read_pages(export(job, tmp_path / "sheets.pdf"))
    assert page.size_mm[0] == pytest.approx(plan.copies.spread_mm[0] + 2 * MARGIN_MM, abs=1e-3)
    pages = read_pages(export(replace(job, paper="a4"), tmp_path / "tiles.pdf"))
    parts = len(tile(plan.copies.spread_mm, "a4").tiles)
    assert len(pages) == parts + (parts > 1)


def test_that_tabs_and_trimmed_outlines_are_copied_too(design: Deployment, tmp_path: Path) -> None:
    job = job_of(design, tabs=3)
    path = export(job, tmp_path / "tabs.dxf")
    assert verify_export(job.required_plan, path, "any").pieces == COPIES
    assert check_file(path).ok


def test_that_the_record_says_how_many(design: Deployment) -> None:
    record = sidecar_record(job_of(design))
    alone = sidecar_record(job_of(design, copies=1))
    assert record["fabrication"]["options"]["copies"] == COPIES
    assert record["expected"]["cut_length_mm"] == pytest.approx(COPIES * alone["expected"]["cut_length_mm"])
    assert record["expected"]["paths"]["OUTLINE"] == COPIES


def test_that_as_many_as_fit_follows_the_bed_of_the_machine(design: Deployment) -> None:
    plan = job_of(design, copies=AS_MANY_AS_FIT).required_plan
    bed = plan.machine.reach_mm
    assert len(plan.copies) > 9
    assert np.all(np.array(plan.copies.spread_mm) <= bed)
    larger = np.array(plan.copies.spread_mm) + np.array(plan.bounds_mm) + plan.copies.gap_mm
    assert np.all(larger > bed)


def test_that_a_copy_that_was_moved_or_bent_is_found(design: Deployment, tmp_path: Path) -> None:
    job = job_of(design)
    path = export(job, tmp_path / "sheets.dxf")
    one = len(job.required_plan.paths)
    for name, spoil in (("moved", slice(one, 2 * one)), ("bent", slice(2 * one, 2 * one + 1))):
        document = ezdxf.readfile(path)
        for entity in list(document.modelspace())[spoil]:
            entity.translate(-5.2, 0.0, 0.0) if name == "moved" else entity.translate(0.0, 0.3, 0.0)
        spoilt = tmp_path / f"{name}.dxf"
        document.saveas(spoilt)
        found = verify_export(job.required_plan, spoilt, "any")
        bad = {finding.code for finding in found.findings if not finding.ok}
        assert "verify.copies_differ" in bad, name
        assert "cut_file.copies_differ" in {problem.code for problem in check_file(spoilt).problems}, name


@pytest.mark.parametrize(("shift_mm", "arc", "alike"), [(0.0, True, True), (0.0005, True, False), (0.0, False, False)])
def test_that_chords_of_one_arc_may_begin_at_other_points_of_it(shift_mm: float, arc: bool, alike: bool) -> None:
    """A reader of a file with tabs found points 0.0022 mm apart along the arc of an edge slit of two copies.

    An arc that is moved, or a polyline with the same corners, is another line.
    """

    def sheet(place: float, begin: float, shift: float) -> list[FilePath]:
        turns = np.concatenate([[0.0], np.linspace(begin, 0.95 + begin, 20), [1.0]])
        bow = 0.3 * np.column_stack([np.cos(turns), np.sin(turns)]) + [1.0 + shift, 0.0]
        chords = float(np.linalg.norm(np.diff(bow, axis=0), axis=1).sum())
        found = [(np.array([[0.0, 0.0], [1.0, 0.0]]), 0.0), (bow, 0.3 - chords if arc else 0.0)]
        return [FilePath(points + np.array([place, 0.0]), "EDGE_SLITS", False, more) for points, more in found]

    assert _are_alike([sheet(0.0, 0.02, 0.0), sheet(5.0, 0.03, shift_mm)]) is alike
