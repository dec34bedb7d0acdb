"""Pictures of every kind show a target with its holes."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from shapely.geometry import Polygon

from kirigami_studio.api.pictures import states_picture, target_picture
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PAPER, TARGET_FILL, PictureFrame, draw_polygons
from kirigami_studio.export.share_page import write_page
from kirigami_studio.export.svg import write_layout_svg
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load

RING = load("ring")


@pytest.fixture(scope="module")
def job() -> ExportJob:
    return ExportJob(deploy(RatioField(np.ones((2, 2)))), target=RING.rings, transform=Similarity(0.3))


def test_that_a_bitmap_leaves_the_hole_white() -> None:
    frame = PictureFrame.around([RING.points], 101)
    image = draw_polygons([], frame, RING.rings)
    middle = image.width // 2
    assert image.getpixel((middle, image.height // 2)) == PAPER
    assert image.getpixel((middle, image.height // 2 + image.height // 4 + 8)) == TARGET_FILL


def test_that_the_drawn_layout_has_the_target_as_one_area_with_a_hole_and_two_lines(job, tmp_path: Path) -> None:
    write_layout_svg(job, tmp_path / "layout.svg", 100.0)
    root = ElementTree.parse(tmp_path / "layout.svg").getroot()
    groups = {group.get("id"): list(group) for group in root.iter("{http://www.w3.org/2000/svg}g")}
    (area,) = groups["TARGET_AREA"]
    assert area.get("d", "").count("M") == 2
    assert len(groups["TARGET"]) == 2


def test_that_a_page_to_share_draws_both_rings_and_judges_with_the_hole(job, tmp_path: Path) -> None:
    write_page(job, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    line = re.search(r'<path id="target" d="([^"]*)"', page)
    assert line is not None and line[1].count("M") == 2
    whole = job.posed.outline(job.posed.nodes(0.0), 0.0)
    sheet, target = Polygon(whole), RING.polygon
    match = sheet.intersection(target).area / sheet.union(target).area
    assert f"{100.0 * match:.1f}" in page


def test_that_notebooks_show_holes(job) -> None:
    assert re.search(r'd="M[^"]*Z M[^"]*Z"[^>]*fill-rule="evenodd"', target_picture(RING.rings, "ring"))
    assert states_picture(job.posed, RING.rings, "ring").count("evenodd") == 2
    assert "evenodd" not in re.sub(r"<path[^>]*/>", "", target_picture(RING.points, "disc"))
