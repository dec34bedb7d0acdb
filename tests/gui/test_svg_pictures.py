"""SVG pictures for printing, drawn by Qt."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.export.artwork_picture import read_picture
from kirigami_studio.export.artwork_raster import image_of
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.gui.stage.artwork_painting import svg_to_png


def test_that_an_svg_is_drawn_with_its_text_and_its_transparency(tmp_path: Path, qapp: object) -> None:
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 100"><rect width="100" height="100" fill="red"/>'
        '<text x="110" y="80" font-size="60">A</text></svg>'
    )
    picture = read_picture(drawing, svg_to_png)
    assert picture.size == (3000, 1500)
    assert image_of(picture.content).getpixel((700, 700)) == (255, 0, 0, 255)
    assert image_of(picture.content).getpixel((2900, 100))[3] == 0
    assert np.asarray(image_of(picture.content))[:, 1600:, 3].any()


@pytest.mark.parametrize(
    "content",
    [
        b"<svg",
        b'<svg xmlns="http://www.w3.org/2000/svg" width="0" height="0"/>',
        b"<!DOCTYPE x [<!ENTITY a 'b'>]><svg/>",
        b"\x1f\x8b compressed",
    ],
    ids=["damaged", "nothing", "entities", "compressed"],
)
def test_that_an_svg_that_cannot_be_drawn_gets_one_sentence(content: bytes, tmp_path: Path, qapp: object) -> None:
    (tmp_path / "drawing.svg").write_bytes(content)
    with pytest.raises(TargetError) as caught:
        read_picture(tmp_path / "drawing.svg", svg_to_png)
    assert caught.value.code == "source.not_usable"
    assert "drawing.svg" in str(caught.value)
