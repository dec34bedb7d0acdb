"""Verification of written files: what both readers confirm, and every kind of difference that they must notice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from kirigami_studio.export import verification
from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.group_codes import read_group_codes
from kirigami_studio.export.profile import PROFILES, find_profile
from kirigami_studio.export.svg import write_cut_svg
from kirigami_studio.export.verification import Verification, verify_export
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
ONE_FILE = [key for key, profile in PROFILES.items() if not profile.file_per_layer]


@pytest.fixture(scope="module")
def plan(make_design: MakeDesign) -> CutPlan:
    """A 4 x 5 design at the default size."""
    return plan_cuts(make_design(4, 5, seed=1))


def bad(report: Verification) -> str:
    return " ".join(finding.text for finding in report.findings if not finding.ok)


@pytest.mark.parametrize("version", ["R2010", "R12"])
@pytest.mark.parametrize("profile", ONE_FILE)
def test_that_a_written_file_passes_with_two_readers(profile: str, version: str, plan: CutPlan, tmp_path: Path) -> None:
    write_dxf(plan, tmp_path / "sheet.dxf", version, profile)
    report = verify_export(plan, tmp_path / "sheet.dxf", profile, version)
    assert report.ok, bad(report)
    assert report.pieces == 1
    assert all(finding.text.endswith(".") for finding in report.findings)
    assert report.size_mm == pytest.approx(plan.size_mm, abs=0.6)
    if profile != "slots":
        assert report.cut_length_mm == pytest.approx(plan.cut_length_mm, rel=1e-9)
    assert any("import it as mm" in warning.text for warning in report.warnings) is (version == "R12")
    assert 0.0 < report.seconds_low <= report.seconds_high


@pytest.mark.parametrize("profile", PROFILES)
def test_that_a_written_svg_passes_with_two_readers(profile: str, plan: CutPlan, tmp_path: Path) -> None:
    write_cut_svg(plan, tmp_path / "sheet.svg", find_profile(profile))
    report = verify_export(plan, tmp_path / "sheet.svg", profile)
    assert report.ok, bad(report)
    assert report.pieces == 1


@pytest.mark.parametrize(
    ("found", "meant", "word"),
    [
        ('mm" height', 'px" height', "unit of the file is 0 "),
        ("#ff0000", "#0000ff", "SLITS (5)"),
        ('id="SLITS"', 'id="CUTS"', "CUTS (1)"),
        (" L ", " L 1,1 L ", "another number of points"),
        (" Z", "", "0 closed"),
        ("<title>", "<text>A</text><title>", "1 entities that are no lines (text)"),
    ],
)
def test_that_every_difference_in_an_svg_is_a_bad_finding(
    found: str, meant: str, word: str, plan: CutPlan, tmp_path: Path
) -> None:
    path = tmp_path / "sheet.svg"
    write_cut_svg(plan, path, find_profile("any"))
    content = path.read_text()
    assert found in content
    path.write_text(content.replace(found, meant, 1))
    report = verify_export(plan, path, "any")
    assert not report.ok
    assert word in bad(report)


def test_that_svg_path_data_with_curves_is_refused(plan: CutPlan, tmp_path: Path) -> None:
    path = tmp_path / "sheet.svg"
    write_cut_svg(plan, path, find_profile("any"))
    path.write_text(path.read_text().replace(" L ", " C 1,1 2,2 ", 1))
    with refused(ExportError, "svg.not_readable"):
        verify_export(plan, path, "any")


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_both_readers_see_the_same_file(version: str, plan: CutPlan, tmp_path: Path) -> None:
    write_dxf(plan, tmp_path / "sheet.dxf", version, "lightburn")
    one, other = read_with_ezdxf(tmp_path / "sheet.dxf"), read_group_codes(tmp_path / "sheet.dxf")
    assert (one.unit, one.extent, one.layers) == (other.unit, other.extent, other.layers)
    for a, b in zip(one.strokes, other.strokes, strict=True):
        assert (a.closed, a.layer, a.colour) == (b.closed, b.layer, b.colour)
        np.testing.assert_array_equal(a.points, b.points)


def drop_one(document: ezdxf.document.Drawing) -> None:
    document.modelspace().delete_entity(document.modelspace()[0])


def add_text(document: ezdxf.document.Drawing) -> None:
    document.modelspace().add_text("KIRIGAMI")


def open_outline(document: ezdxf.document.Drawing) -> None:
    document.modelspace()[-1].close(False)


def recolour(document: ezdxf.document.Drawing) -> None:
    document.modelspace()[3].dxf.color = 5


def inches(document: ezdxf.document.Drawing) -> None:
    document.header["$INSUNITS"] = 1


def move(document: ezdxf.document.Drawing) -> None:
    document.modelspace()[2].translate(1e-6, 0.0, 0.0)


def cut_twice(document: ezdxf.document.Drawing) -> None:
    first, second = document.modelspace()[0], document.modelspace()[1]
    second.set_points(list(first.get_points()))


def lengthen(document: ezdxf.document.Drawing) -> None:
    for entity in document.modelspace():
        if entity.dxf.layer == "SLITS":
            (ax, ay), (bx, by) = entity.get_points("xy")
            dx, dy = 0.06 * (bx - ax), 0.06 * (by - ay)
            entity.set_points([(ax - dx, ay - dy), (bx + dx, by + dy)], format="xy")


def larger(document: ezdxf.document.Drawing) -> None:
    document.header["$EXTMAX"] = (2540.0, 2540.0, 0.0)


@pytest.mark.parametrize(
    ("spoil", "word"),
    [
        (drop_one, "open and 1 closed lines"),
        (add_text, "1 entities that are no lines (TEXT)"),
        (open_outline, "0 closed"),
        (recolour, "SLITS (5)"),
        (inches, "unit of the file is 1 "),
        (move, "the farthest is 1e-06 mm off"),
        (cut_twice, "would be cut twice"),
        (lengthen, " pieces."),
        (larger, "2540.000 x 2540.000"),
    ],
)
def test_that_every_difference_from_the_plan_is_a_bad_finding(
    spoil: Callable[[ezdxf.document.Drawing], None], word: str, plan: CutPlan, tmp_path: Path
) -> None:
    path = tmp_path / "sheet.dxf"
    write_dxf(plan, path)
    document = ezdxf.readfile(path)
    spoil(document)
    document.saveas(path)
    report = verify_export(plan, path, "any")
    assert not report.ok
    assert word in bad(report)


def test_that_a_reader_that_disagrees_is_named(plan: CutPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "sheet.dxf"
    write_dxf(plan, path)
    kind = verification.FORMATS[".dxf"]
    deaf = replace(kind, readers=(kind.readers[0], lambda found: replace(read_group_codes(found), unit=1)))
    monkeypatch.setitem(verification.FORMATS, ".dxf", deaf)
    assert (
        bad(verify_export(plan, path, "any")) == "the group-code reader: The unit of the file is 1 instead of 4 (mm)."
    )


def test_that_a_plan_with_another_kerf_finds_narrow_ligaments(plan: CutPlan, tmp_path: Path) -> None:
    write_dxf(plan, tmp_path / "sheet.dxf")
    report = verify_export(replace(plan, kerf_mm=0.25), tmp_path / "sheet.dxf", "any")
    assert report.pieces is not None and report.pieces > 1
    assert not report.ok


@pytest.mark.parametrize("content", [b"", b"no dxf at all", b"  0\nSECTION\n  2\nHEADER\n"])
def test_that_a_file_that_is_no_dxf_is_refused_with_a_sentence(content: bytes, plan: CutPlan, tmp_path: Path) -> None:
    path = tmp_path / "sheet.dxf"
    path.write_bytes(content)
    with refused(ExportError, "dxf.not_readable"):
        verify_export(plan, path, "any")
    with refused(ExportError, "dxf.not_readable"):
        read_group_codes(path)
    with refused(ExportError, "verify.unknown_kind"):
        verify_export(plan, tmp_path / "sheet.png", "any")
