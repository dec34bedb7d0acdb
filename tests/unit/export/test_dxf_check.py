"""Checking cut files of any origin; the bad ones are made with ezdxf."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import pytest
from ezdxf.document import Drawing

from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.dxf_check import FileReport, check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.svg import cut_svg_bytes
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT, ConnectorStyle
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
SQUARE = [(0, 0), (40, 0), (40, 40), (0, 40)]


def foreign(units: int = 4, outline: bool = True) -> Drawing:
    """A sheet of 40 x 40 with two slits 1 mm apart, on layer 0."""
    document = ezdxf.new("R2010", units=units)
    modelspace = document.modelspace()
    modelspace.add_line((5, 20), (15, 20))
    modelspace.add_line((16, 10), (16, 30))
    if outline:
        modelspace.add_lwpolyline(SQUARE, close=True)
    return document


def checked(document: Drawing, folder: Path, kerf_mm: float | None = None) -> FileReport:
    document.saveas(folder / "foreign.dxf")
    return check_file(folder / "foreign.dxf", kerf_mm)


def sentences(report: FileReport) -> str:
    return " | ".join(problem.text for problem in report.problems)


@pytest.mark.parametrize(("rows", "columns"), [(4, 5), (10, 10), (24, 24)])
@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_our_own_files_pass_with_the_numbers_of_their_plan(
    rows: int, columns: int, version: str, make_design: MakeDesign, tmp_path: Path
) -> None:
    plan = plan_cuts(make_design(rows, columns, seed=4))
    write_dxf(plan, tmp_path / "cut.dxf", version)
    report = check_file(tmp_path / "cut.dxf")
    assert report.ok
    assert (report.pieces, report.path_count, report.overlap_mm) == (1, len(plan.paths), pytest.approx(0.0, abs=1e-9))
    assert report.kerf_mm == plan.kerf_mm
    assert report.cut_length_mm == pytest.approx(plan.cut_length_mm)
    assert report.min_ligament_mm == pytest.approx(plan.min_connector_mm, abs=1e-6)
    assert report.bounds_mm == pytest.approx(plan.bounds_mm)
    assert [problem.code for problem in report.problems] == ([] if version == "R2010" else ["cut_file.no_unit"])


def test_that_a_foreign_file_is_measured_by_its_largest_closed_contour(tmp_path: Path) -> None:
    report = checked(foreign(), tmp_path, kerf_mm=0.2)
    assert report.ok and report.problems == ()
    assert (report.pieces, report.min_ligament_mm) == (1, pytest.approx(0.8))
    assert report.bounds_mm == (40.0, 40.0)


def test_that_a_sheet_that_falls_apart_is_reported(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_line((-1, 35), (41, 35))
    report = checked(document, tmp_path)
    assert report.pieces == 2 and not report.ok and "2 pieces" in sentences(report)
    place = next(problem.where for problem in report.problems if "pieces" in problem.text)
    assert place is not None and place[1] > 35.0
    assert checked(foreign(), tmp_path, kerf_mm=12.0).pieces == 3


@pytest.mark.parametrize("layer", ["CUT", "cut_slits", "UNCUT_MARK", "Engrave1"])
def test_that_layer_names_that_choose_an_operation_are_reported(layer: str, tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_line((30, 5), (30, 9), dxfattribs={"layer": layer})
    report = checked(document, tmp_path)
    assert not report.ok and layer in sentences(report)
    assert layer in report.layers


@pytest.mark.parametrize(("start", "stop"), [((5, 20), (15, 20)), ((15, 20), (5, 20))])
def test_that_a_line_drawn_twice_in_either_direction_is_reported(
    start: tuple[int, int], stop: tuple[int, int], tmp_path: Path
) -> None:
    document = foreign()
    document.modelspace().add_line(start, stop)
    report = checked(document, tmp_path)
    assert not report.ok and "drawn more than once" in sentences(report)
    assert report.overlap_mm == pytest.approx(10.0)


def test_that_partly_overlapping_lines_are_reported_with_the_length(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_line((3, 20), (7.5, 20))
    report = checked(document, tmp_path)
    assert not report.ok and report.overlap_mm == pytest.approx(2.5) and "2.500 mm" in sentences(report)
    place = next(problem.where for problem in report.problems if "overlap other cuts" in problem.text)
    assert place == pytest.approx((6.25, 20.0))


def test_that_an_open_outline_is_reported_with_its_gap(tmp_path: Path) -> None:
    document = foreign(outline=False)
    document.modelspace().add_lwpolyline([*SQUARE, (0, 0.25)])
    report = checked(document, tmp_path)
    assert not report.ok and report.pieces is None
    assert "open by 0.250 mm at x = 0.00" in sentences(report)


def test_that_a_missing_outline_is_reported(tmp_path: Path) -> None:
    report = checked(foreign(outline=False), tmp_path)
    assert not report.ok and "no closed outline" in sentences(report)


def test_that_an_outline_of_single_lines_counts_but_is_warned_about(tmp_path: Path) -> None:
    document = foreign(outline=False)
    for start, stop in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True):
        document.modelspace().add_line(start, stop)
    report = checked(document, tmp_path)
    assert report.ok and report.pieces == 1 and "not a closed polyline" in sentences(report)
    assert report.min_ligament_mm == pytest.approx(1.0)


def test_that_a_self_crossing_outline_is_reported(tmp_path: Path) -> None:
    document = foreign(outline=False)
    document.modelspace().add_lwpolyline([(0, 0), (40, 40), (40, 0), (0, 40)], close=True)
    assert "crosses itself" in sentences(checked(document, tmp_path))


def test_that_zero_length_and_single_vertex_entities_are_reported(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_line((7, 7), (7, 7))
    document.modelspace().add_lwpolyline([(8, 8)])
    report = checked(document, tmp_path)
    assert not report.ok and sentences(report).count("has no length") == 2


def test_that_coordinates_that_are_no_numbers_are_reported(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_lwpolyline([(1, 1), (math.nan, 3)])
    document.modelspace().add_line((1, 1), (math.nan, 3))
    document.modelspace().add_circle((5, 5), radius=math.inf)
    report = checked(document, tmp_path)
    assert not report.ok and sentences(report).count("not a number") == 3
    assert report.pieces == 1


def test_that_entities_that_cannot_be_cut_are_reported(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_text("hello")
    document.modelspace().add_point((3, 3))
    report = checked(document, tmp_path)
    assert not report.ok and "1 TEXT" in sentences(report) and "1 POINT" in sentences(report)


def test_that_curves_are_followed_and_splines_warned_about(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_circle((30, 30), radius=2)
    document.modelspace().add_spline([(25, 5), (30, 8), (35, 5)])
    document.modelspace().add_lwpolyline([(22, 12, 0, 0, 1), (26, 12, 0, 0, 0)])
    report = checked(document, tmp_path)
    assert report.ok and "1 SPLINE" in sentences(report)
    assert report.cut_length_mm > 160 + 30 + 2 * math.pi * 2 - 0.1 + 2 * math.pi - 0.1 + 10


@pytest.mark.parametrize(("units", "factor", "name"), [(1, 25.4, "in"), (5, 10.0, "cm")])
def test_that_other_units_are_converted_and_warned_about(units: int, factor: float, name: str, tmp_path: Path) -> None:
    report = checked(foreign(units), tmp_path)
    assert report.ok and report.unit == name
    assert report.bounds_mm == pytest.approx((40 * factor, 40 * factor))
    assert "instead of mm" in sentences(report)


def test_that_a_sheet_in_metres_is_refused_as_a_mistake(tmp_path: Path) -> None:
    report = checked(foreign(units=6), tmp_path)
    assert not report.ok and "probably wrong" in sentences(report)


def test_that_an_empty_drawing_is_reported(tmp_path: Path) -> None:
    report = checked(ezdxf.new("R2010", units=4), tmp_path)
    assert not report.ok and "nothing that can be cut" in sentences(report)


@pytest.mark.parametrize("content", [b"", b"no dxf at all", b"\x89PNG\r\n\x1a\n" + bytes(range(256))])
def test_that_a_file_that_is_no_dxf_is_refused(content: bytes, tmp_path: Path) -> None:
    bad = tmp_path / "bad.dxf"
    bad.write_bytes(content)
    with pytest.raises(ExportError, match=r"bad\.dxf"):
        check_file(bad)


def test_that_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    with refused(ExportError, "dxf.cannot_open"):
        check_file(tmp_path / "missing.dxf")
    with refused(ExportError, "dxf.cannot_open"):
        check_file(tmp_path)


@pytest.mark.parametrize("kerf", [-0.1, math.nan])
def test_that_an_impossible_kerf_is_refused(kerf: float, tmp_path: Path) -> None:
    with refused(ExportError, "cut_file.kerf_not_a_width"):
        checked(foreign(), tmp_path, kerf)


@pytest.mark.parametrize("seed", range(12))
def test_that_a_damaged_dxf_never_ends_in_a_traceback(seed: int, make_design: MakeDesign, tmp_path: Path) -> None:
    write_dxf(plan_cuts(make_design(2, 2)), tmp_path / "cut.dxf")
    generator = random.Random(seed)
    lines = (tmp_path / "cut.dxf").read_bytes().split(b"\n")
    del lines[generator.randrange(len(lines) // 2) :][:1]
    lines[generator.randrange(len(lines))] = b"\x00\xff"
    (tmp_path / "cut.dxf").write_bytes(b"\n".join(lines[: generator.randrange(20, len(lines) * 2)]))
    try:
        report = check_file(tmp_path / "cut.dxf")
    except ExportError as error:
        assert "cut.dxf" in str(error)
    else:
        assert report.path.name == "cut.dxf"


def test_that_a_slanted_line_drawn_over_half_of_another_is_reported(tmp_path: Path) -> None:
    document = foreign()
    a, b = (22.1234, 7.5678), (33.3333, 9.8765)
    document.modelspace().add_line(a, b)
    document.modelspace().add_line(b, ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2))
    report = checked(document, tmp_path)
    assert not report.ok and report.overlap_mm == pytest.approx(math.dist(a, b) / 2, abs=1e-6)


def test_that_a_line_drawn_three_times_counts_twice(tmp_path: Path) -> None:
    document = foreign()
    for _ in range(3):
        document.modelspace().add_line((22.1234, 7.5678), (33.3333, 9.8765))
    assert checked(document, tmp_path).overlap_mm == pytest.approx(2 * math.dist((22.1234, 7.5678), (33.3333, 9.8765)))


def test_that_lines_that_only_cross_or_meet_do_not_overlap(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_line((22, 8), (36, 9))
    document.modelspace().add_line((22, 9), (36, 8))
    document.modelspace().add_line((36, 9), (36, 12))
    assert checked(document, tmp_path).overlap_mm == 0.0


def test_that_slits_of_our_own_that_run_into_each_other_are_not_ready_to_cut(
    make_design: MakeDesign, tmp_path: Path
) -> None:
    plan = plan_cuts(make_design(4, 5, seed=4))
    write_dxf(plan, tmp_path / "cut.dxf")
    document = ezdxf.readfile(tmp_path / "cut.dxf")
    slit = next(entity for entity in document.modelspace() if entity.dxf.layer == "SLITS")
    (ax, ay), (bx, by) = slit.get_points("xy")[0], slit.get_points("xy")[-1]
    dx, dy = 0.1 * (bx - ax), 0.1 * (by - ay)
    slit.set_points([(ax - dx, ay - dy), (bx + dx, by + dy)], format="xy")
    report = checked(document, tmp_path)
    assert not report.ok and "run into each other" in sentences(report)


def test_that_a_hole_whose_arcs_miss_their_first_point_by_rounding_is_a_hole(tmp_path: Path) -> None:
    document = ezdxf.new("R2010", units=4)
    modelspace = document.modelspace()
    modelspace.add_lwpolyline([(100, 0), (200, 0), (200, 100), (100, 100)], close=True)
    # Its chords end 1e-14 mm beside where they began, so that the ring as it comes crosses itself.
    modelspace.add_lwpolyline([(137.245, 25.26, 1.0), (137.1659, 25.2721, 1.0)], format="xyb", close=True)
    assert checked(document, tmp_path, kerf_mm=0.02).pieces == 1


def test_that_a_closed_cut_that_frees_a_disc_is_told_with_its_place(tmp_path: Path) -> None:
    document = foreign()
    document.modelspace().add_circle((30, 30), 4.0)
    report = checked(document, tmp_path)
    (problem,) = [problem for problem in report.problems if "fall out" in problem.text]
    assert report.ok and "8.0 mm" in problem.text and problem.where == pytest.approx((30.0, 30.0), abs=1e-3)
    slot = foreign()
    slot.modelspace().add_lwpolyline([(25, 30), (35, 30), (35, 30.3), (25, 30.3)], close=True)
    assert "fall out" not in sentences(checked(slot, tmp_path))


@pytest.mark.parametrize(("radius", "dropped"), [(5.0, False), (60_000.0, True), (1e12, True)])
def test_that_curves_are_left_out_for_their_size_and_not_for_their_place(
    tmp_path: Path, radius: float, dropped: bool
) -> None:
    drawing = ezdxf.new("R2010", units=4)
    drawing.modelspace().add_circle((450_000.0, 0.0), radius)
    drawing.saveas(tmp_path / "far.dxf")
    problems = " ".join(str(problem.text) for problem in check_file(tmp_path / "far.dxf").problems)
    assert ("larger than 100 m" in problems) is dropped


@pytest.mark.parametrize("choices", [{}, {"tabs": 3}, {"copies": 2}, {"style": ConnectorStyle.ROUND}])
def test_that_our_own_svg_is_checked_as_our_own_dxf_is(
    choices: dict[str, object], make_design: MakeDesign, tmp_path: Path
) -> None:
    design = make_design(4, 5, seed=4)
    plan = plan_cuts(design, options=replace(STRAIGHT, **choices))  # type: ignore[arg-type]
    write_dxf(plan, tmp_path / "cut.dxf", "R2010")
    # The content says what a file is.
    drawing = tmp_path / "cut.dat"
    drawing.write_bytes(cut_svg_bytes(ExportJob(design, plan=plan)))
    one, other = check_file(tmp_path / "cut.dxf"), check_file(drawing)
    assert other.ok and [problem.code for problem in other.problems] == [problem.code for problem in one.problems]
    assert (other.unit, other.pieces) == ("mm", one.pieces)
    assert (other.path_count, other.kerf_mm) == (one.path_count, one.kerf_mm)
    assert other.cut_length_mm == pytest.approx(one.cut_length_mm, rel=1e-5)
    assert other.min_ligament_mm == pytest.approx(one.min_ligament_mm, abs=1e-3)
    assert other.bounds_mm == pytest.approx(one.bounds_mm, abs=1e-3) and other.layers == one.layers


def test_that_faults_of_our_own_svg_are_reported(make_design: MakeDesign, tmp_path: Path) -> None:
    path, design = tmp_path / "cut.svg", make_design(4, 5, seed=4)
    content = cut_svg_bytes(ExportJob(design, plan=plan_cuts(design))).decode()
    first = content[content.index("<path") : content.index("/>", content.index("<path")) + 2]
    for damage, code in (
        (lambda text: text.replace(first, first + first), "cut_file.duplicates"),
        (lambda text: text.replace(first, first + "<text>cut me</text>"), "cut_file.other_entities"),
        (lambda text: text.replace('mm"', 'in"', 2), "cut_file.no_unit"),
    ):
        path.write_text(damage(content), encoding="utf-8")
        assert code in [problem.code for problem in check_file(path).problems]


@pytest.mark.parametrize(
    ("content", "code"),
    [
        ('<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm"><path d="M0 0h9v9z"/></svg>', "foreign_svg"),
        ("<?xml version='1.0'?>\n<svg xmlns='http://www.w3.org/2000/svg'><g>", "not_readable"),
    ],
)
def test_that_an_svg_that_is_no_cut_file_of_ours_is_no_damaged_dxf(content: str, code: str, tmp_path: Path) -> None:
    (tmp_path / "drawing.svg").write_text(content, encoding="utf-8")
    with pytest.raises(ExportError) as refused:
        check_file(tmp_path / "drawing.svg")
    assert refused.value.code.endswith(code) and "DXF" not in str(refused.value).split(".")[0]
