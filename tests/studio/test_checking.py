"""A cut file is judged by its own record of how it was made, and by its design; alone it is sound, never ready."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.file_record import FileRecord, record_of
from kirigami_studio.export.provenance import PROGRAM, exactly
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings, with_choices
from kirigami_studio.studio.checking import checked
from kirigami_studio.studio.making import CutRequest, ExportedFiles, Output, closed, planned, written
from tests.refusals import refused

TRIMMED_STAR = Path(__file__).parents[1] / "data" / "making" / "star_trim4.kiri"
#: Options of an export, one after the other beside the project's own.
OPTIONS: dict[str, dict[str, object]] = {
    "its own": {},
    "straight": {"style": ConnectorStyle.STRAIGHT, "connector_mm": 0.35},
    "arc": {"style": ConnectorStyle.ARC, "kerf_mm": 0.0},
    "double": {"style": ConnectorStyle.DOUBLE, "order": "rows"},
    "round": {"style": ConnectorStyle.ROUND, "material": "pet-co2", "width_mm": 260.0},
    "slots": {"profile": "slots", "kerf_mm": 0.05},
    "single": {"profile": "single", "tabs": 3, "engrave": True},
    "layers": {"profile": "layers", "engrave": True},
    "k40": {"profile": "k40", "connector_mm": 0.1234567891},
    "copies": {"copies": 2, "copy_gap_mm": 7.0, "profile": "lightburn"},
    "connectors": {"hinge_mm": [(3, 0.33), (8, 0.3)], "removed": [5]},
}


@pytest.fixture(scope="module")
def project() -> Document:
    """Two small designs, of which the second is chosen."""
    draw = np.random.default_rng(1)
    fields = [RatioField.from_log10(draw.uniform(-0.25, 0.25, (4, 5))) for _ in range(2)]
    target = Outline.from_points(deploy(fields[1]).outline(0.0), "own")
    designs = tuple(
        Candidate(Sheet(one), evaluate(deploy(one), target), seed=0, index=index) for index, one in enumerate(fields)
    )
    return Document(target, DesignSettings((4, 5)), designs, 1, FabricationSettings(connector_mm=0.2))


@pytest.fixture
def exported(project: Document, tmp_path: Path) -> Callable[..., ExportedFiles]:
    """Exports a whole set with some options."""

    def write(**options: object) -> ExportedFiles:
        request = CutRequest.of(project, with_choices(project.fabrication, options))
        made = planned(request)
        return written(request, made, Output(tmp_path / "set", "cut", True), closed(request, made))

    return write


def cut_files(found: ExportedFiles) -> list[Path]:
    """The files of a set that are for a cutter."""
    return [path for path in found.files if path.suffix in (".dxf", ".lbrn2", "") or path.name == "cut.svg"][:4]


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_that_every_cut_file_of_a_set_is_judged_as_its_export_judged_it(
    options: dict[str, object], project: Document, exported: Callable[..., ExportedFiles]
) -> None:
    found = exported(**options)
    assert found.verdict is not None
    # The project as it is by now has other options, and another design chosen.
    now = replace(project, chosen=0)
    for path in (one for one in cut_files(found) if one.name != "reference.dxf"):
        again = checked(path, now)
        assert again.sound and again.verdict is not None, [problem.text for problem in again.report.problems]
        assert again.verdict.level is found.verdict.level is again.said, path.name
        codes = [problem.code for problem in found.verdict.problems]
        assert [problem.code for problem in again.verdict.problems] == codes


def test_that_a_trimmed_design_is_known_again(tmp_path: Path) -> None:
    project = load(TRIMMED_STAR)
    request = CutRequest.of(project, with_choices(project.fabrication, {"connector_mm": 0.17}))
    made = planned(request)
    found = written(request, made, Output(tmp_path / "cut.dxf"), closed(request, made))
    again = checked(found.path, project)
    assert again.sound and again.report.record is not None and again.report.record.trimmed == made.plan.trimmed > 0
    assert again.verdict is not None and found.verdict is not None and again.verdict.level is found.verdict.level


def test_that_a_file_of_another_design_is_refused_by_name(
    project: Document, exported: Callable[..., ExportedFiles]
) -> None:
    other = replace(project, candidates=project.candidates[:1], chosen=0, labels=(), marks=())
    found = checked(exported().files[0], other)
    assert found.sound and found.verdict is not None
    assert found.verdict.problems[0].code == "check.other_design"


@pytest.mark.parametrize("name", ["cut.dxf", "cut_r12.dxf", "cut.svg", "cut.lbrn2"])
def test_that_a_file_says_how_it_was_made(name: str, exported: Callable[..., ExportedFiles]) -> None:
    found = exported(style=ConnectorStyle.STRAIGHT, connector_mm=0.1234567891, hinge_mm=[(3, 0.33)], removed=[5])
    report = check_file(next(path for path in found.files if path.name == name))
    record = report.record
    assert isinstance(record, FileRecord) and report.ok
    assert (record.construction, record.options.style) == ("one-sheet", ConnectorStyle.STRAIGHT)
    assert record.connector_mm == 0.1234567891 and record.width_mm == 100.0
    assert record.options.hinge_mm == ((3, 0.33),) and record.options.removed == (5,)
    assert found.verdict is not None and record.verdict == found.verdict.level.value


def test_that_many_connectors_of_their_own_come_back(
    exported: Callable[..., ExportedFiles],
) -> None:
    widths = [(number, 0.2 + 0.001 * number) for number in range(40)]
    found = exported(hinge_mm=widths)
    for path in cut_files(found):
        if path.name != "reference.dxf":
            record = check_file(path).record
            assert record is not None and record.options.hinge_mm == tuple(widths)


def test_that_a_file_that_lost_a_cut_is_not_sound(exported: Callable[..., ExportedFiles], tmp_path: Path) -> None:
    (svg,) = (path for path in exported().files if path.name == "cut.svg")
    text = svg.read_text()
    start = text.index("<path")
    less = tmp_path / "less.svg"
    less.write_text(text[:start] + text[text.index("/>", start) + 2 :])
    codes = [problem.code for problem in check_file(less).problems]
    assert "cut_file.lines_differ" in codes


def test_that_pictures_of_a_set_are_no_cut_files(project: Document, exported: Callable[..., ExportedFiles]) -> None:
    found = exported()
    for name in ("cut-picture.svg", "reference.dxf"):
        (path,) = (one for one in found.files if one.name == name)
        alone = checked(path, project)
        assert not alone.ok and alone.verdict is None
        assert [problem.code for problem in alone.report.problems] == ["cut_file.not_for_cutting"]
    for name in ("cut.pdf", "preview.png", "cut.json"):
        with refused(ExportError, "cut_file.other_kind"):
            checked(next(one for one in found.files if one.name == name), project)


GOOD = {
    PROGRAM: "0.1.0",
    "CONSTRUCTION": "one-sheet",
    "DESIGN": "c0ffee",
    "WIDTH_MM": "100",
    "CONNECTOR_MM": "0.2",
    "LEAST_CONNECTOR_MM": "0.2",
    "KERF_MM": "0.02",
    "STYLE": "centred",
    "ORDER": "shortest",
    "PROFILE": "any",
    "MATERIAL": "film-uv",
    "LINES": "20",
}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("WIDTH_MM", "1e999"),
        ("WIDTH_MM", "nan"),
        ("WIDTH_MM", "9" * 5000),
        ("CONNECTOR_MM", "-1"),
        ("KERF_MM", "__import__('os')"),
        ("STYLE", "centred\x1b[2J"),
        ("PROFILE", "../../etc/passwd"),
        ("CONSTRUCTION", "pinned"),
        ("LINES", "1e9"),
        ("LINES", "99999999"),
        ("COPIES_ASKED", "100000"),
        ("TABS", "4000"),
        ("HINGE_MM_0", "3=0.2 3=0.3"),
        ("HINGE_MM_0", "1=" + "9" * 300),
        ("REMOVED_0", "5 -7"),
        ("MATERIAL", "x" * 300),
        ("VERDICT", "ready_to_cut_really"),
        ("CONNECTOR_MM", "0"),
        ("WIDTH_MM", "1e-300"),
        ("WIDTH_MM", "1_0"),
        ("KERF_MM", "\u0663"),
        ("MATERIAL", ""),
        ("MATERIAL", "\u202e"),
    ],
)
def test_that_a_hostile_record_is_refused_in_one_short_line(name: str, value: str) -> None:
    assert record_of(GOOD) is not None
    with pytest.raises(ExportError) as refusal:
        record_of({**GOOD, name: value})
    assert refusal.value.code == "cut_file.record_not_readable"
    assert len(str(refusal.value)) < 250 and str(refusal.value).isprintable()


def test_that_a_damaged_record_makes_a_file_unsound_and_no_more(
    exported: Callable[..., ExportedFiles], tmp_path: Path
) -> None:
    (svg,) = (path for path in exported().files if path.name == "cut.svg")
    bad = tmp_path / "bad.svg"
    bad.write_text(svg.read_text().replace("STYLE centred", "STYLE &lt;b&gt;"))
    report = check_file(bad)
    assert [problem.code for problem in report.problems] == ["cut_file.record_not_readable"]
    assert report.record is None and report.pieces == 1


@pytest.mark.parametrize(
    ("entry", "value"),
    [("KERF_MM", "-1"), ("KERF_MM", 400 * "9"), ("LINES", "x"), ("CONNECTOR_MM", "0"), ("MATERIAL", "")],
)
@pytest.mark.parametrize("name", ["cut.svg", "cut.dxf", "cut_r12.dxf", "cut.lbrn2"])
def test_that_a_hostile_record_in_a_file_is_said_once_and_its_geometry_is_checked_anyway(
    name: str, entry: str, value: str, exported: Callable[..., ExportedFiles], project: Document, tmp_path: Path
) -> None:
    (good,) = (path for path in exported().files if path.name == name)
    text = good.read_text(encoding="utf-8")
    # In a DXF beyond the next line, which says what follows; else behind a space.
    behind = r"(?: |\s+9\s+\$CUSTOMPROPERTY\s+1\r?\n|\s+1000\r?\n)"
    spoilt, times = re.subn(rf"(\b{entry}{behind})[^\s;&<]*", lambda found: found[1] + value, text)
    assert times >= 1
    bad = tmp_path / name
    bad.write_text(spoilt, encoding="utf-8")
    found = checked(bad)
    assert [problem.code for problem in found.report.problems].count("cut_file.record_not_readable") == 1
    (problem,) = (problem for problem in found.report.problems if problem.code == "cut_file.record_not_readable")
    assert problem.fields["name"] == entry and len(problem.text) < 250 and problem.text.isprintable()
    assert not found.sound and found.report.pieces == 1 and found.report.record is None
    try:
        assert checked(bad, project).verdict is not None
    except ExportError as error:
        assert value.startswith("99") and str(error).count(".. ") == 0  # the second reader takes no such number


def test_that_files_of_others_and_of_earlier_versions_have_no_record() -> None:
    assert record_of({}) is None and record_of({"STYLE": "centred"}) is None
    assert record_of({PROGRAM: "0.0.9", "KERF_MM": "0.02"}) is None


@pytest.mark.parametrize("value", [0.2, 1.0, 100.0, 0.1234567891, 1 / 3, 2999.999999])
def test_that_numbers_of_a_record_are_exact(value: float) -> None:
    assert float(exactly(value)) == value
