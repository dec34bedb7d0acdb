"""Make the gallery's pages and pictures: ``make gallery``.

Every silhouette of the library, every pair and three pinned pieces become a page to share, which moves in a browser and
holds its project, and a small picture of its opened sheet.  A page that is there is written again from the project in
it: delete what is to be designed anew.
"""

from __future__ import annotations

import argparse
import base64
import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image

import kirigami_studio as ks

REPOSITORY = Path(__file__).resolve().parents[1]
#: Designs of a run, width in mm, and the match from which a whole sheet is shown where one with notches matches better.
COUNT, WIDTH_MM, WHOLE_FROM = 8, 160.0, 0.97
#: Side of the small pictures in pixels and their colours.
SIDE, COLOURS = 220, 24
#: What is made of plywood on pins: name -> target, start.
PINNED = {"heart": ("heart", "rectangle"), "star": ("star", "rectangle"), "disk-to-square": ("square", "circle")}
PLYWOOD: dict[str, Any] = {"material": "plywood-co2", "width_mm": 300.0}


def library_sheet(name: str) -> ks.Design:
    """The best whole sheet of a library silhouette in film, or the one with notches where no whole one shows it."""
    designs = ks.design(ks.load_target(name), k=COUNT, material="film-uv", width_mm=WIDTH_MM)
    if designs.best.iou >= WHOLE_FROM:
        return designs.best
    return max((design for design in designs if design.feasible), key=lambda design: design.iou)


def pinned_piece(target: str, start: str) -> ks.Design:
    """The best design of a silhouette in plywood on pins."""
    return ks.design(ks.load_target(target), k=COUNT, start=start, **PLYWOOD).best


def design_in(page: Path) -> ks.Design:
    """The design of a page, with the settings of its project."""
    inside = re.search(r'id="project">([^<]*)<', page.read_text(encoding="utf-8"))
    if inside is None:
        raise SystemExit(f"{page} holds no project: delete it.")
    with TemporaryDirectory() as folder:
        project = Path(folder) / "design.kiri"
        project.write_bytes(base64.b64decode(inside[1]))
        return ks.load_project(project).best


def add(folder: Path, name: str, designed: Callable[[], ks.Design]) -> None:
    """Write the page and the picture of one design, which is made where there is no page yet."""
    folder.mkdir(parents=True, exist_ok=True)
    page, drawn = folder / f"{name}.html", folder / f"{name}.png"
    design = design_in(page) if page.exists() else designed()
    design.export(drawn)
    with Image.open(drawn) as opened:
        small = opened.convert("RGB")
        small.thumbnail((SIDE, SIDE), Image.Resampling.LANCZOS)
        small.quantize(COLOURS).save(drawn, optimize=True)
    design.export(page)
    print(f"{folder.name}/{name}: {design.iou:.3f}", flush=True)


def main() -> None:
    """Make what is missing, and write the rest again."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=REPOSITORY / "docs" / "gallery")
    out: Path = parser.parse_args().out
    for path in sorted((REPOSITORY / "resources" / "pairs").glob("*.kiri")):
        add(out / "pairs", path.stem.split("-", 1)[1], lambda path=path: ks.load_project(path).best)
    for name in ks.target_names():
        add(out / "shapes", name, lambda name=name: library_sheet(name))
    for name, (target, start) in PINNED.items():
        add(out / "pinned", name, lambda target=target, start=start: pinned_piece(target, start))


if __name__ == "__main__":
    main()
