"""sIoU of masks: the released evaluator's values, symmetry, invariance, holes and pieces, bad input."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from scipy.ndimage import rotate, zoom

from kirigami_studio.evaluate.mask_siou import FittedMask, best_pose, mask_siou, posed_iou, released_siou
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.outlines import silhouettes

#: Poses that a score is averaged over, and how far they lie apart (radians, share of scale; pixels).
POSES, APART, APART_PIXELS = 12, 1e-3, 0.1


def settled_siou(a: np.ndarray, b: np.ndarray, *, crop: bool) -> float:
    """The sIoU about the best pose instead of at it.

    Whole pixels are counted, so a pose that another processor rounds 1e-4 differently changes a score by 0.002: a
    count of steps has no derivative, the mean of counts nearby has.
    """
    moving, fixed = FittedMask.from_array(a, 1), FittedMask.from_array(b, 2)
    if moving.key > fixed.key:
        moving, fixed = fixed, moving
    pose, middle, draw = best_pose(moving, fixed, crop)[1], fixed.centroid(), np.random.default_rng(0)
    values = []
    for grown, turned, x, y in draw.normal(size=(POSES, 4)):
        factor = np.exp(APART * complex(grown, turned))
        shift = middle - factor * middle + APART_PIXELS * complex(x, y)
        near = Similarity.from_complex(factor, shift).compose(pose)
        values += [posed_iou(moving, fixed, near, crop), posed_iou(fixed, moving, near.inverse(), crop)]
    return float(np.mean(values))


def test_that_good_matches_score_as_the_released_evaluator_does(oracles: Mapping[str, np.ndarray]) -> None:
    pairs = list(zip(oracles["near_candidate_mask"], oracles["near_target_mask"], strict=True))
    cropped = np.array([settled_siou(a, b, crop=True) for a, b in pairs]) - oracles["near_siou"]
    ours = np.array([settled_siou(a, b, crop=False) for a, b in pairs]) - oracles["near_siou"]
    assert np.abs(cropped).max() < 0.01
    assert np.abs(ours).max() < 0.01
    assert abs(ours.mean()) < 0.002


def test_that_a_score_at_the_best_pose_is_that_about_it(oracles: Mapping[str, np.ndarray]) -> None:
    pairs = zip(oracles["near_candidate_mask"][:8], oracles["near_target_mask"][:8], strict=True)
    apart = [mask_siou(a, b)[0] - settled_siou(a, b, crop=False) for a, b in pairs]
    assert np.abs(apart).max() < 0.01 and abs(np.mean(apart)) < 0.003


def test_that_poor_matches_are_not_flattered_by_the_canvas(oracles: Mapping[str, np.ndarray]) -> None:
    masks = oracles["10x10_mask"]
    pairs, reference = oracles["siou_pairs"][:16], oracles["siou_values"][:16]
    ours = np.array([mask_siou(masks[i], masks[j])[0] for i, j in pairs])
    assert ((ours > 0.3) & (ours <= 1.0)).all()
    assert (ours - reference).max() < 0.02
    assert (ours - reference).min() > -0.2


def test_that_the_released_measure_scores_as_the_released_evaluator_does(oracles: Mapping[str, np.ndarray]) -> None:
    masks = oracles["10x10_mask"]
    pairs, reference = oracles["siou_pairs"][16:28], oracles["siou_values"][16:28]
    found = np.array([released_siou(masks[i], masks[j]) for i, j in pairs])
    assert np.abs(found - reference).mean() < 0.015
    near = zip(oracles["near_candidate_mask"][:6], oracles["near_target_mask"][:6], strict=True)
    assert [released_siou(a, b) for a, b in near] == pytest.approx(list(oracles["near_siou"][:6]), abs=0.01)


def test_that_the_released_measure_forgives_what_leaves_the_designs_canvas() -> None:
    sheet, disc = np.ones((128, 128), dtype=np.bool_), rasterise(silhouettes.load("circle").points)
    assert released_siou(sheet, disc) > mask_siou(sheet, disc)[0] + 0.05
    assert released_siou(disc, disc) == 1.0


def test_that_swapping_the_masks_changes_nothing(oracles: Mapping[str, np.ndarray]) -> None:
    masks = oracles["10x10_mask"]
    for i, j in oracles["siou_pairs"][20:26]:
        value, transform = mask_siou(masks[i], masks[j])
        back, inverse = mask_siou(masks[j], masks[i])
        assert back == value
        np.testing.assert_allclose(inverse.compose(transform).matrix, Similarity().matrix, atol=1e-9)


def test_that_a_mask_matches_itself_fully() -> None:
    mask = rasterise(silhouettes.load("star").points)
    assert mask_siou(mask, mask)[0] == 1.0


@pytest.mark.parametrize("size", [60, 128, 500])
def test_that_size_place_and_rotation_of_the_mask_hardly_matter(size: int) -> None:
    heart = rasterise(silhouettes.load("heart").points)
    turned = rasterise(Similarity(1.0, 2.0).apply(silhouettes.load("heart").points), size)
    placed = np.pad(turned, ((5, 40), (70, 3)))
    assert mask_siou(heart, placed)[0] > (0.965 if size == 60 else 0.98)


def test_that_the_transform_takes_pixels_to_pixels(letter_l: FloatArray) -> None:
    mask = rasterise(letter_l, 100)
    _, transform = mask_siou(mask, np.pad(mask, ((0, 10), (30, 0))))
    np.testing.assert_allclose(transform.apply([(20.0, 50.0)]), [(50.0, 60.0)], atol=0.5)
    assert transform.scale == pytest.approx(1.0, abs=0.01)


def test_that_a_mirrored_letter_is_not_a_match(letter_l: FloatArray) -> None:
    mask = rasterise(letter_l)
    assert mask_siou(mask, mask[:, ::-1])[0] < 0.9


def test_that_a_hole_off_the_middle_of_a_disc_decides_its_rotation() -> None:
    y, x = np.mgrid[0:128, 0:128]
    holed = ((x - 64) ** 2 + (y - 64) ** 2 < 60**2) & ((x - 64) ** 2 + (y - 35) ** 2 > 18**2)
    turned = rotate(holed.astype(float), 73.0, order=1) > 0.5
    assert mask_siou(holed, turned)[0] > 0.97
    assert mask_siou(holed, (x - 64) ** 2 + (y - 64) ** 2 < 60**2)[0] < 0.93


def test_that_all_pieces_of_a_mask_count() -> None:
    pieces = np.zeros((100, 100))
    pieces[10:40, 10:60] = 1
    pieces[60:90, 40:95] = 1
    moved = zoom(rotate(pieces, -77.0, order=1), 2.0, order=1)
    assert mask_siou(pieces, moved > 0.5)[0] > 0.96
    alone = pieces.copy()
    alone[:50] = 0
    assert mask_siou(pieces, alone)[0] < 0.85


def test_that_grey_levels_are_read_like_booleans() -> None:
    mask = rasterise(silhouettes.load("hexagon").points)
    assert mask_siou(mask * np.uint8(255), mask)[0] == 1.0


@pytest.mark.parametrize(
    ("bad", "sentence"),
    [
        (np.zeros((8, 8)), "empty"),
        (np.full((8, 8), np.nan), "holds nan"),
        (np.ones((4, 4, 3)), "2-D"),
        (np.ones(5), "2-D"),
        ([["a"]], "2-D"),
        ([[1, 2], [3]], "different lengths"),
        (None, "2-D"),
    ],
)
def test_that_masks_without_a_shape_are_refused(bad: object, sentence: str) -> None:
    good = rasterise(silhouettes.load("hexagon").points)
    with pytest.raises(KirigamiError, match=sentence):
        mask_siou(bad, good)  # type: ignore[arg-type]


def test_that_a_single_pixel_is_a_small_square() -> None:
    dot = np.zeros((30, 30))
    dot[4, 7] = 1
    # Enlarged 128 times its corners come out a little round.
    assert mask_siou(dot, np.ones((128, 128)))[0] > 0.9
