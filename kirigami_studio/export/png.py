"""Deployed layout over its target -> PNG preview."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from PIL import Image
from PIL.PngImagePlugin import PngInfo

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.facts import origin_facts
from kirigami_studio.export.picture import PictureFrame, draw_polygons
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

LONGEST_SIDE = 900


@dataclass(frozen=True, slots=True)
class PngExporter:
    """Preview as PNG."""

    extension: str = ".png"
    name: str = "PNG picture of the deployed layout"

    def write(self, job: ExportJob, path: Path) -> None:
        """Write the layout at the job's angle."""
        write_png(job, path)


def write_png(job: ExportJob, path: str | Path, longest: int = LONGEST_SIDE) -> None:
    """Write the layout at the target angle over the target.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    image = preview(job, longest)
    stream = BytesIO()
    image.save(stream, format="PNG", optimize=True, pnginfo=text_chunks(origin_facts(job.provenance)))

    def verify(written: Path) -> None:
        with Image.open(written) as read:
            read.load()
            if read.size != image.size:
                raise ExportError(f"The PNG did not read back: {read.size} instead of {image.size} pixels.")

    write_atomically(Path(path), stream.getvalue(), verify)


def text_chunks(facts: Mapping[str, str]) -> PngInfo:
    """Facts as a PNG keeps them, each under its name."""
    texts = PngInfo()
    for name, text in facts.items():
        texts.add_itxt(name, text)
    return texts


def preview(job: ExportJob, longest: int = LONGEST_SIDE) -> Image.Image:
    """Draw the layout at the target angle over the target."""
    panels = job.posed.parts(job.phi)
    clouds = panels if job.target is None else [*panels, job.target]
    return draw_polygons(panels, PictureFrame.around(clouds, longest), job.target)
