"""Reads public drawings and compares each outline with what another program paints; ``make readers``.

Icons of npm packages and the SVG of librsvg's tests (the W3C's suite among them) are painted by rsvg-convert, the DXF
of OpenSCAD's tests and of LibreCAD's library by ezdxf's drawing add-on.  The largest connected piece of what is opaque
is filled, and the outline that the program takes without a question is laid over it, by its size (of DXF: by its box)
and the middle of its box.  Of the tests those count that hold a silhouette (:func:`holds_silhouette`).  A line of JSON
each in the folder; a summary at the end.  Pictures with known silhouettes are read, too (``synthetic_pictures``).

Needs npm with its registry, Debian's with ``apt-get`` and ``dpkg-deb``, and rsvg-convert (Debian: librsvg2-bin).
"""

from __future__ import annotations

import argparse
import collections
import io
import json
import random
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import synthetic_pictures
from PIL import Image
from scipy import ndimage
from skimage.draw import polygon2mask

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.outlines.merging import usual_outline
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import read_parts

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
#: Debian packages with test suites, and the folders of their drawings.
SUITES = {
    "svg-tests": {"librsvg2-tests": [f"RSVG/fixtures/reftests/{name}" for name in ("svg1.1", "svg2", "bugs", "")]},
    "dxf-tests": {
        "openscad-testing-data": ["openscad/testdata/dxf"],
        "librecad-data": ["librecad/library"],
    },
}
#: Marks of the W3C's suite around and below each drawing, by their ids.
MARKS = frozenset({"test-frame", "revision", "draft-watermark"})
#: Filters and pictures: drawings that show another shape without them are not judged, outlines have no such edges.
PIXEL_WORK = re.compile(
    rb"(?<![\w-])filter\s*=\s*\"[^\"]*\"|(?<![\w-])filter\s*:[^;\"'}]*|<(?:\w+:)?image\b(?:[^>\"]|\"[^\"]*\")*/>"
)
#: A silhouette: share of the picture that it has, and share of it that is left when it becomes thinner by a hundredth.
LEAST_SHARE, LEAST_SOLID = 0.01, 0.5
#: Share of all that is painted that one piece has where a drawing shows one shape.
ALONE = 0.75
#: Pixels of the lines of a DXF.
LINE = 2
#: Pixels of the longer side, and the overlap from which on both show the same.
SIDE, SAME = 1200, 0.98
#: What sticks out of the page is read; here the page is larger to all sides by this share, that of tests by more.
ROOM, ROOM_OF_TESTS = 0.1, 0.4
#: Lengths of pages, and pixels of each unit; drawings in real units are read in millimetres.
UNITS = re.compile(r"([\d.]+)(px|mm|cm|in|pt|pc|)")
MM_PER_PIXEL = 25.4 / 96.0
PIXELS = {"": 1.0, "px": 1.0, "mm": 96 / 25.4, "cm": 960 / 25.4, "in": 96.0, "pt": 96 / 72, "pc": 16.0}
REAL = frozenset({"mm", "cm", "in", "pt", "pc"})


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


def suite(packages: dict[str, list[str]], keep: Path) -> list[list[tuple[str, bytes]]]:
    """Names and contents of the drawings in Debian packages, by name; one list a package."""
    lots = []
    for package, folders in packages.items():
        place = keep / package
        if not place.exists():
            with tempfile.TemporaryDirectory() as folder:
                subprocess.run(["apt-get", "download", "-q", package], cwd=folder, check=True, capture_output=True)
                (found,) = Path(folder).glob("*.deb")
                subprocess.run(["dpkg-deb", "-x", found, place], check=True)
        files = {
            path
            for path in place.rglob("*")
            if path.suffix.lower() in (".svg", ".dxf")
            for one in folders
            if (path.parent.as_posix() + "/").endswith(f"{one.rstrip('/')}/") or ("library" in one and one in str(path))
        }
        lots.append([(path.relative_to(place).as_posix(), path.read_bytes()) for path in sorted(files)])
    return lots


def without_marks(content: bytes) -> bytes:
    """A drawing of the W3C's suite without its frame and its revision."""
    root = ElementTree.fromstring(content)
    for around in list(root.iter()):
        for one in list(around):
            if one.get("id") in MARKS:
                around.remove(one)
    return ElementTree.tostring(root)


