"""The document that tells the limits of every reader tells those that hold."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.cli import inputs
from kirigami_studio.export import artwork_picture, dxf_reading, svg_reading
from kirigami_studio.foundation import files
from kirigami_studio.generator import weights
from kirigami_studio.gui.stage import artwork_painting
from kirigami_studio.lab.baselines import stored
from kirigami_studio.lab.benchmark import run_store
from kirigami_studio.lab.training import block_archive, dataset, learner
from kirigami_studio.lattice import sheet_files
from kirigami_studio.mechanics import network_files
from kirigami_studio.outlines import parts, read_dxf, read_image, read_pdf, source_file, svg_safety, svg_style
from kirigami_studio.project import document, picture_record, recovery, store

MIB = 2**20


def rows() -> list[str]:
    """The table's rows, made of the constants."""
    seconds = f"{source_file.MOST_SECONDS:g} s"
    return [
        f"| SVG target | 20 MB | {svg_safety.MOST_ELEMENTS:_} elements after every `use`, {svg_safety.MOST_NUMBERS:_} "
        f"numbers of {svg_safety.MOST_DIGITS} digits, {svg_style.MOST_STYLE:_} letters of style sheets, "
        f"{parts.MOST_PARTS} parts | {seconds} |",
        f"| DXF target | {read_dxf.MOST_MEGABYTES} MB, binary {read_dxf.MOST_BINARY_MEGABYTES} MB | "
        f"{read_dxf.MOST_ENTITIES:_} entities, blocks {read_dxf.DEEPEST_BLOCK} deep, "
        f"{parts.MOST_PARTS} parts | {seconds} |",
        f"| PDF or AI target | 20 MB, {read_pdf.MOST_UNPACKED} MB unpacked | {read_pdf.MOST_OBJECTS:_} objects, forms "
        f"{read_pdf.DEEPEST_FORM} deep, {read_pdf.MOST_POINTS:_} points, {parts.MOST_PARTS} parts | {seconds} |",
        f"| picture as target | {read_image.MOST_MEGABYTES} MB | {read_image.MOST_PIXELS // 10**6} million pixels, "
        f"{read_image.MOST_PIXELS_IN_COLOUR // 10**6} million for parts by colour | |",
        f"| mask | {inputs.MOST_MASK_MEGABYTES} MB | {inputs.MOST_MASK_PIXELS // 10**6} million pixels | |",
        f"| artwork | {artwork_picture.MOST_MEGABYTES} MB | {read_image.MOST_PIXELS // 10**6} million pixels; "
        f"SVG as above | SVG {artwork_painting.MOST_SECONDS:g} s |",
        f"| cut DXF to check | {dxf_reading.LARGEST_FILE // 10**6} MB | {read_dxf.MOST_ENTITIES:_} entities | "
        f"{dxf_reading.LEAST_SECONDS:g} s and {dxf_reading.SECONDS_PER_MEGABYTE:g} s for each MB |",
        f"| written SVG read back | {svg_reading.LARGEST_FILE // 10**6} MB | no `use` | |",
        f"| project `.kiri` | {store.LARGEST_FILE // MIB} MiB | {store.LARGEST_CONTENT // MIB} MiB unpacked, "
        f"{store.MOST_MEMBERS} members, {document.MOST_GUIDES} guides a direction | |",
        f"| picture in a project | {picture_record.LARGEST_PICTURE // MIB} MiB | | |",
        f"| autosaved work | {recovery.LARGEST_FILE // MIB} MiB | note of {recovery.LONGEST_NOTE // 1024} KiB | |",
        f"| sheet `.json`, `.npy` | {sheet_files.LARGEST_FILE // MIB} MiB | 64 x 64 voids | |",
        f"| archive `.npz` of sheets or masks | {inputs.LARGEST_ARCHIVE // MIB} MiB | | |",
        f"| network `.npz` | {network_files.LARGEST_FILE // MIB} MiB, unpacked too | "
        f"{network_files.MOST_PANELS:_} panels | |",
        f"| settings, materials `.toml` | {files.LARGEST_SETTINGS // 1000} kB | {files.MOST_DOTS} dots a line, "
        f"whole numbers of 64 bits | |",
        f"| weights; their list | {weights.LARGEST_WEIGHTS // MIB} MiB; {weights.LARGEST_MANIFEST // MIB} MiB | "
        f"SHA-256 as listed, finite numbers | |",
        f"| baseline weights | {stored.LARGEST_FILE // MIB} MiB | | |",
        f"| checkpoint | {learner.LARGEST_CHECKPOINT // MIB} MiB | plain tensors | |",
        f"| training data, fits | {dataset.LARGEST_FILE // MIB} MiB; {block_archive.LARGEST_FILE // MIB} MiB | "
        f"SHA-256 as told | |",
        f"| records of a suite | {run_store.LARGEST_FILE // MIB} MiB | | |",
    ]


@pytest.mark.torch
def test_that_the_document_tells_the_limits_that_hold(repository: Path) -> None:
    text = (repository / "docs" / "limits.md").read_text(encoding="utf-8")
    told = [line for line in text.splitlines() if line.startswith("| ") and not line.startswith(("| File", "|---"))]
    assert told == [row.replace("_", " ") for row in rows()]
