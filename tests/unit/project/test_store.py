"""A project file gives back the very document, and a bad one gives a sentence."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.second_target import SecondTarget, second_matches
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation.errors import ExportError, ProjectError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.polish.covering import fit_cover
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.project import migrations, store
from kirigami_studio.project.codec import encode
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.migrations import Members, migrate
from kirigami_studio.settings.fabrication import FabricationSettings
from tests.refusals import refused

PROJECTS = Path(__file__).parents[2] / "data" / "projects"
Change = Callable[[dict[str, bytes]], None]


def members_of(document: Document) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(store.pack(document))) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def write_members(path: Path, members: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def array_file(table: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, table)
    return stream.getvalue()


def test_that_a_project_comes_back_as_it_was(document: Document, tmp_path: Path) -> None:
    store.save(document, tmp_path / "a.kiri")
    again = store.load(tmp_path / "a.kiri")
    assert again == document
    assert again.target is not None and document.target is not None
    assert (again.target.name, again.target.size, again.target.unit) == ("pentagon", document.target.size, "mm")
    assert not again.candidates[0].sheet.field.ratio.flags.writeable


def test_that_an_own_material_comes_back_with_its_strains_and_sources(document: Document, tmp_path: Path) -> None:
    own = replace(find_material("cotton-co2"), key="mine", yield_strain=0.01, style=ConnectorStyle.ARC)
    store.save(replace(document, fabrication=FabricationSettings(material="mine", own=own)), tmp_path / "a.kiri")
    again = store.load(tmp_path / "a.kiri").fabrication.own
    assert again == own and again is not None and again.sources == own.sources
    assert (again.backing, again.construction, again.style) == (True, own.construction, ConnectorStyle.ARC)


def test_that_the_one_limit_of_an_own_material_in_an_older_project_is_that_of_both(
    document: Document, tmp_path: Path
) -> None:
    own = replace(find_material("card-co2"), key="mine")
    members = members_of(replace(document, fabrication=FabricationSettings(material="mine", own=own)))
    design = json.loads(members["design.json"])
    (record,) = [part["own"] for part in design.values() if isinstance(part, dict) and part.get("own")]
    newer = ("yield_strain", "break_strain", "bend_strain", "construction", "backing", "sheet_mm", "style", "sources")
    for name in newer:
        del record[name]
    record["strain_limit"] = 0.07
    members["design.json"] = json.dumps(design).encode()
    again = store.load(write_members(tmp_path / "old.kiri", members)).fabrication.own
    assert again is not None and (again.yield_strain, again.break_strain, again.bend_strain) == (0.0, 0.07, 0.07)
    assert (again.sources, again.sheet_mm, again.thickness_mm) == ({}, 100.0, own.thickness_mm)


def test_that_a_trimmed_design_comes_back_with_what_was_cut_off(pentagon: Outline, tmp_path: Path) -> None:
    fit = polish(RatioField.uniform(4, 4), pentagon, steps=8)
    deployment = deploy(fit.field)
    score = evaluate(deployment, pentagon)
    cut = fit_cover(fit.field, pentagon, steps=4, pose=score.transform).trim
    document = Document(pentagon, candidates=(Candidate(Sheet(fit.field), score, 0, 0, trim=cut),), chosen=0)
    store.save(document, tmp_path / "trimmed.kiri")
    again = store.load(tmp_path / "trimmed.kiri")
    assert again == document
    read = again.candidates[0].trim
    assert read is not None and read.iou == cut.iou
    pairs = zip(read.kept, cut.kept, strict=True)
    assert all((a is None) == (b is None) and (a is None or np.array_equal(a, b)) for a, b in pairs)
    assert any(part is not None for part in cut.kept)


def test_that_the_holes_of_a_target_come_back_and_files_without_stay_as_they_were(tmp_path: Path) -> None:
    square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    framed = Outline.from_points(square, holes=[[[1, 1], [2, 1], [2, 3]], [[2.5, 1], [3, 1], [3, 3]]])
    for target in (framed, framed.filled):
        store.save(Document(target=target), tmp_path / "frame.kiri")
        assert store.load(tmp_path / "frame.kiri").target == target
        named = any(b'"holes"' in content for content in members_of(Document(target=target)).values())
        assert named == bool(target.holes)


@pytest.mark.parametrize("start", [False, True])
def test_that_rim_start_outline_and_cell_come_back(pentagon: Outline, tmp_path: Path, start: bool) -> None:
    sheet = uneven_sheet(4, 5, seed=2, start=start)
    sheet = Sheet(sheet.field, sheet.rim, sheet.start, (1.0, 1.25))
    deployment = deploy(sheet)
    score = evaluate(deployment, pentagon)
    cut = trim(deployment, pentagon, 0.0, score.transform)
    sampled = uneven_sheet(4, 5, seed=9)
    first = Candidate(sheet, score, 0, 0, sampled_sheet=sampled, trim=cut)
    plain = Sheet(sheet.field)
    second = Candidate(plain, evaluate(deploy(plain), pentagon), 0, 1, sampled_sheet=Sheet.uniform(4, 5))
    document = Document(pentagon, candidates=(first, second), chosen=0)
    store.save(document, tmp_path / "uneven.kiri")
    again = store.load(tmp_path / "uneven.kiri")
    assert again == document
    assert again.candidates[0].sheet == sheet != again.candidates[1].sheet
    assert again.candidates[0].sampled_sheet == sampled and again.candidates[0].final_sheet == sheet


def test_that_second_targets_and_how_designs_show_them_come_back(document: Document, tmp_path: Path) -> None:
    before, after = SecondTarget(load("circle"), 0.8, 0.3), SecondTarget(load("drop"), 1.1, 2.0)
    (match,) = second_matches([deploy(document.candidates[0].sheet)], before)
    first = replace(document.candidates[0], second=match)
    wished = replace(
        document,
        candidates=(first, *document.candidates[1:]),
        settings=replace(document.settings, phi=0.5, second=after),
    )
    store.save(wished, tmp_path / "wished.kiri")
    again = store.load(tmp_path / "wished.kiri")
    assert again == wished and again.settings.second == after and again.candidates[0].second == first.second
    assert again.candidates[1].second is None
    assert b"second" not in encode(document)["design.json"]


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ([1.0], "must be a JSON object"),
        ({"rim": {"top": [1.0]}}, "top side: 1; a sheet of 4 x 5"),
        ({"rim": {"top": [0.5, 1e300]}}, "top side must lie"),
        ({"rim": {"top": "even"}}, "top side must be a list"),
        ({"start": [[0, 0]]}, "at least three points"),
        ({"cell": [1]}, "above 0"),
    ],
)
def test_that_a_damaged_rim_is_a_sentence(document: Document, tmp_path: Path, entry: object, words: str) -> None:
    members = members_of(document)
    design = json.loads(members["design.json"])
    design["candidates"][0]["sheet"] = entry
    members["design.json"] = json.dumps(design).encode()
    with pytest.raises(ProjectError, match=words) as caught:
        store.load(write_members(tmp_path / "bad.kiri", members))
    assert caught.value.code == "project.damaged"


def test_that_a_project_of_format_1_opens_with_even_rims() -> None:
    """Written by the program when format 1 was current."""
    opened = store.load(PROJECTS / "format_1.kiri")
    first, second = opened.candidates
    assert all(one.sheet.is_default and one.final_sheet.is_default for one in opened.candidates)
    assert first.sampled_sheet == second.sheet == Sheet.uniform(4, 5)
    assert first.trim is not None and first.trim.iou > first.score.iou_exact
    assert first.score.iou_exact == pytest.approx(evaluate(deploy(first.sheet), load("heart")).iou_exact, abs=1e-6)
    assert (opened.chosen, opened.locked, opened.marks) == (0, frozenset({(1, 2)}), (Mark.PINNED, Mark.NONE))


def test_that_an_empty_project_comes_back_as_it_was(tmp_path: Path) -> None:
    store.save(Document(), tmp_path / "new.kiri")
    assert store.load(tmp_path / "new.kiri") == Document()


def test_that_equal_documents_give_equal_bytes(document: Document, tmp_path: Path) -> None:
    store.save(document, tmp_path / "a.kiri")
    store.save(store.load(tmp_path / "a.kiri"), tmp_path / "b.kiri")
    assert (tmp_path / "a.kiri").read_bytes() == (tmp_path / "b.kiri").read_bytes()


def test_that_the_manifest_names_format_and_versions(document: Document) -> None:
    manifest = json.loads(members_of(document)["manifest.json"])
    assert manifest["version"] == 3
    assert manifest["app_version"]


def test_that_a_failed_save_keeps_the_old_project(document: Document, tmp_path: Path) -> None:
    blocked = tmp_path / "folder.kiri"
    blocked.mkdir()
    with pytest.raises(ExportError, match=r"folder\.kiri"):
        store.save(document, blocked)
    assert [path.name for path in tmp_path.iterdir()] == ["folder.kiri"]


def test_that_a_missing_project_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(ProjectError, match=r"Cannot read the project .*gone\.kiri: No such file") as caught:
        store.load(tmp_path / "gone.kiri")
    assert caught.value.code == "project.not_readable"
    with refused(ProjectError, "project.not_readable"):
        store.load(tmp_path)
    with refused(ProjectError, "project.not_a_file_name"):
        store.load("a\0b.kiri")


@pytest.mark.parametrize("content", [b"", b"PK", b"not a zip at all" * 100, b"\x89PNG\r\n\x1a\n"])
def test_that_another_kind_of_file_is_a_sentence(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "x.kiri").write_bytes(content)
    with pytest.raises(ProjectError, match="not a project file") as caught:
        store.load(tmp_path / "x.kiri")
    assert caught.value.code == "project.damaged"


def test_that_a_newer_project_asks_for_an_update(document: Document, tmp_path: Path) -> None:
    members = members_of(document)
    members["manifest.json"] = members["manifest.json"].replace(b'"version": 3', b'"version": 4')
    newer = write_members(tmp_path / "newer.kiri", members)
    with refused(ProjectError, "project.newer_format", current=3, version=4) as caught:
        store.load(newer)
    assert caught.value.code == "project.newer_format"


def test_that_a_project_of_format_1_opens_with_its_fixed_grid_and_even_rim(document: Document, tmp_path: Path) -> None:
    members = members_of(document)
    members["manifest.json"] = members["manifest.json"].replace(b'"version": 3', b'"version": 1')
    design = json.loads(members["design.json"])
    for name in ("auto_grid", "symmetry", "rim", "regular"):
        del design["settings"][name]
    for candidate in design["candidates"]:
        del candidate["score"]["evenness"]
    members["design.json"] = json.dumps(design).encode()
    opened = store.load(write_members(tmp_path / "old.kiri", members))
    fixed = replace(document.settings, auto_grid=False, symmetry="none", rim="even")
    assert opened == replace(document, settings=fixed)
    assert opened.candidates[0].score.evenness == document.candidates[0].score.evenness


def test_that_marks_locks_and_origins_come_back(document: Document, tmp_path: Path) -> None:
    origins = zip(document.candidates, (Origin.SAMPLED, Origin.RESAMPLED, Origin.EDITED), strict=True)
    candidates = tuple(replace(candidate, variant="balanced", origin=origin) for candidate, origin in origins)
    marks, locked = (Mark.PINNED, Mark.NONE, Mark.REJECTED), frozenset({(0, 4), (3, 0)})
    marked = replace(document, candidates=candidates, marks=marks, locked=locked)
    store.save(marked, tmp_path / "marked.kiri")
    assert store.load(tmp_path / "marked.kiri") == marked


def test_that_the_run_of_every_design_comes_back(document: Document, tmp_path: Path) -> None:
    runs = ((("k", "32"), ("polish", "0")), (("k", "8"), ("polish", "3")), ())
    candidates = tuple(replace(one, made_with=run) for one, run in zip(document.candidates, runs, strict=True))
    several = replace(document, candidates=candidates)
    store.save(several, tmp_path / "runs.kiri")
    opened = store.load(tmp_path / "runs.kiri")
    assert opened == several and tuple(one.made_with for one in opened.candidates) == runs
    store.save(opened, tmp_path / "again.kiri")
    assert (tmp_path / "again.kiri").read_bytes() == (tmp_path / "runs.kiri").read_bytes()


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("marks", ["none"], "one mark: got 1 for 3"),
        ("marks", ["none", "liked", "none"], "'liked' is none of none, pinned, rejected"),
        ("locked", [[4, 0]], r"Void \(4, 0\) cannot be locked: .* 4 x 5 voids"),
        ("locked", [[0.5, 0]], "whole number"),
        ("locked", [3], "3 is not the row and column of a void"),
    ],
)
def test_that_impossible_marks_are_a_sentence(
    document: Document, tmp_path: Path, name: str, value: list[object], said: str
) -> None:
    members = members_of(document)
    members["design.json"] = json.dumps({**json.loads(members["design.json"]), name: value}).encode()
    with pytest.raises(ProjectError, match=said):
        store.load(write_members(tmp_path / "odd.kiri", members))


def test_that_all_choices_about_the_cuts_come_back(document: Document, tmp_path: Path) -> None:
    options = CutOptions(ConnectorStyle.TEARDROP, CutOrder.SPREAD, 8, 0.7, ((1, 0.4), (5, 0.9)), (2, 3))
    settings = FabricationSettings(90.0, options=options, profile="lightburn", dxf_version="R12")
    store.save(replace(document, fabrication=settings), tmp_path / "cut.kiri")
    assert store.load(tmp_path / "cut.kiri").fabrication == settings


def test_that_engraving_the_name_is_kept_and_projects_without_it_are_as_before(
    document: Document, tmp_path: Path
) -> None:
    def fabrication(of: Document) -> dict[str, object]:
        found: dict[str, object] = json.loads(members_of(of)["design.json"])["fabrication"]
        return found

    named = replace(document, fabrication=replace(document.fabrication, engrave=True))
    assert fabrication(named) == {**fabrication(document), "engrave": True}
    assert "engrave" not in fabrication(document)
    store.save(named, tmp_path / "named.kiri")
    assert store.load(tmp_path / "named.kiri").fabrication.engrave
    assert not store.load(PROJECTS / "format_1.kiri").fabrication.engrave
    members = members_of(document)
    design = json.loads(members["design.json"])
    design["fabrication"]["engrave"] = "loudly"
    odd = write_members(tmp_path / "odd.kiri", {**members, "design.json": json.dumps(design).encode()})
    with pytest.raises(ProjectError, match="true or false"):
        store.load(odd)


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        ("style", "glued", "'glued' is none of centred"),
        ("order", "random", "'random' is none of shortest"),
        ("tabs", -1, "0 to 200 tabs"),
        ("tab_mm", 0.0, "tab width"),
        ("hinge_mm", [[3]], "is not the number of a connector with its width"),
        ("hinge_mm", [[3, "wide"]], "is not the width of a connector"),
        ("hinge_mm", [[3, -1.0]], "connector 3"),
        ("removed", [5, 4], "ascending"),
        ("removed", ["5"], "is not the number of a connector"),
    ],
)
def test_that_choices_which_make_no_sense_are_named(
    place: str, value: object, said: str, document: Document, tmp_path: Path
) -> None:
    members = members_of(document)
    design = json.loads(members["design.json"])
    design["fabrication"]["options"][place] = value
    members["design.json"] = json.dumps(design).encode()
    with pytest.raises(ProjectError, match=said):
        store.load(write_members(tmp_path / "odd.kiri", members))


def test_that_every_truncation_is_refused_or_whole(document: Document, tmp_path: Path) -> None:
    whole = store.pack(document)
    path = tmp_path / "cut.kiri"
    for length in range(0, len(whole), 97):
        path.write_bytes(whole[:length])
        with pytest.raises(ProjectError):
            store.load(path)


def test_that_no_flipped_byte_gives_a_traceback(document: Document, tmp_path: Path) -> None:
    whole = bytearray(store.pack(document))
    path = tmp_path / "flipped.kiri"
    refused = 0
    for place in range(0, len(whole), 13):
        damaged = bytearray(whole)
        damaged[place] ^= 0xFF
        path.write_bytes(damaged)
        try:
            assert store.load(path) == document  # a date or a comment: nothing that matters
        except ProjectError:
            refused += 1
    assert refused > len(whole) / 13 / 2


def drop(name: str) -> Change:
    return lambda members: members.__delitem__(name)


def put(name: str, content: bytes) -> Change:
    return lambda members: members.__setitem__(name, content)


def edit(*keys: str | int, to: object) -> Change:
    """Replace one value deep inside design.json."""

    def change(members: dict[str, bytes]) -> None:
        design = json.loads(members["design.json"])
        place = design
        for key in keys[:-1]:
            place = place[key]
        place[keys[-1]] = to
        members["design.json"] = json.dumps(design).encode()

    return change


def with_nan(members: dict[str, bytes]) -> None:
    table = np.load(io.BytesIO(members["ratios.npy"]))
    table[1, 2, 3] = np.nan
    members["ratios.npy"] = array_file(table)


def claiming(shape: str) -> bytes:
    """An array file whose header promises far more than it holds."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (drop("manifest.json"), "manifest.json is missing"),
        (drop("design.json"), "design.json is missing"),
        (drop("ratios.npy"), "ratios.npy is missing"),
        (put("manifest.json", b"{"), "manifest.json is not valid JSON"),
        (put("manifest.json", b'{"format": "comic book archive", "version": 1}'), "does not describe a project"),
        (put("manifest.json", b'{"format": "kirigami-studio project", "version": "1"}'), "whole number, got '1'"),
        (put("manifest.json", b'{"format": "kirigami-studio project", "version": 0}'), "does not describe"),
        (put("design.json", b"\xff\xfe"), "not valid JSON"),
        (put("design.json", b"[" * 100_000), "not valid JSON"),
        (put("design.json", b"[]"), "must be a JSON object"),
        (put("ratios.npy", b"junk"), "not a NumPy array file"),
        (put("ratios.npy", claiming("(3, 4000000, 5000000)")), "should hold"),
        (put("ratios.npy", claiming("(3, -4, -5)")), "ratios.npy"),
        (put("ratios.npy", array_file(np.ones((2, 4, 5)))), "each of 3 designs, got"),
        (put("ratios.npy", array_file(np.ones((3, 4)))), "each of 3 designs, got"),
        (put("ratios.npy", array_file(np.ones((3, 4, 5), dtype=np.float32))), "each of 3 designs, got"),
        (
            put("ratios.npy", array_file(np.array([{}] * 60, dtype=object).reshape(3, 4, 5))),
            "each of 3 designs, got",
        ),
        (put("ratios.npy", array_file(np.zeros((3, 4, 5)))), r"ratio at void \(0, 0\) is 0"),
        (put("ratios.npy", array_file(np.ones((3, 1, 5)))), "1 x 5"),
        (with_nan, r"void \(2, 3\) is nan"),
        (edit("target", "points", to=[[0, 0], [1, 0]]), "Try an earlier copy"),
        (edit("target", "points", to=[[0, 0], [1]]), "must be a table of numbers"),
        (edit("target", "points", to="round"), "must be a list"),
        (edit("target", "name", to=3), "must be text, got 3"),
        (edit("target", to=None), "target"),
        (edit("settings", "grid", to=[4, "5"]), "whole number, got '5'"),
        (edit("settings", "grid", to=[4]), "two whole numbers"),
        (edit("settings", "grid", to=[1, 5]), "1 x 5"),
        (edit("settings", "phi", to=9.0), "9"),
        (edit("settings", "phi", to=10**310), "must be a number"),
        (edit("settings", "k", to=True), "whole number, got True"),
        (edit("fabrication", "width_mm", to=-1), "got -1"),
        (edit("chosen", to=3), "no design with index 3; the project has 3"),
        (edit("candidates", 0, to=7), r"candidates\[0\] must be a JSON object"),
        (edit("candidates", 1, "polished", to=1), r"candidates\[1\].polished must be true or false"),
        (edit("candidates", 1, "score", "siou", to=None), r"score.siou must be a number"),
        (edit("candidates", 1, "score", "contact", to={"phi": 0.2, "where": [1]}), "where must be two numbers"),
        (edit("candidates", 1, "score", "transform", "scale", to=-1.0), "positive scale"),
        (edit("candidates", 1, "score", to={}), "score has no entry 'siou'"),
        (edit("candidates", 1, "score", "transform", to={}), "transform has no entry 'scale'"),
        (edit("candidates", 1, "sampled", to=True), "each of 2 designs, got"),
        (edit("candidates", 0, "trim", to={"ratio": [[1, "x"]]}), "trim.ratio must be a table of numbers"),
        (edit("settings", "prefer", to=3), "must be text, got 3"),
        (edit("settings", "symmetry", to="spiral"), "none of auto, none, mirror, turn"),
        (edit("settings", "k", to=5000), "from 1 to 1024, got 5000"),
        (drop("sampled.npy"), "sampled.npy is missing"),
        (edit("provenance", to={"model": 3}), "table of texts"),
        (edit("runs", to=[{"k": 3}]), "table of texts"),
        (edit("runs", to={}), "must be a list"),
        (edit("candidates", 1, "run", to=2), "run 2, but the number of runs in the file is 0"),
        (edit("candidates", 1, "run", to="first"), "whole number, got 'first'"),
        (edit("settings", to={}), "has no entry"),
    ],
)
def test_that_a_damaged_member_is_a_sentence(change: Change, said: str, document: Document, tmp_path: Path) -> None:
    members = members_of(document)
    change(members)
    with pytest.raises(ProjectError, match=said) as caught:
        store.load(write_members(tmp_path / "bad.kiri", members))
    assert caught.value.code == "project.damaged"
    assert str(caught.value).startswith(f"Cannot open {tmp_path / 'bad.kiri'}: the file is damaged. ")
    assert len(str(caught.value)) < 400 + len(str(tmp_path))


