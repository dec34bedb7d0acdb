"""What the command line accepts as input."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from kirigami_studio.cli.inputs import (
    Named,
    are_many_targets,
    is_batch,
    read_mask,
    read_sheets,
    read_targets,
)
from kirigami_studio.cli.option_types import parse_angle, parse_grid
from kirigami_studio.foundation.errors import GridError, KirigamiError, RatioError, TargetError, UsageError
from tests.refusals import refused


def every(inputs: Iterable[Named[Any]]) -> list[Any]:
    """Read all inputs, as a command does."""
    return [named.read() for named in inputs]


@pytest.mark.parametrize(
    ("text", "value"),
    [("0", 0.0), ("0.5", 0.5), ("30deg", math.pi / 6), ("pi", math.pi), ("pi/3", math.pi / 3),
     ("2pi/3", 2 * math.pi / 3), ("0.25*pi", math.pi / 4), (".5", 0.5), ("1e-3", 1e-3)],
)  # fmt: skip
def test_that_angles_are_read_in_radians_and_degrees(text: str, value: float) -> None:
    assert parse_angle(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["90", "180", "7"])
def test_that_degrees_without_a_unit_are_told_how_to_be_written(text: str) -> None:
    with pytest.raises(UsageError) as refused:
        parse_angle(text)
    assert refused.value.code == "option.angle_in_degrees" and f"{text}deg" in str(refused.value)


@pytest.mark.parametrize("text", ["", "nan", "inf", "thirty", "pi/0", "1/2", "-1", "30 degrees"])
def test_that_other_angles_are_refused(text: str) -> None:
    with pytest.raises(UsageError):
        parse_angle(text)


def test_that_a_grid_is_rows_by_columns() -> None:
    assert parse_grid("8x12") == (8, 12)
    for text in ("", "8", "8x", "8*12", "x", "8x12x3", "1.5x2"):
        with pytest.raises(GridError):
            parse_grid(text)


def test_that_fields_come_from_json_npy_archives_and_folders(tmp_path: Path) -> None:
    ratio = np.random.default_rng(0).uniform(0.5, 2, (3, 4))
    (tmp_path / "a.json").write_text(json.dumps({"ratio": ratio.tolist()}))
    np.save(tmp_path / "b.npy", ratio)
    np.savez(tmp_path / "c.npz", ratios=np.stack([ratio, 2 * ratio]))
    values = [named.read().field.ratio for named in read_sheets([str(tmp_path)])]
    assert len(values) == 4
    assert all(np.array_equal(value, ratio) for value in values[:3])
    assert np.array_equal(values[3], 2 * ratio)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.json", b""),
        ("list.json", b"[1, 2]"),
        ("flat.json", b'{"ratio": [1, 2, 3, 4]}'),
        ("ragged.json", b'{"ratio": [[1, 2], [3]]}'),
        ("text.json", b'{"ratio": [["a", "b"], ["c", "d"]]}'),
        ("nan.json", b'{"ratio": [[1, NaN], [1, 1]]}'),
        ("zero.json", b'{"ratio": [[1, 0], [1, 1]]}'),
        ("negative.json", b'{"ratio": [[1, -2], [1, 1]]}'),
        ("tiny.json", b'{"ratio": [[1]]}'),
        ("binary.json", b"\xff\xfe\x00\x01"),
        ("deep.json", b"[" * 100_000),
        ("broken.npy", b"\x93NUMPY\x01\x00"),
        ("empty.npy", b""),
        ("other.txt", b"1 1"),
    ],
)
def test_that_bad_ratio_files_are_refused_with_their_name(tmp_path: Path, name: str, content: bytes) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(KirigamiError, match=path.stem):
        every(read_sheets([str(path)]))


def test_that_pickled_arrays_are_not_loaded(tmp_path: Path) -> None:
    np.save(tmp_path / "object.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(RatioError):
        every(read_sheets([str(tmp_path / "object.npy")]))


def test_that_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(RatioError, match=r"nowhere\.json"):
        every(read_sheets([str(tmp_path / "nowhere.json")]))


def test_that_masks_in_an_archive_become_targets(tmp_path: Path) -> None:
    masks = np.zeros((2, 64, 64), dtype=bool)
    masks[0, 10:50, 20:40] = True
    masks[1, 5:60, 5:60] = True
    np.savez(tmp_path / "masks.npz", masks=masks)
    targets = [named.read() for named in read_targets([str(tmp_path / "masks.npz")])]
    spans = [np.ptp(target.points, axis=0) for target in targets]
    assert spans[0][1] / spans[0][0] == pytest.approx(2.0, rel=0.05)
    assert spans[1][1] / spans[1][0] == pytest.approx(1.0, rel=0.02)


def test_that_an_archive_without_masks_says_what_it_holds(tmp_path: Path) -> None:
    np.savez(tmp_path / "other.npz", pictures=np.zeros((1, 4, 4)))
    with refused(UsageError, "archive.array_missing", found="pictures"):
        every(read_targets([str(tmp_path / "other.npz")]))


def test_that_a_blank_mask_in_an_archive_is_located(tmp_path: Path) -> None:
    np.savez(tmp_path / "blank.npz", masks=np.zeros((1, 32, 32), dtype=bool))
    with refused(TargetError, "input.not_valid", name="blank.npz[0]"):
        every(read_targets([str(tmp_path / "blank.npz")]))


def test_that_a_damaged_archive_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.npz").write_bytes(b"PK\x03\x04 and then nothing")
    with pytest.raises(KirigamiError, match=r"bad\.npz"):
        every(read_targets([str(tmp_path / "bad.npz")]))


def test_that_mask_images_are_bright_inside(tmp_path: Path) -> None:
    picture = np.zeros((8, 8), dtype=np.uint8)
    picture[2:5, 3:7] = 255
    Image.fromarray(picture).save(tmp_path / "mask.png")
    assert read_mask(tmp_path / "mask.png").sum() == 12
    (tmp_path / "mask.txt").write_text("no image")
    with pytest.raises(TargetError):
        read_mask(tmp_path / "mask.txt")


def test_that_several_inputs_count_as_a_batch(tmp_path: Path) -> None:
    assert not is_batch(["heart"])
    assert is_batch(["heart", "star"])
    assert is_batch([str(tmp_path)])
    assert is_batch(["fields.npz"])


def test_that_a_threshold_decides_what_a_grey_image_shows(tmp_path: Path) -> None:
    grey = np.full((80, 80), 255, dtype=np.uint8)
    grey[10:70, 10:70] = 160
    grey[30:50, 20:60] = 20
    Image.fromarray(grey).save(tmp_path / "grey.png")
    spans = [
        np.ptp(next(iter(read_targets([str(tmp_path / "grey.png")], threshold))).read().points, axis=0)
        for threshold in (0.3, 0.8)
    ]
    assert spans[0][0] / spans[0][1] == pytest.approx(2.0, rel=0.05)
    assert spans[1][0] / spans[1][1] == pytest.approx(1.0, rel=0.05)
    with refused(UsageError, "option.threshold"):
        every(read_targets([str(tmp_path / "grey.png")], 2.0))


def test_that_a_json_file_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(json.dumps({"ratio": [[1, 2], [3, 4]]}), encoding="utf-8-sig")
    (named,) = read_sheets([str(tmp_path / "a.json")])
    assert named.read().field.ratio.tolist() == [[1, 2], [3, 4]]


def test_that_a_soft_mask_is_bounded_halfway_and_not_where_it_begins(tmp_path: Path) -> None:
    ramp = np.clip((np.arange(100) - 20) / 20, 0, 1)  # 0.5 at column 30
    profile = np.minimum(ramp, ramp[::-1])
    soft = np.minimum(profile[:, None], profile[None, :])
    for number, masks in enumerate((soft[None], (255 * soft[None]).astype(np.uint8))):
        np.savez(tmp_path / f"{number}.npz", masks=masks)
        (named,) = read_targets([str(tmp_path / f"{number}.npz")])
        assert named.read().size == pytest.approx((38, 38), abs=1)


def test_that_a_mask_with_a_hole_in_its_numbers_is_refused(tmp_path: Path) -> None:
    masks = np.ones((2, 40, 40))
    masks[1, 3, 4] = np.nan
    np.savez(tmp_path / "a.npz", masks=masks)
    with pytest.raises(TargetError, match=r"a\.npz\[1\].*not finite"):
        every(read_targets([str(tmp_path / "a.npz")]))


def test_that_an_archive_without_entries_is_refused_like_an_empty_folder(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", ratios=np.ones((0, 4, 4)))
    with refused(UsageError, "archive.no_entries"):
        every(read_sheets([str(tmp_path / "a.npz")]))


def test_that_a_library_name_means_the_silhouette_even_beside_a_folder_of_that_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "heart").mkdir()
    monkeypatch.chdir(tmp_path)
    (named,) = read_targets(["heart"])
    assert named.read().name == "heart"
    assert not are_many_targets(["heart"])
    assert are_many_targets(["./heart"])


def test_that_an_empty_name_is_no_folder() -> None:
    assert not are_many_targets([""])
    with pytest.raises(TargetError):
        every(read_targets([""]))


def test_that_an_endless_name_is_refused_in_a_sentence() -> None:
    for read in (read_sheets, read_targets):
        with pytest.raises(KirigamiError):
            every(read(["x" * 5000]))


@pytest.mark.parametrize(("high", "kind"), [(1, np.uint8), (255, np.uint8), (3000, np.uint16)])
def test_that_a_mask_image_may_use_any_range(high: int, kind: type, tmp_path: Path) -> None:
    expected = np.zeros((20, 30), dtype=bool)
    expected[5:15, 8:20] = True
    Image.fromarray(np.where(expected, high, high // 3).astype(kind)).save(tmp_path / "mask.png")
    assert np.array_equal(read_mask(tmp_path / "mask.png"), expected)


def test_that_a_large_mask_may_be_uncompressed(tmp_path: Path) -> None:
    path = tmp_path / "large.pgm"
    with Image.new("L", (5000, 4900)) as picture:
        picture.paste(255, (1000, 1000, 4000, 3000))
        picture.save(path)
    assert path.stat().st_size > 24_000_000
    assert read_mask(path).sum() == 3000 * 2000
