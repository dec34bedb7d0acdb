"""Make the gallery's projects and pictures: ``make gallery``.

Every silhouette of the library and three pinned pieces are designed where they have no project yet, and have a small
picture of the opened sheet; so have the bundled pairs.  The site makes of each project a page that moves
(``packaging/site_pages.py``).  Delete a project to have it designed anew.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
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


def add(folder: Path, name: str, designed: Callable[[], ks.Design]) -> None:
    """Write the project of one design where there is none yet, and its picture."""
    folder.mkdir(parents=True, exist_ok=True)
    project = folder / f"{name}.kiri"
    if not project.exists():
        designed().save(project)
    draw(ks.load_project(project).best, project.with_suffix(".png"))


def draw(design: ks.Design, picture: Path) -> None:
    """Write a small picture of the opened sheet."""
    picture.parent.mkdir(parents=True, exist_ok=True)
    design.export(picture)
    with Image.open(picture) as opened:
        small = opened.convert("RGB")
        small.thumbnail((SIDE, SIDE), Image.Resampling.LANCZOS)
        small.quantize(COLOURS).save(picture, optimize=True)
    print(f"{picture.parent.name}/{picture.stem}: match {design.match:.3f}", flush=True)


def main() -> None:
    """Make what is missing, and write the rest again."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=REPOSITORY / "docs" / "gallery")
    out: Path = parser.parse_args().out
    for path in sorted((REPOSITORY / "resources" / "pairs").glob("*.kiri")):
        draw(ks.load_project(path).best, out / "pairs" / f"{path.stem.split('-', 1)[1]}.png")
    for name in ks.target_names():
        add(out / "shapes", name, lambda name=name: library_sheet(name))
    for name, (target, start) in PINNED.items():
        add(out / "pinned", name, lambda target=target, start=start: pinned_piece(target, start))


if __name__ == "__main__":
    main()
