"""What the tests of this folder share: agreement of shapes, pictures of shapes, SVG and DXF files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing
from ezdxf.layouts import Modelspace
from PIL import Image

from kirigami_studio.outlines.outline import Outline

SUPERSAMPLING = 4


def _iou(first: Outline, second: Outline) -> float:
    return first.polygon.intersection(second.polygon).area / first.polygon.union(second.polygon).area


@pytest.fixture(scope="session")
def iou() -> Callable[[Outline, Outline], float]:
    """Intersection over union of two outlines in their normal frames."""
    return _iou


def _inside(corners: np.ndarray, size: int) -> np.ndarray:
    """Whether pixel centres lie in a polygon (winding number by crossings to the left of each centre)."""
    toggles = np.zeros((size, size + 1), dtype=int)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        rows = np.arange(np.ceil(min(y0, y1) - 0.5), np.ceil(max(y0, y1) - 0.5), dtype=int)
        if len(rows):
            x = x0 + (rows + 0.5 - y0) * (x1 - x0) / (y1 - y0)
            toggles[rows, np.ceil(x - 0.5).astype(int)] += 1 if y1 > y0 else -1
    return np.cumsum(toggles, axis=1)[:, :size] != 0


@pytest.fixture(scope="session")
def coverage() -> Callable[..., np.ndarray]:
    """Share of each pixel that an outline covers, (size, size) in 0..1, longest side 0.9 of the picture."""

    def rendered(outline: Outline, size: int, share: float = 0.9) -> np.ndarray:
        fine = size * SUPERSAMPLING
        low, high = outline.points.min(axis=0), outline.points.max(axis=0)
        scale = share * fine / np.max(high - low)
        corners = (outline.points - (low + high) / 2) * (scale, -scale) + fine / 2
        inside = _inside(corners, fine).astype(float)
        return inside.reshape(size, SUPERSAMPLING, size, SUPERSAMPLING).mean(axis=(1, 3))

    return rendered


@pytest.fixture
def picture(tmp_path: Path) -> Callable[..., Path]:
    """Save grey levels 0..1 as a picture in a Pillow mode."""

    def saved(grey: np.ndarray, name: str = "shape.png", mode: str = "L") -> Path:
        path = tmp_path / name
        image = Image.fromarray(np.round(np.clip(grey, 0, 1) * 255).astype(np.uint8))
        image.convert(mode).save(path)
        return path

    return saved


@pytest.fixture
def svg(tmp_path: Path) -> Callable[..., Path]:
    """Write an SVG file around a body."""

    def written(body: str, attributes: str = 'viewBox="0 0 200 200"') -> Path:
        path = tmp_path / "drawing.svg"
        xlink = 'xmlns:xlink="http://www.w3.org/1999/xlink"'
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {xlink} {attributes}>{body}</svg>', encoding="utf-8")
        return path

    return written


@pytest.fixture
def dxf(tmp_path: Path) -> Callable[..., Path]:
    """Write a DXF file whose model space is filled by a function."""

    def written(draw: Callable[[Modelspace, Drawing], object], units: int = 4, **save: str) -> Path:
        drawing = ezdxf.new("R2010", units=units)
        draw(drawing.modelspace(), drawing)
        path = tmp_path / "drawing.dxf"
        drawing.saveas(path, **save)
        return path

    return written