def test_that_nan_in_the_json_is_refused(document: Document, tmp_path: Path) -> None:
    members = members_of(document)
    members["design.json"] = members["design.json"].replace(b'"phi": 0.125', b'"phi": NaN')
    with pytest.raises(ProjectError, match="NaN is not a number"):
        store.load(write_members(tmp_path / "nan.kiri", members))


def test_that_a_zip_bomb_is_refused_before_it_unpacks(document: Document, tmp_path: Path) -> None:
    members = members_of(document) | {"bomb": bytes(store.LARGEST_CONTENT + 1)}
    with pytest.raises(ProjectError, match="unpacks to more than 128 MB"):
        store.load(write_members(tmp_path / "bomb.kiri", members))


def test_that_a_file_beyond_any_project_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.kiri"
    with path.open("wb") as stream:
        stream.truncate(store.LARGEST_FILE + 1)
    with refused(ProjectError, "project.file_too_large"):
        store.load(path)


def test_that_too_many_members_and_foreign_packing_are_refused(document: Document, tmp_path: Path) -> None:
    crowd = members_of(document) | {f"extra{k}": b"" for k in range(20)}
    with pytest.raises(ProjectError, match="24 members"):
        store.load(write_members(tmp_path / "crowd.kiri", crowd))
    with zipfile.ZipFile(tmp_path / "lzma.kiri", "w", zipfile.ZIP_LZMA) as archive:
        archive.writestr("manifest.json", members_of(document)["manifest.json"])
    with pytest.raises(ProjectError, match="compressed in a way"):
        store.load(tmp_path / "lzma.kiri")


