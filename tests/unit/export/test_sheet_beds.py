"""Sheets of different designs in one file: both readers find each as its plan has it, wherever it lies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from shapely.geometry import LineString, Polygon

from kirigami_studio.export.bed_files import BedFile, write_beds
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.paper import tile
from kirigami_studio.export.pdf import length_in_cell, one_page, read_pages
from kirigami_studio.export.picture import LAYER_COLOUR
from kirigami_studio.export.profile import PROFILES, find_profile
from kirigami_studio.export.sheet_bed import BedSheet, allotted, sheets_on_beds
from kirigami_studio.export.verification import verify_bed
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.engraving import engraved
from kirigami_studio.fabricate.machine import machines
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import ExportError, FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

WIDTHS = (60.0, 30.0, 45.0)


@pytest.fixture(scope="module")
def sheets(make_design: Callable[..., Deployment]) -> tuple[BedSheet, ...]:
    designs = [make_design(rows, columns, seed=rows, spread=0.3) for rows, columns in ((2, 3), (2, 2), (4, 2))]
    options = CutOptions(style=ConnectorStyle.CENTRED)
    return tuple(
        BedSheet(plan_cuts(design, width, kerf_mm=0.1, options=options), design)
        for design, width in zip(designs, WIDTHS, strict=True)
    )


def never_judged(verified: object) -> str:
    return "ready_to_cut"


def outlines_of(path: Path) -> list[Polygon]:
    """Outlines in a DXF, by ezdxf and shapely alone."""
    lines = [
        LineString([(x, y) for x, y, *_ in ezdxf.path.make_path(entity).flattening(1e-3)])
        for entity in ezdxf.readfile(path).modelspace()
    ]
    return [Polygon(line) for line in lines if line.is_closed]


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_every_profile_holds_all_sheets_and_both_readers_and_the_check_find_them(
    profile: str, version: str, sheets: tuple[BedSheet, ...], tmp_path: Path
) -> None:
    (bed,) = sheets_on_beds(sheets)
    found = write_beds([bed], tmp_path / "cut.dxf", BedFile(profile, version), never_judged)
    assert len(found.verifications) == len(sheets) and all(one.ok for one in found.verifications)
    assert [one.pieces for one in found.verifications] == [1, 1, 1]
    report = check_file(found.files[0])
    assert report.ok and report.pieces == len(sheets), [problem.text for problem in report.problems]
    assert [one.record.design for one in report.sheets] == [bed.sheets[k].plan.design_hash for k in range(3)]
    assert report.min_ligament_mm == pytest.approx(min(one.min_ligament_mm for one in report.sheets))


def test_that_the_sheets_lie_apart_on_the_bed_as_another_reader_sees_them(sheets, tmp_path: Path) -> None:
    (bed,) = sheets_on_beds(sheets)
    write_beds([bed], tmp_path / "cut.dxf", BedFile(), never_judged)
    outlines = outlines_of(tmp_path / "cut.dxf")
    assert len(outlines) == 3
    near = [one.distance(other) for at, one in enumerate(outlines) for other in outlines[:at]]
    assert min(near) >= bed.gap_mm - 0.1 - 1e-9
    assert min(low for one in outlines for low in one.bounds[:2]) >= 0.0
    areas = sorted(one.area for one in outlines)
    assert areas == pytest.approx(sorted(Polygon(sheet.plan.outline).area for sheet in sheets), rel=1e-3)


@pytest.mark.parametrize("kind", [".svg", ".lbrn2"])
def test_that_other_kinds_of_cut_files_hold_them_too(kind: str, sheets, tmp_path: Path) -> None:
    found = write_beds(sheets_on_beds(sheets), tmp_path / f"cut{kind}", BedFile(), never_judged)
    assert all(one.ok for one in found.verifications) and len(found.verifications) == 3
    report = check_file(found.files[0])
    assert report.ok and report.pieces == 3


def test_that_names_are_engraved_on_every_sheet_before_anything_is_cut(sheets, tmp_path: Path) -> None:
    named = [
        replace(sheet, plan=replace(engraved(sheet.plan, name), name=name))
        for sheet, name in zip(sheets, "ABC", strict=True)
    ]
    assert sum(bool(sheet.plan.engraving) for sheet in named) >= 2
    found = write_beds(sheets_on_beds(named), tmp_path / "cut.dxf", BedFile(), never_judged)
    assert all(one.ok for one in found.verifications)
    assert any(finding.code == "verify.name" for one in found.verifications for finding in one.findings)
    assert check_file(found.files[0]).ok


def small_machine(plan: CutPlan, width: float, height: float) -> CutPlan:
    machine = replace(next(iter(machines().items.values())), bed_width_mm=width, bed_height_mm=height)
    return replace(plan, chosen_machine=machine)


def test_that_what_one_bed_has_no_room_for_is_a_file_of_its_own(sheets, tmp_path: Path) -> None:
    small = [replace(sheet, plan=small_machine(sheet.plan, 75.0, 75.0)) for sheet in sheets]
    beds = sheets_on_beds(small)
    assert len(beds) > 1
    found = write_beds(beds, tmp_path / "cut.dxf", BedFile(record=b""), never_judged)
    assert [path.name for path in found.files] == ["cut.dxf", "cut-b2.dxf", "cut-b3.dxf"][: len(beds)]
    assert len(found.verifications) == 3 and all(one.ok for one in found.verifications)
    # In the order of the sheets, whichever bed they lie on.
    lengths = [one.cut_length_mm for one in found.verifications]
    assert lengths == pytest.approx([sheet.plan.cut_length_mm for sheet in sheets], rel=1e-6)


def damaged(path: Path, change: Callable[[ezdxf.layouts.Modelspace], None]) -> None:
    document = ezdxf.readfile(path)
    change(document.modelspace())
    document.saveas(path)


def test_that_a_moved_lost_or_added_line_is_found_in_its_sheet(sheets, tmp_path: Path) -> None:
    (bed,) = sheets_on_beds(sheets)
    for nth, change in enumerate(
        (
            lambda space: space.delete_entity(list(space)[-2]),
            lambda space: list(space)[3].translate(0.5, 0.0, 0.0),
            lambda space: space.add_lwpolyline([(1, 1), (2, 2)], dxfattribs={"layer": next(iter(space)).dxf.layer}),
        )
    ):
        path = tmp_path / f"cut{nth}.dxf"
        write_beds([bed], path, BedFile(), never_judged)
        damaged(path, change)
        assert not all(one.ok for one in verify_bed(bed, path, "any" if "any" in PROFILES else "single"))
        assert nth == 1 or not check_file(path).ok


def test_that_sheets_that_were_pushed_together_are_found(sheets, tmp_path: Path) -> None:
    (bed,) = sheets_on_beds(sheets)
    near = [replace(place, shift=place.shift * (0.2 if at else 1.0)) for at, place in enumerate(bed.places)]
    crowded = replace(bed, places=tuple(near))
    found = write_beds([crowded], tmp_path / "cut.dxf", BedFile(), never_judged)
    assert not any(one.ok for one in found.verifications)
    assert "verify.sheets_meet" in {finding.code for finding in found.verifications[0].findings}


def test_that_a_kerf_as_wide_as_the_gap_and_other_kinds_of_files_are_refused(sheets, tmp_path: Path) -> None:
    tight = [
        replace(sheet, plan=replace(sheet.plan, options=replace(sheet.plan.options, copy_gap_mm=0.1)))
        for sheet in sheets
    ]
    with refused(FabricationError, "copies.gap_too_narrow"):
        sheets_on_beds(tight)
    with refused(ExportError, "parts.no_such_file"):
        write_beds(sheets_on_beds(sheets), tmp_path / "cut.stl", BedFile(), never_judged)


def test_that_strokes_are_told_apart_by_their_place_on_their_layer() -> None:
    planned = [["a", "a", "b"], ["a", "b"]]
    assert allotted(["a", "a", "b", "a", "b"], planned) == [0, 0, 0, 1, 1]
    assert allotted(["a", "a", "a", "b", "b"], planned) == [0, 0, 1, 0, 1]  # layer after layer
    assert allotted(["a", "c", "a", "a", "a"], planned) == [0, 1, 0, 1, 1]  # what is too much


def test_that_the_same_sheets_give_the_same_bytes(sheets, tmp_path: Path) -> None:
    for name in ("one", "two"):
        write_beds(sheets_on_beds(sheets), tmp_path / f"{name}.dxf", BedFile(record=b"design"), never_judged)
    assert (tmp_path / "one.dxf").read_bytes() == (tmp_path / "two.dxf").read_bytes()
    assert find_profile("any").key == "any" and np.isfinite(sheets[0].plan.cut_length_mm)


@pytest.mark.parametrize("paper", ["none", "a4"])
def test_that_a_pdf_holds_the_sheets_at_true_size(paper: str, sheets, tmp_path: Path) -> None:
    (bed,) = sheets_on_beds(sheets)
    write_beds([bed], tmp_path / "cut.pdf", BedFile(paper=paper), never_judged)
    pages = read_pages(tmp_path / "cut.pdf")
    tiling = one_page(bed.size_mm) if paper == "none" else tile(bed.size_mm, paper)
    drawn = sum(
        length_in_cell(page, part, LAYER_COLOUR[Layer.OUTLINE])
        for page, part in zip(pages[-len(tiling.tiles) :], tiling.tiles, strict=True)
    )
    assert drawn == pytest.approx(sum(Polygon(sheet.plan.outline).length for sheet in sheets), rel=1e-4)
