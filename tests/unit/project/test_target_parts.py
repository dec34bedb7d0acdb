"""A target of several parts: one project, one scale, every part with its designs."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import target_parts
from kirigami_studio.project.candidate_edits import NewDesigns, renew_candidates
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import edit_target, set_fabrication, set_settings, set_target
from kirigami_studio.project.history import History
from kirigami_studio.project.sheet_size import set_opened_size, size_of, sized
from kirigami_studio.project.store import load, pack, packed_design, packed_designs, save
from kirigami_studio.project.target_parts import kept_to_scale, parts_as_cut, set_parts, show_part, with_twins
from tests.refusals import refused


@pytest.fixture
def dot() -> Outline:
    angles = np.arange(24) * 2 * np.pi / 24
    return Outline.from_points(8 * np.stack([np.cos(angles), np.sin(angles)], axis=1), "dot", unit="mm")


@pytest.fixture
def letter(dot: Outline, pentagon: Outline) -> Document:
    """A project of two parts, the larger one last."""
    return set_parts(Document(), [(dot, (0.0, 60.0)), (pentagon, (0.0, 0.0))]).document


def designed(document: Document, candidates) -> Document:
    return renew_candidates(document, NewDesigns(candidates, {}), lambda one: one.index).document


def sizes(document: Document) -> list[float]:
    return [max(size_of(part).opened) for part in parts_as_cut(document)]


def test_that_the_first_part_is_shown_and_the_others_wait_in_their_order(letter, dot, pentagon) -> None:
    assert letter.target == dot and letter.part == 0
    assert [part.target.name for part in letter.parts] == ["dot", "pentagon"]
    assert [part.place for part in letter.parts] == [(0.0, 60.0), (0.0, 0.0)]


def test_that_parts_in_mm_open_to_the_size_that_they_were_drawn_with(letter, dot, pentagon) -> None:
    assert sizes(letter) == pytest.approx([max(dot.size), max(pentagon.size)], rel=1e-9)


def test_that_parts_in_pixels_are_to_one_scale_and_the_largest_sheet_is_as_wide_as_asked_for(dot, pentagon) -> None:
    pieces = [(replace(one, unit="px"), None) for one in (dot, pentagon)]
    letter = set_parts(set_fabrication(Document(), width_mm=120.0).document, pieces).document
    small, large = sizes(letter)
    assert small / large == pytest.approx(max(dot.size) / max(pentagon.size), rel=1e-9)
    assert parts_as_cut(letter)[1].fabrication.width_mm == pytest.approx(120.0, rel=1e-9)


def test_that_another_size_of_one_part_is_another_scale_for_all(letter) -> None:
    before = sizes(letter)
    wider = set_fabrication(letter, width_mm=2.0 * letter.fabrication.width_mm).document
    assert sizes(wider) == pytest.approx([2.0 * size for size in before], rel=1e-9)
    shown = show_part(wider, 1).document
    assert sizes(shown) == pytest.approx([2.0 * size for size in before], rel=1e-9)


@pytest.mark.parametrize("unit", ["mm", "px"])
def test_that_a_size_that_is_typed_is_another_scale_for_all(unit: str, dot, pentagon) -> None:
    letter = set_parts(Document(), [(replace(one, unit=unit), (0.0, 9.0)) for one in (dot, pentagon)]).document
    before = sizes(letter)
    typed = kept_to_scale(letter, set_opened_size(letter, 3.0 * before[0]).document)
    assert sizes(typed) == pytest.approx([3.0 * size for size in before], rel=1e-9)
    again = kept_to_scale(typed, set_opened_size(typed, before[0]).document)
    assert sizes(show_part(again, 1).document) == pytest.approx(before, rel=1e-9)
    # The drawing keeps its proportions: distance of the parts to their size.
    places, drawn = zip(*((part.place[1], max(part.target.size)) for part in again.parts), strict=True)
    assert places[0] == pytest.approx(places[1])
    assert drawn[0] / drawn[1] == pytest.approx(max(dot.size) / max(pentagon.size), rel=1e-9)


def test_that_another_shape_of_one_part_leaves_the_others_as_large_as_they_were(dot, pentagon) -> None:
    letter = set_parts(Document(), [(replace(one, unit="px"), None) for one in (dot, pentagon)]).document
    letter = set_fabrication(letter, width_mm=37.0).document
    before = sizes(letter)
    # The board draws in mm, whatever the source had.
    oval = Outline.from_points(dot.points * (30.0, 20.0), "dot", unit="mm")
    changed = kept_to_scale(letter, sized(edit_target(letter, oval, "Move point").document))
    assert sizes(changed)[0] == pytest.approx(max(oval.size), rel=1e-9)
    assert sizes(changed)[1] == pytest.approx(before[1], rel=1e-9)


def test_that_each_part_keeps_its_designs_and_all_share_settings(letter, candidates) -> None:
    shown = designed(show_part(letter, 1).document, candidates)
    before = sizes(shown)
    back = show_part(shown, 0).document
    assert back.candidates == () and back.parts[1].candidates == shown.candidates
    felt = set_settings(set_fabrication(back, connector_mm=0.7).document, seed=5).document
    again = show_part(felt, 1).document
    assert again.candidates == shown.candidates and again.chosen == 0
    assert (again.fabrication.connector_mm, again.settings.seed) == (0.7, 5)
    # The dot's sheet opens to what it was; the scale does not wander.
    assert sizes(again)[0] == pytest.approx(before[0], rel=1e-9)


def test_that_designs_open_to_one_scale_whatever_their_sheets(letter, candidates, dot, pentagon) -> None:
    for number in range(len(candidates)):
        document = replace(designed(show_part(letter, 1).document, candidates), chosen=number)
        one, other = sizes(show_part(document, 0).document)
        assert one / other == pytest.approx(max(dot.size) / max(pentagon.size), rel=1e-9)


def test_that_another_target_has_no_parts_and_a_reshaped_part_keeps_them(letter, pentagon) -> None:
    assert not set_target(letter, pentagon).document.other_parts
    reshaped = edit_target(letter, replace(pentagon, name="blob"), "Rotate target").document
    assert [part.target.name for part in reshaped.parts] == ["blob", "pentagon"]


def test_that_a_part_that_is_not_there_is_refused(letter, dot) -> None:
    with refused(ProjectError, "project.no_such_part"):
        show_part(letter, 2)
    with refused(ProjectError, "project.no_such_part"):
        replace(letter, part=2)
    with refused(ProjectError, "project.part_without_target"):
        replace(letter, other_parts=(Document(),))


def test_that_parts_survive_their_file_with_all_that_belongs_to_each(letter, candidates, tmp_path: Path) -> None:
    document = show_part(designed(show_part(letter, 1).document, candidates), 0).document
    save(document, tmp_path / "letter.kiri")
    found = load(tmp_path / "letter.kiri")
    assert found == document and found.parts == document.parts
    assert [part.place for part in found.parts] == [part.place for part in document.parts]
    assert pack(found) == pack(document)


def test_that_a_project_of_one_part_is_saved_as_before(document, tmp_path: Path) -> None:
    save(document, tmp_path / "one.kiri")
    with zipfile.ZipFile(tmp_path / "one.kiri") as archive:
        assert sorted(archive.namelist()) == ["design.json", "manifest.json", "ratios.npy", "sampled.npy"]
        assert not {"parts", "place"} & set(json.loads(archive.read("design.json")))


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"parts": {"others": 2, "at": 0}}, "project.damaged"),  # one of them is missing
        ({"parts": {"others": 1, "at": 7}}, "project.damaged"),
        ({"parts": {"others": 10**9, "at": 0}}, "project.damaged"),
        ({"parts": {"others": -1, "at": 0}}, "project.damaged"),
        ({"place": [0.0, float("inf")]}, "project.damaged"),
    ],
)
def test_that_a_file_that_lies_about_its_parts_is_damaged(letter, changes, code, tmp_path: Path) -> None:
    path = tmp_path / "lie.kiri"
    save(letter, path)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members["design.json"] = json.dumps(json.loads(members["design.json"]) | changes).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    with refused(ProjectError, code):
        load(path)


def test_that_a_cut_file_carries_one_design_or_the_chosen_one_of_every_part(letter, candidates, tmp_path) -> None:
    document = designed(show_part(letter, 1).document, candidates)
    for name, content in (("one", packed_design(document, document.candidates[2])), ("all", packed_designs(document))):
        (tmp_path / f"{name}.kiri").write_bytes(content)
    one, every = load(tmp_path / "one.kiri"), load(tmp_path / "all.kiri")
    assert one.candidates == (document.candidates[2],) and not one.other_parts
    assert [len(part.candidates) for part in every.parts] == [0, 1]


def test_that_undo_leads_back_to_the_part_that_was_shown(letter, candidates) -> None:
    history = History(letter)
    history.apply(show_part(letter, 1))
    history.apply(replace(set_settings(history.document, seed=3)))
    assert history.document.part == 1
    history.undo()
    history.undo()
    assert history.document == letter


def test_that_a_part_is_put_back_among_the_others(letter, candidates) -> None:
    part = designed(parts_as_cut(letter)[1], candidates)
    changed = target_parts.with_part(letter, 1, part)
    assert changed.part == 0 and changed.parts[1].candidates == part.candidates
    assert target_parts.with_part(show_part(letter, 1).document, 1, part).candidates == part.candidates


def test_that_a_file_of_more_parts_than_a_target_can_have_is_refused_unread(letter, tmp_path: Path) -> None:
    path = tmp_path / "crowd.kiri"
    path.write_bytes(pack(letter))
    with zipfile.ZipFile(path, "a") as archive:
        for number in range(2, 72):
            archive.writestr(f"part-{number}-design.json", b"")
    with refused(ProjectError, "project.damaged"):
        load(path)


def test_that_parts_of_one_shape_and_size_are_twins_wherever_they_lie(dot, pentagon) -> None:
    moved = Outline.from_points(np.roll(dot.points, 5, axis=0) * max(dot.size) / np.ptp(dot.points), "copy", unit="mm")
    larger = Outline.from_points(9.0 * dot.points, "larger", unit="mm")
    pieces = [(dot, (0.0, 0.0)), (pentagon, (9.0, 0.0)), (moved, (50.0, 3.0)), (larger, (0.0, 70.0)), (dot, (9.0, 9.0))]
    assert target_parts.twins(parts_as_cut(set_parts(Document(), pieces).document)) == (0, 1, 0, 3, 0)


def test_that_parts_of_one_shape_and_size_share_their_designs_and_keep_their_places(candidates, dot, pentagon) -> None:
    twin = replace(dot, name="other dot")
    pieces = [(dot, (0.0, 60.0)), (pentagon, (0.0, 0.0)), (twin, (40.0, 60.0))]
    letter = set_parts(Document(), pieces).document
    alone = designed(show_part(letter, 1).document, candidates)
    assert with_twins(alone, 1) == alone
    first = with_twins(designed(letter, candidates), 0)
    dots = first.parts[0], first.parts[2]
    assert [part.candidates for part in dots] == [candidates, candidates]
    assert [(part.target.name, part.place) for part in dots] == [("dot", (0.0, 60.0)), ("other dot", (40.0, 60.0))]
    # One that has designs of its own keeps them.
    own = designed(show_part(letter, 2).document, candidates[:1])
    assert with_twins(designed(show_part(own, 0).document, candidates), 0).parts[2].candidates == candidates[:1]
