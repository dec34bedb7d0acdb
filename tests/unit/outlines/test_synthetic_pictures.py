"""Pictures whose silhouette is known are read right, or say that another one may be meant: never silently wrong."""

from __future__ import annotations

import collections
from dataclasses import replace

import pytest

from kirigami_studio.outlines.read_image import read_image
from tests.synthetic_pictures import COLOURS, PLACES, judged, known, painted, pictures, shape_mask

#: Of all pictures so many are read here; `make readers` reads all.
EVERY = 41


def test_that_no_known_picture_is_silently_another_shape(tmp_path) -> None:
    results: collections.Counter[str] = collections.Counter()
    silent = []
    for one in pictures(EVERY):
        result, share = judged(one, tmp_path)
        results[result] += 1
        silent += [(one.name, share)] if result == "silent" else []
    assert not silent
    assert results["same"] + results["same, asked"] >= 0.85 * results.total()
    assert results["same"] >= 0.6 * results.total()


@pytest.mark.parametrize("place", ["cut at a corner", "cut at another corner"])
@pytest.mark.parametrize("shape", ["rounded square", "disk"])
def test_that_a_light_shape_cut_at_a_corner_is_not_its_complement(shape, place, tmp_path) -> None:
    assert judged(known(shape, place, "white on dark green", "plain"), tmp_path) == (
        "same",
        pytest.approx(1.0, abs=0.01),
    )


def test_that_a_light_shape_with_a_darker_shadow_says_how_to_choose(tmp_path) -> None:
    mask = shape_mask("disk", PLACES["inside"])
    path = tmp_path / "pale.png"
    painted(mask, COLOURS["pale on white"], "shadow", None).save(path)
    assert any("--object" in note for note in read_image(path).notes)
    painted(mask, COLOURS["black on white"], "plain", None).save(path)
    assert not any("--object" in note for note in read_image(path).notes)


def test_that_the_judge_tells_another_shape(tmp_path) -> None:
    one = known("star", "inside", "black on white", "plain")
    other = replace(one, mask=~one.mask)
    assert judged(other, tmp_path)[0] == "silent"
