"""Reads icons of public npm packages and compares each outline with what rsvg-convert paints; ``make readers``.

For every icon: rsvg-convert paints it, the largest connected piece of what is opaque is filled, and the outline that
the program takes without a question is laid over it, by its size and the middle of its box.  A line of JSON each in the
folder; a summary at the end.  Needs npm with its registry, and rsvg-convert (Debian: librsvg2-bin).
"""

from __future__ import annotations

import argparse
import collections
import io
import json
import random
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from PIL import Image
from scipy import ndimage
from skimage.draw import polygon2mask

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.outlines.merging import usual_outline
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_svg import svg_parts

#: Packages, and the folder of their drawings: icons drawn with strokes, and filled ones.
SETS = {
    "strokes": {
        "lucide-static@1.62.0": "package/icons/",
        "feather-icons@4.29.2": "package/dist/icons/",
        "@tabler/icons@3.52.0": "package/icons/outline/",
    },
    "fills": {
        "@fortawesome/fontawesome-free@7.3.1": "package/svgs/",
        "bootstrap-icons@1.13.2": "package/icons/",
        "openmoji@17.0.0": "package/color/svg/",
        "@twemoji/svg@15.0.0": "package/",
    },
}
#: Pixels of the longer side, and the overlap from which on both show the same.
SIDE, SAME = 1200, 0.98
#: What sticks out of the page is read; here the page is larger to all sides by this share.
ROOM = 0.1


def drawings(package: str, folder: str, keep: Path) -> list[tuple[str, bytes]]:
    """Names and contents of a package's drawings, by name."""
    packed = keep / f"{package.strip('@').replace('/', '-')}.tgz"
    if not packed.exists():
        with tempfile.TemporaryDirectory() as place:
            subprocess.run(["npm", "pack", "--silent", package], cwd=place, check=True, stdout=subprocess.DEVNULL)
            (found,) = Path(place).glob("*.tgz")
            shutil.move(found, packed)
    with tarfile.open(packed) as archive:
        members = [one for one in archive if one.name.startswith(folder) and one.name.endswith(".svg")]
        return sorted((one.name, archive.extractfile(one).read()) for one in members)


def on_larger_page(content: bytes) -> tuple[bytes, float]:
    """The drawing on a page with room for what sticks out of its own, without a size; and the page's width, pixels."""
    root = ElementTree.fromstring(content)
    stated = root.attrib.pop("width", "").removesuffix("px")
    root.attrib.pop("height", None)
    left, top, width, height = (float(word) for word in root.get("viewBox", f"0 0 {stated} {stated}").split())
    grown = (left - ROOM * width, top - ROOM * height, (1 + 2 * ROOM) * width, (1 + 2 * ROOM) * height)
    root.set("viewBox", " ".join(map(str, grown)))
    scale = float(stated) / width if stated.replace(".", "", 1).isdigit() else 1.0
    return ElementTree.tostring(root), grown[2] * scale


def painted(content: bytes) -> np.ndarray:
    """The largest connected piece of what a drawing shows, filled: (H, W) bool."""
    size = ["--width", str(SIDE), "--height", str(SIDE), "--keep-aspect-ratio"]
    found = subprocess.run(["rsvg-convert", *size], input=content, capture_output=True, check=True, timeout=60)
    opaque = np.asarray(Image.open(io.BytesIO(found.stdout)).convert("RGBA"))[..., 3] >= 128
    pieces, count = ndimage.label(ndimage.binary_fill_holes(opaque), structure=np.ones((3, 3)))
    areas = np.bincount(pieces.ravel(), minlength=count + 1)
    return pieces == 1 + int(np.argmax(areas[1:])) if count else opaque


def overlap(outline: Outline, shown: np.ndarray, pixels: float) -> float:
    """IoU of an outline with a mask, whose pixels are so many to a unit of the outline's size."""
    rows, columns = np.nonzero(shown)
    if not len(rows) or outline.size is None:
        return 0.0
    points = outline.points * (1.0, -1.0)
    low, high = points.min(axis=0), points.max(axis=0)
    scale = pixels * max(outline.size) / float(np.max(high - low))
    middle = np.array([columns.min() + columns.max() + 1, rows.min() + rows.max() + 1]) / 2.0
    placed = (points - (low + high) / 2.0) * scale + middle
    drawn = polygon2mask(shown.shape, placed[:, ::-1] - 0.5)
    return float(np.sum(drawn & shown) / np.sum(drawn | shown))


def judged(path: Path) -> dict[str, object]:
    """What the program takes of a drawing, and how it fits what is painted."""
    content, width = on_larger_page(path.read_bytes())
    shown = painted(content)
    try:
        source = svg_parts(path)
        outline = usual_outline(source)
    except KirigamiError as error:
        return {"result": "refused", "said": str(error)}
    share = overlap(outline, shown, shown.shape[1] / width)
    result = "same" if share >= SAME else "asked" if source.is_ambiguous else "silent"
    return {"result": result, "iou": round(share, 4), "asks": source.is_ambiguous}


def main() -> int:
    """Judge the icons and print the shares."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--icons", type=int, default=200, help="of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("build/readers"))
    parser.add_argument("kinds", nargs="*", default=list(SETS))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for kind in arguments.kinds:
        draw, all_ = random.Random(arguments.seed), SETS[kind]
        lots = [drawings(package, folder, arguments.out) for package, folder in all_.items()]
        chosen = []
        for turn, lot in enumerate(lots):
            count = (arguments.icons + len(lots) - 1 - turn) // len(lots)
            chosen += draw.sample(lot, min(count, len(lot)))
        results: collections.Counter[str] = collections.Counter()
        with (arguments.out / f"{kind}.jsonl").open("w") as record:
            for name, content in chosen:
                path = arguments.out / f"{kind}-{Path(name).name}"
                path.write_bytes(content)
                found = {"name": name, **judged(path)}
                results[str(found["result"])] += 1
                record.write(json.dumps(found) + "\n")
                if found["result"] == "same":
                    path.unlink()
        sys.stdout.write(json.dumps({"kind": kind, "icons": len(chosen), "seed": arguments.seed, **results}) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
