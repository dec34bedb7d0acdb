"""Pieces on a bed: what a beam of some width leaves of the sheet, in which order, and what is engraved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from pinned_assemblies import EAR_MM, HOLE_MM, small_assembly
from shapely.geometry import LineString, Point, Polygon

from kirigami_studio.assembly.pieces import Piece, RoundHole
from kirigami_studio.export.cut_bed import WEB_MM, CutBed, laid_on_beds
from kirigami_studio.export.pieces_read import found_pieces
from kirigami_studio.export.profile import NAME_LAYER, find_profile
from kirigami_studio.fabricate.engraving import clearance_mm
from kirigami_studio.foundation.errors import FabricationError

KERF_MM, BED = 0.2, (300.0, 200.0)


@pytest.fixture(scope="module")
def pieces() -> tuple[Piece, ...]:
    return small_assembly(2, 3, 5).pieces


@pytest.fixture(scope="module")
def beds(pieces: tuple[Piece, ...]) -> tuple[CutBed, ...]:
    return laid_on_beds(pieces, KERF_MM, BED)


def test_that_a_beam_leaves_every_piece_in_its_finished_size(beds: tuple[CutBed, ...]) -> None:
    """Cut a plate along the strokes with a round beam: the parts that are left are the pieces, holes included."""
    for bed in beds:
        strokes = [s for s in bed.strokes(find_profile("any")) if s.layer != NAME_LAYER]
        ways = [LineString(stroke.travelled(1e-4)) for stroke in strokes]
        plate = shapely.box(-5.0, -5.0, *(np.array(bed.size_mm) + 5.0))
        parts = shapely.get_parts(
            shapely.difference(plate, shapely.union_all(shapely.buffer(ways, 0.5 * KERF_MM, quad_segs=64)))
        )
        for cuts, place in bed.placed:
            meant = Polygon(place.put(cuts.piece.outline))
            rounds = [Point(place.put(h.centre)).buffer(0.5 * h.diameter_mm, quad_segs=256) for h in cuts.piece.holes]
            meant = meant.difference(shapely.union_all(rounds))
            (found,) = (part for part in parts if part.intersection(meant).area > 0.5 * meant.area)
            # Corners that point inwards keep a fillet of half a kerf.
            assert meant.difference(found.buffer(1e-3)).area < 1e-9
            fillets = meant.buffer(0.5 * KERF_MM, quad_segs=64).buffer(-0.5 * KERF_MM, quad_segs=64)
            assert found.difference(fillets.buffer(1e-3)).area < 1e-9


def test_that_round_holes_stay_circles_smaller_by_the_kerf(beds: tuple[CutBed, ...]) -> None:
    for bed in beds:
        circles = [stroke for stroke in bed.strokes(find_profile("any")) if stroke.circle]
        assert len(circles) == sum(len(cuts.piece.holes) for cuts in bed.pieces)
        assert [np.ptp(circle.points[:, 0]) for circle in circles] == pytest.approx([HOLE_MM - KERF_MM] * len(circles))
        meant = np.concatenate([[place.put(hole.centre) for hole in cuts.piece.holes] for cuts, place in bed.placed])
        found = np.array([circle.points.mean(axis=0) for circle in circles])
        away = np.linalg.norm(meant[:, None] - found[None], axis=2)
        assert away.min(axis=0).max() < 1e-4 and away.min(axis=1).max() < 1e-4


def test_that_numbers_come_first_then_holes_and_outlines_last(beds: tuple[CutBed, ...]) -> None:
    for bed in beds:
        layers = [stroke.layer for stroke in bed.strokes(find_profile("lightburn"))]
        assert list(dict.fromkeys(layers)) == [NAME_LAYER, "HOLES", "OUTLINE"]
        assert layers == sorted(layers, key=[NAME_LAYER, "HOLES", "OUTLINE"].index)
        assert layers.count("OUTLINE") == len(bed.pieces)


def test_that_neighbours_keep_material_between_their_cuts_and_coordinates_begin_at_0(beds: tuple[CutBed, ...]) -> None:
    for bed in beds:
        lines = [LineString(s.travelled()) for s in bed.strokes(find_profile("any")) if s.layer == "OUTLINE"]
        least = min(one.distance(other) for at, one in enumerate(lines) for other in lines[:at])
        assert least >= KERF_MM + WEB_MM - 1e-3
        assert np.concatenate([line.coords for line in lines]).min(axis=0) == pytest.approx([0.0, 0.0])


def test_that_numbers_lie_in_their_pieces_clear_of_cuts_with_a_bar_below(beds: tuple[CutBed, ...]) -> None:
    for bed in beds:
        for cuts in bed.pieces:
            solid = Polygon(cuts.outline).difference(
                shapely.union_all([Point(h.centre).buffer(0.5 * h.diameter_mm) for h in cuts.holes])
            )
            assert cuts.number and all(
                solid.buffer(-clearance_mm(KERF_MM) + 1e-2).contains(LineString(line)) for line in cuts.number
            )
            *letters, bar = cuts.number
            assert len(bar) == 2 and bar[0][1] == bar[1][1] < min(line[:, 1].min() for line in letters)


def test_that_programs_that_cut_all_they_get_get_no_numbers(beds: tuple[CutBed, ...]) -> None:
    for key in ("single", "slots", "silhouette"):
        assert all(stroke.layer != NAME_LAYER for bed in beds for stroke in bed.strokes(find_profile(key)))


def test_that_programs_without_arcs_get_chords(beds: tuple[CutBed, ...]) -> None:
    strokes = [stroke for stroke in beds[0].strokes(find_profile("k40")) if stroke.layer == "HOLES"]
    assert all(not stroke.circle and stroke.bulges is None and len(stroke.points) > 8 for stroke in strokes)


def test_that_openings_are_cut_within_their_outline(pieces: tuple[Piece, ...]) -> None:
    window = np.array([[-2.0, -2.0], [-2.0, 2.0], [2.0, 2.0], [2.0, -2.0]])
    (bed,) = laid_on_beds([replace(pieces[0], openings=(window,))], KERF_MM, BED)
    (opening,) = bed.pieces[0].openings
    assert np.abs(opening).max() == pytest.approx(2.0 - 0.5 * KERF_MM)
    assert not Polygon(opening).exterior.is_ccw


def test_that_a_hole_or_an_opening_that_the_kerf_would_use_up_is_refused(pieces: tuple[Piece, ...]) -> None:
    tiny = replace(pieces[0], holes=(RoundHole(np.zeros(2), KERF_MM),))
    with pytest.raises(FabricationError) as refusal:
        laid_on_beds([tiny], KERF_MM, BED)
    assert refusal.value.code == "pieces.hole_within_kerf"
    slit = np.array([[-2.0, -0.05], [-2.0, 0.05], [2.0, 0.05], [2.0, -0.05]])
    with pytest.raises(FabricationError) as refusal:
        laid_on_beds([replace(pieces[0], openings=(slit,))], KERF_MM, BED)
    assert refusal.value.code == "pieces.narrower_than_kerf"


def test_that_a_notch_with_a_narrow_mouth_is_cut_from_the_inside() -> None:
    notch = [[9.0, -0.05], [2.0, -0.05], [2.0, -2.0], [-2.0, -2.0], [-2.0, 2.0], [2.0, 2.0], [2.0, 0.05], [9.0, 0.05]]
    outline = np.array([*notch, [9.0, 9.0], [-9.0, 9.0], [-9.0, -9.0], [9.0, -9.0]])
    piece = Piece("A1", 1, (0, 0), outline if Polygon(outline).exterior.is_ccw else outline[::-1])
    (bed,) = laid_on_beds([piece], KERF_MM, BED)
    (cuts,) = bed.pieces
    assert np.abs(cuts.outline).max() == pytest.approx(9.0 + 0.5 * KERF_MM)
    (pocket,) = cuts.openings
    assert Polygon(pocket).area == pytest.approx((4.0 - KERF_MM) ** 2, rel=0.01)
    findings, _ = found_pieces(bed.strokes(find_profile("any")), bed, KERF_MM)
    assert [finding.code for finding in findings] == ["verify.pieces_found", "verify.numbers"]


def test_that_a_piece_beyond_the_bed_lies_alone(pieces: tuple[Piece, ...]) -> None:
    beds = laid_on_beds(pieces[:3], KERF_MM, (0.5 * EAR_MM, 0.5 * EAR_MM))
    assert [len(bed.pieces) for bed in beds] == [1, 1, 1]


def test_that_the_same_pieces_are_laid_once(pieces: tuple[Piece, ...]) -> None:
    assert laid_on_beds(pieces, KERF_MM, BED) is laid_on_beds(tuple(pieces), KERF_MM, BED)


def test_that_corners_that_the_beam_goes_round_have_few_points() -> None:
    """A step of 4 µm in the rim, as pieces that were extended have, takes sharp corners from the whole cut."""
    turn = 2.0 * np.pi * np.arange(30) / 30
    disc = np.column_stack([np.cos(turn), np.sin(turn)])
    outline = np.vstack([9.0 * disc[:16], 9.004 * disc[15:], 9.004 * disc[:1]])
    (bed,) = laid_on_beds([Piece("A1", 1, (0, 0), outline)], KERF_MM, BED)
    (cuts,) = bed.pieces
    (finding, *_), _ = found_pieces(bed.strokes(find_profile("any")), bed, KERF_MM)
    assert finding.code == "verify.pieces_found" and float(str(finding.fields["miss_um"])) < 0.6
    assert len(cuts.outline) <= 1.5 * len(outline), "round beside the step alone"


def test_that_narrow_spikes_keep_their_tips_where_the_beam_goes_round_corners() -> None:
    """A spike of 10 degrees beside a step of 4 µm: random pinned design 55 had one, and lost 5 µm of it."""
    turn = 2.0 * np.pi * np.arange(90) / 90
    disc = np.column_stack([np.cos(turn), np.sin(turn)])
    spike = np.array([[0.02, 9.004], [0.0, 9.24], [-0.02, 9.004]])
    outline = np.vstack([9.004 * disc[:22], spike, 9.004 * disc[24:46], 9.0 * disc[45:], 9.0 * disc[:1]])
    (bed,) = laid_on_beds([Piece("A1", 1, (0, 0), outline)], 0.05, BED)
    (finding, *_), _ = found_pieces(bed.strokes(find_profile("any")), bed, 0.05)
    assert finding.code == "verify.pieces_found" and float(str(finding.fields["miss_um"])) < 1.5
