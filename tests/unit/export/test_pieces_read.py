"""Pieces read back from files: faults in strokes, in places and in the motion are found."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pinned_assemblies import small_assembly

from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.export.assembly_files import pieces_json
from kirigami_studio.export.cut_bed import CutBed, laid_on_beds
from kirigami_studio.export.lightburn import strokes_lightburn
from kirigami_studio.export.lightburn_reading import read_project, scan_project
from kirigami_studio.export.pieces_read import FoundPiece, found_pieces, motion_findings
from kirigami_studio.export.profile import NAME_LAYER, find_profile
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.fabricate.machine import machine_of
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.foundation.errors import ExportError

KERF_MM = 0.2


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return small_assembly(2, 3, 5)


@pytest.fixture(scope="module")
def beds(assembly: Assembly) -> tuple[CutBed, ...]:
    return laid_on_beds(assembly.pieces, KERF_MM, (0.0, 0.0))


@pytest.fixture(scope="module")
def found(beds: tuple[CutBed, ...]) -> dict[str, FoundPiece]:
    return {
        piece.id: piece for bed in beds for piece in found_pieces(bed.strokes(find_profile("any")), bed, KERF_MM)[1]
    }


def first(strokes: Sequence[Stroke], layer: str, change: Callable[[Stroke], Stroke | None]) -> list[Stroke]:
    """The strokes with the first one of a layer changed, or left out."""
    at = next(number for number, stroke in enumerate(strokes) if stroke.layer == layer)
    changed = change(strokes[at])
    return [*strokes[:at], *([] if changed is None else [changed]), *strokes[at + 1 :]]


def moved(by: float) -> Callable[[Stroke], Stroke]:
    return lambda stroke: replace(stroke, points=stroke.points + np.array([by, 0.0]))


def corner_moved(stroke: Stroke) -> Stroke:
    points = stroke.points.copy()
    points[0] += 0.01
    return replace(stroke, points=points)


FAULTS = [
    ("HOLES", moved(0.002), "verify.pieces_differ"),
    ("HOLES", lambda s: Stroke.round(s.points.mean(axis=0), 3.01, s.layer, s.colour), "verify.pieces_differ"),
    ("HOLES", lambda s: None, "verify.pieces_differ"),
    ("OUTLINE", corner_moved, "verify.pieces_differ"),
    ("OUTLINE", moved(0.005), "verify.pieces_differ"),
    ("OUTLINE", lambda s: None, "verify.pieces_lost"),
    ("OUTLINE", moved(500.0), "verify.pieces_lost"),
    ("OUTLINE", lambda s: replace(s, closed=False), "verify.pieces_open"),
    (NAME_LAYER, moved(12.0), "verify.numbers_cut"),
]


@pytest.mark.parametrize(("layer", "change", "code"), FAULTS)
def test_that_a_stroke_that_is_not_as_meant_is_found(
    beds: tuple[CutBed, ...], layer: str, change: Callable[[Stroke], Stroke | None], code: str
) -> None:
    strokes = first(beds[0].strokes(find_profile("lightburn")), layer, change)
    findings, _ = found_pieces(strokes, beds[0], KERF_MM)
    assert code in {finding.code for finding in findings if not finding.ok}


def test_that_numbers_after_cuts_are_found(beds: tuple[CutBed, ...]) -> None:
    strokes = beds[0].strokes(find_profile("lightburn"))
    findings, _ = found_pieces(strokes[::-1], beds[0], KERF_MM)
    assert [finding.code for finding in findings if not finding.ok] == ["verify.numbers_cut"]


def test_that_another_kerf_than_the_file_allows_for_is_found(beds: tuple[CutBed, ...]) -> None:
    strokes = beds[0].strokes(find_profile("any"))
    assert all(finding.ok for finding in found_pieces(strokes, beds[0], KERF_MM)[0])
    assert not all(finding.ok for finding in found_pieces(strokes, beds[0], KERF_MM + 0.01)[0])


def test_that_pieces_are_found_as_they_were_asked_for(found: dict[str, FoundPiece], assembly: Assembly) -> None:
    assert list(found) == [piece.id for piece in sorted(assembly.pieces, key=lambda piece: piece.layer)]
    assert max(piece.outline_miss_mm for piece in found.values()) < 1e-3
    assert max(piece.hole_miss_mm for piece in found.values()) < 2e-4


def codes_of_motion(found: dict[str, FoundPiece], record: dict) -> list[str]:
    return [finding.code for finding in motion_findings(found, record)]


def test_that_the_motion_is_judged_at_every_angle(found: dict[str, FoundPiece], assembly: Assembly) -> None:
    record = pieces_json(assembly, angles=31)
    assert codes_of_motion(found, record) == ["verify.pins_meet", "verify.pieces_pass"]
    turned = copy.deepcopy(record)
    turned["motion"][17]["poses"]["A1"][2] += 1e-3
    assert codes_of_motion(found, turned) == ["verify.pins_miss", "verify.pieces_pass"]
    shifted = copy.deepcopy(record)
    ids = [piece["id"] for piece in record["pieces"] if piece["layer"] == 1]
    shifted["motion"][9]["poses"][ids[0]] = shifted["motion"][9]["poses"][ids[1]]
    assert codes_of_motion(found, shifted) == ["verify.pins_miss", "verify.pieces_collide"]
    (collision,) = (one for one in motion_findings(found, shifted) if one.code == "verify.pieces_collide")
    assert {collision.fields["one"], collision.fields["other"]} == set(ids[:2])
    assert collision.fields["phi_deg"] == pytest.approx(record["motion"][9]["phi_deg"])


def test_that_a_pin_beside_its_hole_is_found(found: dict[str, FoundPiece], assembly: Assembly) -> None:
    record = pieces_json(assembly, angles=3)
    record["hinges"][0]["at"][0][0] += 0.01
    assert codes_of_motion(found, record)[0] == "verify.pins_miss"


@pytest.fixture
def project(beds: tuple[CutBed, ...], tmp_path: Path) -> Path:
    plywood, path = find_material("plywood-co2"), tmp_path / "bed.lbrn2"
    strokes = beds[0].strokes(find_profile("lightburn"))
    path.write_bytes(strokes_lightburn(strokes, plywood, machine_of(plywood), {"LAYER": "1"}))
    return path


def test_that_both_readers_of_projects_find_the_strokes(beds: tuple[CutBed, ...], project: Path) -> None:
    strokes = beds[0].strokes(find_profile("lightburn"))
    for content in (read_project(project), scan_project(project)):
        assert [(s.layer, s.colour, s.closed, s.circle) for s in content.strokes] == [
            (s.layer, s.colour, s.closed, s.circle) for s in strokes
        ]
        for one, other in zip(content.strokes, strokes, strict=True):
            assert np.abs(one.points - other.points).max() < 1e-9


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('Type="Ellipse"', 'Type="Rect"'),
        ('Rx="1.5"', 'Rx="1.6"'),
        ("1 0 0 1 0 0", "0 1 -1 0 0 0"),
        ("L0 1", "B0 1"),
        ("</VertList>", "</NoList>"),
    ],
)
def test_that_neither_reader_of_projects_takes_other_shapes(project: Path, old: str, new: str) -> None:
    text = project.read_text()
    assert old in text
    project.write_text(text.replace(old, new, 1))
    for read in (read_project, scan_project):
        with pytest.raises(ExportError):
            read(project)
