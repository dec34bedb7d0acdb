"""An engraved name in files: first, on its own layer and in its own colour, read back, and counted as no cut."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest

from kirigami_studio.export import picture
from kirigami_studio.export.dxf import dxf_bytes, write_dxf
from kirigami_studio.export.dxf_check import TRAP_WORDS, check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.lightburn import layer_lengths
from kirigami_studio.export.pdf import read_pages
from kirigami_studio.export.profile import NAME_LAYER, PROFILES, RED
from kirigami_studio.export.provenance import sidecar_record
from kirigami_studio.export.registry import export
from kirigami_studio.export.strokes import file_strokes, name_strokes, strokes_of, work_of
from kirigami_studio.export.verification import Verification, verify_export
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.engraving import engraved
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment

WITHOUT = {key for key, profile in PROFILES.items() if profile.name_colour is None}


@pytest.fixture(scope="module")
def design(make_design: Callable[..., Deployment]) -> Deployment:
    return make_design(2, 3, seed=1, spread=0.3)


@pytest.fixture(scope="module")
def bare(design: Deployment) -> CutPlan:
    options = CutOptions(style=ConnectorStyle.CENTRED, copies=2)
    return plan_cuts(design, 60.0, kerf_mm=0.1, options=options)


@pytest.fixture(scope="module")
def named(bare: CutPlan) -> CutPlan:
    plan = engraved(bare, "A1")
    assert plan.engraving is not None
    return plan


def codes(found: Verification, ok: bool = True) -> list[str]:
    return [finding.code for finding in found.findings if finding.ok is ok]


def length_of(plan: CutPlan) -> float:
    """Length (mm) of the name on all copies."""
    lines = () if plan.engraving is None else plan.engraving.lines
    return len(plan.copies) * sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines)


def test_that_no_profile_cuts_in_the_colour_or_on_the_layer_of_names() -> None:
    assert not any(word in NAME_LAYER for word in TRAP_WORDS)
    for profile in PROFILES.values():
        assert profile.name_colour not in profile.colour.values() and profile.name_colour != RED
    assert {"cricut", "silhouette", "single", "slots"} == WITHOUT


@pytest.mark.parametrize("version", ["R2010", "R12"])
@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_that_both_readers_and_the_check_find_the_name_and_the_same_cuts(
    profile: str, version: str, design: Deployment, bare: CutPlan, named: CutPlan, tmp_path: Path
) -> None:
    found = []
    for plan, place in ((bare, "bare.dxf"), (named, "named.dxf")):
        path = export(ExportJob(design, plan=plan, profile=profile, dxf_version=version), tmp_path / place)
        found.append((verify_export(plan, path, profile, version, design), check_file(path)))
    (before, checked), (after, report) = found
    assert after.ok and report.ok, codes(after, ok=False)
    assert ("verify.name" in codes(after)) is (profile not in WITHOUT)
    left_out = [note.code for note in after.warnings if note.code == "profile.name_left_out"]
    assert bool(left_out) is (profile in WITHOUT)
    same = ("pieces", "cut_length_mm", "size_mm", "seconds_low", "seconds_high", "void_miss_um", "jam_phi")
    assert [getattr(after, name) for name in same] == [getattr(before, name) for name in same]
    kept = ("path_count", "cut_length_mm", "overlap_mm", "bounds_mm", "pieces", "min_ligament_mm", "problems")
    assert [getattr(report, name) for name in kept] == [getattr(checked, name) for name in kept]


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_that_both_readers_of_an_svg_find_the_name(
    profile: str, named: CutPlan, design: Deployment, tmp_path: Path
) -> None:
    path = export(ExportJob(design, plan=named, profile=profile), tmp_path / "named.svg")
    found = verify_export(named, path, profile)
    assert found.ok and ("verify.name" in codes(found)) is (profile not in WITHOUT)
    groups = [str(group.get("id")) for group in ElementTree.parse(path).getroot().findall("{*}g")]
    assert groups.count(NAME_LAYER) == (0 if profile in WITHOUT else 1)
    assert (groups[0] == NAME_LAYER) is (profile not in WITHOUT)


def test_that_the_name_comes_first_on_every_copy_in_blue_where_cuts_are_red(named: CutPlan, tmp_path: Path) -> None:
    write_dxf(named, tmp_path / "named.dxf")
    entities = list(ezdxf.readfile(tmp_path / "named.dxf").modelspace())
    assert named.engraving is not None
    count = len(named.copies) * len(named.engraving.lines)
    assert [entity.dxf.layer for entity in entities].count(NAME_LAYER) == count
    assert {(entity.dxf.layer, entity.dxf.color) for entity in entities[:count]} == {(NAME_LAYER, 5)}
    assert {entity.dxf.color for entity in entities[count:]} == {RED}
    lefts = [float(np.array(entity.get_points("xy"))[:, 0].min()) for entity in entities[:count]]
    assert lefts[len(lefts) // 2] - lefts[0] == pytest.approx(named.copies.places[1, 0], abs=1e-3)


@pytest.mark.parametrize("profile", sorted(WITHOUT))
def test_that_profiles_without_names_write_the_same_cuts_as_before(profile: str, bare: CutPlan, named: CutPlan) -> None:
    assert dxf_bytes(named, "R2010", PROFILES[profile]) == dxf_bytes(bare, "R2010", PROFILES[profile])


def test_that_length_and_time_are_those_of_the_cuts(bare: CutPlan, named: CutPlan) -> None:
    for profile in PROFILES.values():
        strokes = strokes_of(named, profile)
        assert work_of(strokes, named) == work_of(strokes_of(bare, profile), bare)
        assert len(file_strokes(named, profile)) == len(name_strokes(named, profile)) + len(strokes)


def test_that_a_project_for_lightburn_engraves_it_first_at_less_power(
    named: CutPlan, bare: CutPlan, design: Deployment, tmp_path: Path
) -> None:
    path = export(ExportJob(design, plan=named), tmp_path / "named.lbrn2")
    lengths = layer_lengths(path)
    assert lengths.pop(NAME_LAYER) == pytest.approx(length_of(named), rel=1e-4)
    assert sum(lengths.values()) == pytest.approx(len(bare.copies) * bare.cut_length_mm, rel=1e-3)
    root = ElementTree.parse(path).getroot()
    settings = {
        setting.find("name").get("Value"): {entry.tag: entry.get("Value") for entry in setting}  # type: ignore[union-attr]
        for setting in root.findall("CutSetting")
    }
    name = settings.pop(NAME_LAYER)
    assert name["priority"] == "0" and name["numPasses"] == "1"
    for cut in settings.values():
        assert float(name["maxPower"] or 0) < float(cut["maxPower"] or 0) and int(cut["priority"] or 0) > 0
        assert cut["index"] != name["index"]
    numbers = [shape.get("CutIndex") for shape in root.findall("Shape")]
    assert numbers.index("2") == numbers.count(name["index"])


@pytest.mark.parametrize("paper", ["none", "a4"])
def test_that_a_pdf_shows_it_in_a_colour_of_its_own(
    paper: str, named: CutPlan, design: Deployment, tmp_path: Path
) -> None:
    path = export(ExportJob(design, plan=named, paper=paper), tmp_path / "named.pdf")
    shown = [line for page in read_pages(path) for line in page.lines if line.colour == picture.NAME_COLOUR]
    assert len(shown) >= len(named.copies) * 4 and picture.NAME_COLOUR not in picture.LAYER_COLOUR.values()


def test_that_the_record_beside_a_cut_file_tells_it(named: CutPlan, bare: CutPlan, design: Deployment) -> None:
    told = sidecar_record(ExportJob(design, plan=named))["fabrication"]
    assert named.engraving is not None
    assert told["engraved"] == {"text": "A1", "height_mm": named.engraving.height_mm}
    assert "engraved" not in sidecar_record(ExportJob(design, plan=bare))["fabrication"]


def test_that_a_name_that_is_gone_was_never_meant_or_is_moved_is_found(
    named: CutPlan, bare: CutPlan, tmp_path: Path
) -> None:
    write_dxf(bare, tmp_path / "bare.dxf")
    gone = verify_export(named, tmp_path / "bare.dxf", "any")
    assert not gone.ok and codes(gone, ok=False) == ["verify.name_differs"]
    write_dxf(named, tmp_path / "named.dxf")
    unasked = verify_export(bare, tmp_path / "named.dxf", "any")
    assert not unasked.ok and codes(unasked, ok=False) == ["verify.name_differs"]
    document = ezdxf.readfile(tmp_path / "named.dxf")
    next(iter(document.modelspace())).translate(0.5, 0.0, 0.0)
    document.saveas(tmp_path / "moved.dxf")
    assert "verify.name_differs" in codes(verify_export(named, tmp_path / "moved.dxf", "any"), ok=False)


def test_that_a_name_across_a_cut_or_in_its_colour_is_found_by_verification_and_check(
    named: CutPlan, tmp_path: Path
) -> None:
    assert named.engraving is not None
    slit = next(path for path in named.paths if not path.closed)
    over = replace(named.engraving, lines=(slit.points[[0, -1]] + 0.05, *named.engraving.lines[1:]))
    write_dxf(replace(named, engraving=over), tmp_path / "over.dxf")
    found = verify_export(replace(named, engraving=over), tmp_path / "over.dxf", "any")
    assert codes(found, ok=False) == ["verify.name_cuts"]
    report = check_file(tmp_path / "over.dxf")
    assert [problem.code for problem in report.problems if problem.code.startswith("cut_file.name")] == [
        "cut_file.name_cuts"
    ]
    assert not report.ok
    document = ezdxf.readfile(tmp_path / "over.dxf")
    document.modelspace().delete_entity(next(iter(document.modelspace())))
    document.saveas(tmp_path / "less.dxf")
    assert "cut_file.name_differs" in [problem.code for problem in check_file(tmp_path / "less.dxf").problems]


def test_that_a_foreign_layer_of_that_name_is_cut(bare: CutPlan, tmp_path: Path) -> None:
    write_dxf(bare, tmp_path / "bare.dxf")
    before = check_file(tmp_path / "bare.dxf")
    document = ezdxf.readfile(tmp_path / "bare.dxf")
    document.modelspace().add_lwpolyline([(5.0, 5.0), (6.0, 5.0)], dxfattribs={"layer": NAME_LAYER})
    document.saveas(tmp_path / "foreign.dxf")
    assert check_file(tmp_path / "foreign.dxf").cut_length_mm == pytest.approx(before.cut_length_mm + 1.0)


def test_that_each_file_of_a_single_layer_is_checked_by_its_cuts_alone(
    design: Deployment, bare: CutPlan, named: CutPlan, tmp_path: Path
) -> None:
    plain = export(ExportJob(design, plan=bare, profile="layers"), tmp_path / "bare.dxf")
    folder = export(ExportJob(design, plan=named, profile="layers"), tmp_path / "named.dxf")
    name, *cuts = sorted(folder.iterdir())
    alone = check_file(name)
    assert name.name == "1_NAME.dxf" and alone.ok
    assert (alone.path_count, alone.cut_length_mm, alone.bounds_mm) == (0, 0.0, (0.0, 0.0))
    assert [problem.code for problem in alone.problems] == ["cut_file.name_alone"]
    kept = ("path_count", "cut_length_mm", "overlap_mm", "bounds_mm", "pieces", "min_ligament_mm", "problems")
    for one, before in zip(cuts, sorted(plain.iterdir()), strict=True):
        assert one.name[2:] == before.name[2:]
        report, expected = check_file(one), check_file(before)
        assert report.ok and [getattr(report, key) for key in kept] == [getattr(expected, key) for key in kept]
    document = ezdxf.readfile(name)
    document.modelspace().delete_entity(document.modelspace()[-1])
    document.saveas(name)
    assert "cut_file.name_differs" in [problem.code for problem in check_file(name).problems]
