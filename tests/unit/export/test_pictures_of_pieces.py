"""Pictures of pieces: bitmap, animation and drawing show both layers and the heads of pins."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image, ImageSequence

from kirigami_studio.assembly.posed_pieces import PieceLook, PosedPieces
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export.animation import write_animation
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PANEL, PictureFrame, preview, shown_points
from kirigami_studio.export.share_page import corners_at, read_page, write_page
from kirigami_studio.export.svg import NAMESPACE, write_layout_svg
from tests.pinned_assemblies import small_assembly

LOOK = PieceLook(face=(228, 197, 150), head=(60, 60, 220), thickness_mm=3.0)


@pytest.fixture(scope="module")
def job() -> ExportJob:
    assembly = small_assembly()
    pieces = PosedPieces(assembly, PosedDesign(assembly.deployment, Similarity(0.25), 0.0), LOOK, head_mm=5.0)
    return ExportJob(assembly.deployment, transform=Similarity(0.25), pieces=pieces)


def near(pixels: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    return np.abs(pixels.astype(int) - colour).max(axis=-1) < 12


@pytest.mark.parametrize("degrees", [180.0, 100.0])
def test_that_a_bitmap_shows_the_upper_layer_the_lower_one_and_heads(job: ExportJob, degrees: float) -> None:
    turned = replace(job, picture_phi=math.radians(degrees))
    image = preview(turned, 300)
    pixels = np.asarray(image)
    upper, lower = near(pixels, LOOK.layer(1, 2)).mean(), near(pixels, LOOK.layer(0, 2)).mean()
    assert min(upper, lower) > 0.05 and not near(pixels, PANEL).any()
    assert job.pieces is not None
    frame = PictureFrame.around(shown_points(job.pieces, (turned.shown_phi,), None), 300)
    for x, y in frame.pixel(job.pieces.heads(turned.shown_phi), 1):
        red, _, blue = pixels[round(y), round(x)].tolist()
        assert blue > red + 60


def test_that_every_frame_of_an_animation_shows_pieces(job: ExportJob, tmp_path: Path) -> None:
    path = tmp_path / "pieces.gif"
    write_animation(job, path, frames=4, longest=120)
    with Image.open(path) as read:
        frames = [np.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(read)]
    assert len(frames) == 4
    for pixels in frames:
        assert near(pixels, LOOK.face).mean() > 0.03 and not near(pixels, PANEL).any()
    assert (frames[0] != frames[1]).any()


def test_that_a_drawing_has_a_group_of_filled_shapes_for_each_layer(job: ExportJob, tmp_path: Path) -> None:
    path = tmp_path / "layout.svg"
    write_layout_svg(replace(job, target=np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])), path)
    root = ElementTree.parse(path).getroot()
    groups = {group.get("id"): list(group) for group in root.findall(f"{{{NAMESPACE}}}g")}
    assert job.pieces is not None
    sizes = [len(layer) for layer in job.pieces.layers]
    assert [len(groups[name]) for name in ("LAYER_1", "LAYER_2")] == sizes
    assert len(groups["HEADS"]) == len(job.pieces.assembly.hinges) and "PANELS" not in groups
    assert list(groups).index("LAYER_1") < list(groups).index("LAYER_2") < list(groups).index("TARGET")
    assert all(shape.get("stroke") == "none" for shapes in groups.values() for shape in shapes)


@pytest.mark.parametrize("degrees", [180.0, 70.0, 0.0])
def test_that_a_page_to_share_moves_pieces_as_they_move(job: ExportJob, degrees: float, tmp_path: Path) -> None:
    write_page(job, tmp_path / "pieces.html")
    data, phi, pieces = read_page(tmp_path / "pieces.html"), math.radians(degrees), job.pieces
    assert pieces is not None and len(data["parts"]) == len(pieces.assembly.pieces)
    middle = pieces.design.nodes(pieces.design.phi_target).mean(axis=0)
    for part, outline, piece in zip(data["parts"], pieces.small.outlines(phi), pieces.assembly.pieces, strict=True):
        odd, carried, own = part
        corners = np.array(own).reshape(-1, 2) @ (1.0, 1j)
        found = corners_at((odd, complex(*carried), corners), data["phi"], data["turn"], phi)
        np.testing.assert_allclose(found, (outline - middle) * pieces.mm_per_world, atol=4e-3)
        assert odd == piece.layer - 1  # the upper layer is drawn over the lower one