def test_that_every_design_setting_and_score_field_survives(document: Document, tmp_path: Path) -> None:
    changed = replace(document, chosen=None, candidates=document.candidates[::-1])
    store.save(changed, tmp_path / "c.kiri")
    again = store.load(tmp_path / "c.kiri")
    for before, after in zip(changed.candidates, again.candidates, strict=True):
        assert after.score == before.score
        assert np.array_equal(after.sheet.field.ratio, before.sheet.field.ratio)


@pytest.mark.parametrize(("name", "weight"), [("circle", 1.0), ("rectangle:3:2", 1.0), ("egg", 1.0), ("egg", 0.03)])
def test_that_the_start_of_the_settings_comes_back(
    name: str, weight: float, document: Document, tmp_path: Path
) -> None:
    settings = replace(document.settings, start=replace(start_shape(name), weight=weight))
    store.save(replace(document, settings=settings), tmp_path / "start.kiri")
    again = store.load(tmp_path / "start.kiri").settings
    assert again == settings and again.start.digest == settings.start.digest
    plain = json.loads(members_of(document)["design.json"])["settings"]
    assert "start" not in plain, "projects of rectangles stay as they were"


def test_that_migrations_run_one_after_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    def second(members: Members) -> Members:
        return {**members, "order": members["order"] + b"2"}

    def third(members: Members) -> Members:
        return {**members, "order": members["order"] + b"3"}

    path = Path("a.kiri")
    monkeypatch.setattr(migrations, "CURRENT_VERSION", 3)
    monkeypatch.setattr(migrations, "MIGRATIONS", {1: second, 2: third})
    assert migrate({"order": b"1"}, 1, path) == {"order": b"123"}
    assert migrate({"order": b"1"}, 2, path) == {"order": b"13"}
    assert migrate({"order": b"1"}, 3, path) == {"order": b"1"}
    monkeypatch.setattr(migrations, "MIGRATIONS", {2: third})
    with pytest.raises(ProjectError, match=r"a\.kiri: its format 1 is older") as caught:
        migrate({}, 1, path)
    assert caught.value.code == "project.format_too_old"


def test_that_a_project_of_an_older_format_is_lifted_on_opening(
    document: Document, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a made-up next format, every project of the present one prefers accuracy."""
    now = migrations.CURRENT_VERSION
    store.save(document, tmp_path / "old.kiri")

    def with_preference(members: Members) -> Members:
        design = json.loads(members["design.json"])
        design["settings"]["prefer"] = "accuracy"
        return {**members, "design.json": json.dumps(design).encode()}

    monkeypatch.setattr(migrations, "CURRENT_VERSION", now + 1)
    monkeypatch.setattr(migrations, "MIGRATIONS", {now: with_preference})
    opened = store.load(tmp_path / "old.kiri")
    assert opened == replace(document, settings=replace(document.settings, prefer="accuracy"))
    assert json.loads(members_of(opened)["manifest.json"])["version"] == now + 1


def test_that_every_version_before_the_current_one_has_its_migration() -> None:
    assert sorted(migrations.MIGRATIONS) == list(range(1, migrations.CURRENT_VERSION))
