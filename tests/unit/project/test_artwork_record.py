"""Artwork inside project files: stored once, read back the same, left out with a note where it is damaged."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kirigami_studio.export.artwork import Artwork, Laid, PictureFit, SheetState
from kirigami_studio.export.artwork_picture import picture_of
from kirigami_studio.foundation.errors import ExportError, ProjectError
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.history import History
from kirigami_studio.project.store import load, load_all, pack, save


def artwork(kind: str = "PNG") -> Artwork:
    stream = io.BytesIO()
    pixels = np.random.default_rng(4).integers(0, 255, (60, 80, 3), dtype=np.uint8)
    Image.fromarray(pixels).save(stream, format=kind)
    picture = picture_of("sun rise.png", stream.getvalue())
    return Artwork(Laid(picture, SheetState.FLAT, PictureFit.FIT, 1.25, -0.5, (0.1, -0.2)))


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_that_artwork_comes_back_as_it_was_and_is_stored_once(kind: str, tmp_path: Path) -> None:
    document = Document(artwork=artwork(kind))
    save(document, tmp_path / "own.kiri")
    assert load(tmp_path / "own.kiri") == document
    assert document.artwork is not None
    content = document.artwork.first.picture.content
    assert (tmp_path / "own.kiri").read_bytes().count(content[:200]) == 1
    assert len(pack(document)) < len(pack(Document())) + len(content) + 2000


def test_that_a_second_picture_and_its_stripes_come_back(tmp_path: Path) -> None:
    both = replace(artwork(), second=artwork("JPEG").first.picture, stripes=90)
    save(Document(artwork=both), tmp_path / "own.kiri")
    assert load(tmp_path / "own.kiri").artwork == both


def test_that_projects_without_artwork_are_as_they_were() -> None:
    with zipfile.ZipFile(io.BytesIO(pack(Document()))) as archive:
        assert not [name for name in archive.namelist() if name.startswith("artwork")]


def changed(path: Path, change: Callable[[dict[str, bytes]], object]) -> Path:
    """The project with changed members."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    change(members)
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def with_entry(name: str, value: object) -> Callable[[dict[str, bytes]], object]:
    def change(members: dict[str, bytes]) -> None:
        members["artwork.json"] = json.dumps(json.loads(members["artwork.json"]) | {name: value}).encode()

    return change


@pytest.mark.parametrize(
    "change",
    [
        lambda members: members.pop("artwork.png"),
        lambda members: members.update({"artwork.png": b"no picture"}),
        lambda members: members.update({"artwork.json": b"{"}),
        with_entry("state", "folded"),
        with_entry("scale", 0.0),
        with_entry("shift", [1.0]),
        with_entry("picture", "../secret.png"),
    ],
    ids=["missing", "damaged", "no json", "state", "scale", "shift", "name"],
)
def test_that_damaged_artwork_is_left_out_with_a_note(
    change: Callable[[dict[str, bytes]], object], tmp_path: Path
) -> None:
    document = Document(artwork=artwork())
    save(document, tmp_path / "own.kiri")
    opened = load_all(changed(tmp_path / "own.kiri", change))
    assert opened.document == replace(document, artwork=None)
    (note,) = opened.notes
    assert "artwork" in note and "left out" in note


def test_that_sharing_is_undone_step_by_step() -> None:
    second = artwork("JPEG").first.picture
    history = History(Document(artwork=artwork()))
    history.apply(edits.share_artwork(history.document, second, 160))
    for stripes in (150, 140):
        history.apply(edits.share_artwork(history.document, second, stripes))
    history.apply(edits.place_artwork(history.document, scale=2.0))
    history.apply(edits.share_artwork(history.document, None, 140))
    assert history.steps == (
        "Lay sun rise.png between",
        "Change the stripes",
        "Place the artwork",
        "Remove the second picture",
    )
    history.undo()
    assert history.document.artwork is not None and history.document.artwork.second == second
    with pytest.raises(ProjectError):
        edits.share_artwork(Document(), second, 160)


def test_that_placing_is_one_undo_step_for_one_drag() -> None:
    history = History(Document())
    history.apply(edits.set_artwork(history.document, artwork()))
    for scale in (1.3, 1.4):
        history.apply(edits.place_artwork(history.document, scale=scale))
    history.apply(edits.place_artwork(history.document, turn=1.0))
    assert history.steps == ("Lay sun rise.png on it", "Place the artwork", "Place the artwork")
    history.undo()
    assert history.document.artwork is not None and history.document.artwork.first.scale == 1.4
    history.undo()
    history.apply(edits.set_artwork(history.document, None))
    assert history.document == Document()
    with pytest.raises(ProjectError) as caught:
        edits.place_artwork(history.document, scale=2.0)
    assert caught.value.code == "artwork.none"
    with pytest.raises(ExportError):
        edits.place_artwork(Document(artwork=artwork()), scale=-1.0)