def holds_silhouette(shown: np.ndarray, share: float) -> bool:
    """Whether a mask is one shape rather than lines, letters, nothing, or one of several shapes."""
    if share < ALONE:
        return False
    thinner = ndimage.binary_erosion(shown, iterations=max(shown.shape) // 100)
    return bool(np.mean(shown) >= LEAST_SHARE and np.sum(thinner) >= LEAST_SOLID * np.sum(shown))


def dxf_as_svg(path: Path) -> bytes:
    """A DXF as ezdxf's drawing add-on shows it, texts left out."""
    from ezdxf import recover
    from ezdxf.addons.drawing import Frontend, RenderContext, config, layout
    from ezdxf.addons.drawing.svg import SVGBackend

    document, _ = recover.readfile(path)
    backend = SVGBackend()
    settings = config.Configuration(
        lineweight_policy=config.LineweightPolicy.RELATIVE_FIXED,
        line_policy=config.LinePolicy.SOLID,
        color_policy=config.ColorPolicy.BLACK,
        background_policy=config.BackgroundPolicy.OFF,
        text_policy=config.TextPolicy.IGNORE,
    )
    Frontend(RenderContext(document), backend, config=settings).draw_layout(document.modelspace())
    room = 0.05 * SIDE
    page = layout.Page(SIDE, SIDE, layout.Units.mm, layout.Margins.all(room))
    thin = layout.Settings(max_stroke_width=LINE / SIDE, fixed_stroke_width=1.0)
    return backend.get_string(page, settings=thin).encode()


def on_larger_page(content: bytes, room: float = ROOM) -> tuple[bytes, float]:
    """The drawing on a page with room for what sticks out of its own; and the page's width in the reader's unit."""
    root = ElementTree.fromstring(content)
    stated = [UNITS.fullmatch(root.get(name, "")) for name in ("width", "height")]
    sizes = [None if one is None else float(one[1]) * PIXELS[one[2]] for one in stated]
    if root.get("viewBox"):
        _, _, *view = (float(word) for word in root.get("viewBox", "").replace(",", " ").split())
        sizes[0] = view[0] * (1.0 if sizes[1] is None else sizes[1] / view[1]) if sizes[0] is None else sizes[0]
        sizes[1] = sizes[0] * view[1] / view[0] if sizes[1] is None else sizes[1]
    width, height = (one or 100.0 for one in sizes)
    for name, value in {"x": 0.0, "y": 0.0, "width": width, "height": height, "overflow": "visible"}.items():
        root.set(name, str(value))
    grown = (-room * width, -room * height, (1 + 2 * room) * width, (1 + 2 * room) * height)
    page = ElementTree.Element("{http://www.w3.org/2000/svg}svg", {"viewBox": " ".join(map(str, grown))})
    page.append(root)
    to_unit = MM_PER_PIXEL if stated[0] is not None and stated[0][2] in REAL else 1.0
    return ElementTree.tostring(page), grown[2] * to_unit


def painted(content: bytes, side: int = SIDE, line: int = 0) -> tuple[np.ndarray, float]:
    """The largest connected piece of what a drawing shows, filled: (H, W) bool; and its share of all pieces.

    Lines that are ``line`` pixels wide and enclose nothing do not count, nor does their width.
    """
    size = ["--width", str(side), "--height", str(side), "--keep-aspect-ratio"]
    found = subprocess.run(["rsvg-convert", *size], input=content, capture_output=True, check=True, timeout=60)
    opaque = np.asarray(Image.open(io.BytesIO(found.stdout)).convert("RGBA"))[..., 3] >= 128
    filled = ndimage.binary_fill_holes(opaque)
    if line:
        disk = np.hypot(*np.mgrid[-line : line + 1, -line : line + 1]) <= line
        filled = ndimage.binary_opening(filled, disk)
    pieces, count = ndimage.label(filled, structure=np.ones((3, 3)))
    areas = np.bincount(pieces.ravel(), minlength=count + 1)[1:]
    if not count:
        return opaque, 0.0
    shown = pieces == 1 + int(np.argmax(areas))
    return ndimage.binary_erosion(shown, iterations=max(line // 2, 0)) if line else shown, areas.max() / areas.sum()


def overlap(outline: Outline, shown: np.ndarray, pixels: float | None) -> float:
    """IoU of an outline with a mask, whose pixels are so many to a unit of the outline's size, or its box's."""
    rows, columns = np.nonzero(shown)
    if not len(rows) or outline.size is None:
        return 0.0
    points = outline.points * (1.0, -1.0)
    low, high = points.min(axis=0), points.max(axis=0)
    if pixels is None:
        scale = (max(np.ptp(rows), np.ptp(columns)) + 1) / float(np.max(high - low))
    else:
        scale = pixels * max(outline.size) / float(np.max(high - low))
    middle = np.array([columns.min() + columns.max() + 1, rows.min() + rows.max() + 1]) / 2.0
    placed = (points - (low + high) / 2.0) * scale + middle
    drawn = polygon2mask(shown.shape, placed[:, ::-1] - 0.5)
    return float(np.sum(drawn & shown) / np.sum(drawn | shown))


def judged(path: Path) -> dict[str, object]:
    """Compare the outline that the program takes of an icon with what is painted."""
    content, width = on_larger_page(path.read_bytes())
    shown, _ = painted(content)
    return compared(path, shown, shown.shape[1] / width)


def judged_of_suite(path: Path) -> dict[str, object]:
    """Compare the outline that the program takes of a test with what is painted, if that is a silhouette."""
    try:
        if path.suffix.lower() == ".dxf":
            shown, share = painted(dxf_as_svg(path), SIDE, LINE)
            pixels = None
        else:
            path.write_bytes(without_marks(path.read_bytes()))
            content, width = on_larger_page(path.read_bytes(), ROOM_OF_TESTS)
            shown, share = painted(content, SIDE)
            pixels = shown.shape[1] / width
            if shown.any() and PIXEL_WORK.search(content):
                bare, _ = painted(PIXEL_WORK.sub(b"", content), SIDE)
                if np.sum(bare & shown) < SAME * np.sum(bare | shown):
                    return {"result": "by pixels"}
    except Exception as error:  # tests of broken drawings, which the other program does not paint, too
        return {"result": "not painted", "said": repr(error)[:200]}
    if not holds_silhouette(shown, share):
        return {"result": "no silhouette"}
    return compared(path, shown, pixels)


def says_more(notes: Sequence[str]) -> bool:
    """Whether a reader names something beside the shape that it did not follow; insides and fonts are none of it."""
    return any(not re.match(r"The font |Holes |\d+ (contour|open line)", note) for note in notes)


def compared(path: Path, shown: np.ndarray, pixels: float | None) -> dict[str, object]:
    """Compare what is taken of a drawing with a mask of what is painted."""
    try:
        source = read_parts(path)
        outline = usual_outline(source)
    except KirigamiError as error:
        return {"result": "refused", "said": str(error)}
    share = overlap(outline, shown, pixels)
    otherwise = "asked" if source.is_ambiguous else "told" if says_more(outline.notes) else "silent"
    result = "same" if share >= SAME else otherwise
    return {"result": result, "iou": round(share, 4), "asks": source.is_ambiguous, "notes": outline.notes}


def main() -> int:
    """Judge the icons and print the shares."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--icons", type=int, default=200, help="of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("build/readers"))
    parser.add_argument("kinds", nargs="*", default=[*SETS, *SUITES, "pictures"])
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for kind in arguments.kinds:
        if kind == "pictures":
            synthetic_pictures.main()
            continue
        draw = random.Random(arguments.seed)
        if kind in SUITES:
            lots = suite(SUITES[kind], arguments.out)
        else:
            lots = [drawings(package, folder, arguments.out) for package, folder in SETS[kind].items()]
        chosen = []
        for turn, lot in enumerate(lots):
            count = (arguments.icons + len(lots) - 1 - turn) // len(lots)
            chosen += draw.sample(lot, min(count, len(lot)))
        results: collections.Counter[str] = collections.Counter()
        with (arguments.out / f"{kind}.jsonl").open("w") as record:
            for name, content in chosen:
                path = arguments.out / f"{kind}-{Path(name).name}"
                path.write_bytes(content)
                found = {"name": name, **(judged_of_suite if kind in SUITES else judged)(path)}
                results[str(found["result"])] += 1
                record.write(json.dumps(found) + "\n")
                if found["result"] == "same":
                    path.unlink()
        sys.stdout.write(json.dumps({"kind": kind, "drawings": len(chosen), "seed": arguments.seed, **results}) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
