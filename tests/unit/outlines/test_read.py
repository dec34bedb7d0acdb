"""One door for all sources, and whatever people push through it."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image
from reportlab.pdfgen.canvas import Canvas

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.read import READERS, read_json, read_target, target_files
from tests.refusals import refused

SQUARE = [[0, 0], [2, 0], [2, 2], [0, 2]]


def samples(folder) -> dict[str, bytes]:
    """A good file of every kind."""
    import ezdxf

    image = Image.new("RGB", (80, 80), "white")
    image.paste((10, 20, 30), (20, 10, 60, 70))
    contents = {}
    for suffix in READERS:
        path = folder / f"good{suffix}"
        if suffix == ".svg":
            path.write_text('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0C9 0 9 9 20 9V30H0z"/></svg>')
        elif suffix == ".dxf":
            drawing = ezdxf.new("R2000")
            drawing.modelspace().add_lwpolyline(SQUARE, close=True)
            drawing.saveas(path)
        elif suffix in (".pdf", ".ai"):
            page = Canvas(str(path), pagesize=(300, 200), pageCompression=0)
            page.rect(40, 30, 200, 120, fill=1)
            page.save()
        elif suffix == ".json":
            path.write_text(json.dumps(SQUARE))
        else:
            image.save(path)
        contents[suffix] = path.read_bytes()
    return contents


@pytest.mark.parametrize("suffix", [*READERS, ".PNG", ".Svg", ".JPEG", ".DXF"])
def test_that_the_extension_chooses_the_reader_in_any_case(suffix, tmp_path) -> None:
    path = tmp_path / f"My Shape{suffix}"
    path.write_bytes(samples(tmp_path)[suffix.lower()])
    outline = read_target(path)
    assert outline.name == "My Shape"
    assert read_target(str(path)) == outline


@pytest.mark.parametrize("suffix", READERS)
def test_that_a_damaged_file_is_an_outline_or_a_sentence(suffix, tmp_path) -> None:
    good = samples(tmp_path)[suffix]
    generator = np.random.default_rng(len(suffix))
    path = tmp_path / f"damaged{suffix}"
    refused = 0
    damaged = [good[:1], good[: len(good) // 3], good[: len(good) * 9 // 10], good[1:], b"\0" * 100, b"\xff\xfe<svg/>"]
    damaged += [generator.bytes(size) for size in (3, 100, 5000)]
    for _ in range(12):
        flipped = np.frombuffer(good, dtype=np.uint8).copy()
        flipped[generator.integers(0, len(good), max(1, len(good) // 200))] = generator.integers(0, 256)
        damaged.append(flipped.tobytes())
    for content in damaged:
        path.write_bytes(content)
        try:
            assert abs(read_target(path).polygon.area - 1) < 1e-9
        except TargetError as error:
            refused += 1
            assert "damaged" + suffix in str(error)
            assert len(str(error)) < 500
    assert refused >= 5


@pytest.mark.parametrize("suffix", READERS)
def test_that_a_missing_file_an_empty_file_and_a_folder_are_named(suffix, tmp_path) -> None:
    with pytest.raises(TargetError, match=rf"There is no file .*gone\{suffix}"):
        read_target(tmp_path / f"gone{suffix}")
    (tmp_path / f"empty{suffix}").touch()
    with pytest.raises(TargetError, match=rf"empty\{suffix} is empty"):
        read_target(tmp_path / f"empty{suffix}")
    (tmp_path / f"folder{suffix}").mkdir()
    with refused(TargetError, "target.folder"):
        read_target(tmp_path / f"folder{suffix}")


def test_that_a_library_name_is_a_target() -> None:
    assert read_target("heart") == silhouettes.load("heart")
    assert read_target("Letter L") == silhouettes.load("letter-l")


@pytest.mark.parametrize(
    ("source", "word"),
    [
        ("haert", "nearest names are: heart"),
        ("hexagn", "hexagon"),
        ("", "name of a library silhouette"),
        ("   ", "name of a library silhouette"),
        (None, "got None"),
        (3, "got 3"),
        ("a\0b.png", "cannot be"),
        ("x" * 5000 + ".png", "xxx"),
    ],
)
def test_that_a_wrong_source_is_answered(source, word) -> None:
    with pytest.raises(TargetError) as caught:
        read_target(source)
    assert word in str(caught.value)


def test_that_an_unknown_kind_of_file_is_refused(tmp_path) -> None:
    path = tmp_path / "letter.docx"
    path.write_bytes(b"PK")
    with pytest.raises(TargetError, match=r"letter\.docx is of an unknown kind.*\.svg"):
        read_target(path)


def test_that_a_folder_is_read_in_the_order_of_names(tmp_path) -> None:
    for name in ("b", "A", "c"):
        (tmp_path / f"{name}.json").write_text(json.dumps(SQUARE))
    (tmp_path / "notes.txt").write_text("no target")
    assert [read_target(file).name for file in target_files(tmp_path)] == ["A", "b", "c"]


def test_that_a_folder_without_targets_or_with_a_bad_one_is_refused(tmp_path) -> None:
    with refused(TargetError, "target.none_in_folder") as caught:
        target_files(tmp_path)
    assert caught.value.code == "target.none_in_folder"
    with refused(TargetError, "target.folder_not_readable"):
        target_files(tmp_path / "gone")
    (tmp_path / "bad.json").write_text("[[0, 0]]")
    (file,) = target_files(tmp_path)
    with refused(TargetError, "source.not_usable", name="bad.json"):
        read_target(file)


@pytest.mark.parametrize("stored", [SQUARE, {"outline": SQUARE}, {"points": SQUARE}, {"outline": {"points": SQUARE}}])
def test_that_every_form_of_json_is_read(stored, tmp_path, iou) -> None:
    path = tmp_path / "square.json"
    path.write_text("\ufeff" + json.dumps(stored), encoding="utf-8")
    assert iou(read_json(path), silhouettes.load("square")) > 0.999999


def test_that_json_may_name_itself_and_its_unit(tmp_path) -> None:
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"name": "tile", "unit": "mm", "points": SQUARE}))
    outline = read_json(path)
    assert (outline.name, outline.unit, outline.size) == ("tile", "mm", (2.0, 2.0))


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("[[0,0],[1,NaN],[1,1]]", "NaN"),
        ("[[0,0],[1,Infinity],[1,1]]", "Infinity"),
        ("[[0,0],[1,1e999],[1,1]]", "Vertex 2"),
        ("[[0,0],[1,0]]", "at least 3"),
        ('[[0,0],["1","0"],[1,1]]', "Vertex 2"),
        ("[[0,0],[true,false],[1,1]]", "Vertex 2"),
        ("[[0,0],[1,0,0],[1,1]]", "Vertex 2"),
        ("[[[0,0],[1,0],[1,1]]]", "Vertex 1"),
        ("[0,1,2,3]", "Vertex 1"),
        ("[[0,0],null,[1,1]]", "Vertex 2"),
        ('{"ratio": [[1]]}', '"outline"'),
        ('{"outline": 5}', "got 5"),
        ('"heart"', "list"),
        ("null", "list"),
        ("[]", "at least 3"),
        ("[[0,0],[1,0]", "damaged"),
        ("[" * 100_000, "damaged"),
        (f"[[0,0],[1{'0' * 400},0],[1,1]]", "damaged"),
        ("[[0,0],[1,1],[2,2]]", "no area"),
        ("[[0,0],[2,2],[2,0],[0,2]]", "near (1, 1)"),
    ],
)
def test_that_wrong_json_is_refused(text, word, tmp_path) -> None:
    path = tmp_path / "wrong.json"
    path.write_text(text)
    with pytest.raises(TargetError, match=r"wrong\.json") as caught:
        read_json(path)
    assert word in str(caught.value)


def test_that_the_library_is_read_without_the_heavy_readers() -> None:
    code = (
        "import sys; from kirigami_studio.outlines.read import read_target; read_target('heart');"
        "print(sorted({'ezdxf', 'skimage', 'svgelements', 'torch', 'PySide6'} & set(sys.modules)))"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"
