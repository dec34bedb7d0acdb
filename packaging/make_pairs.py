"""Make the bundled pairs: finished designs from one shape to another, each out of one run with a kept seed.

``python packaging/make_pairs.py`` writes ``resources/pairs/*.kiri`` and prints their numbers; ``make pairs`` calls it.
The same program makes the same files.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace
from pathlib import Path

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.lattice.laying import start_error
from kirigami_studio.outlines.read import read_target
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.polish.symmetry import KeptSymmetry
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import save
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import completed, document_of, request_for, run_design
from kirigami_studio.studio.verdict import assess

FOLDER = Path(__file__).resolve().parents[1] / "resources" / "pairs"
#: Even panels count more than the last percent of match: these are to be looked at.
DESIGNS, POLISH, SEED, REGULAR = 32, 15, 0, 0.75
#: A sheet that is turned by no more than this (degrees) stands upright.
UPRIGHT = 1.0


@dataclass(frozen=True, slots=True)
class Pair:
    """A start and a target.

    Attributes
    ----------
    start, target : str
        By their names.
    upright : bool
        Whether the first design is taken that stands upright: over a round target, for one, it may stand anyhow.
    symmetry : str
        What designs have to keep: a leaf is no mirror image of itself that counts.
    """

    start: str
    target: str
    upright: bool = False
    symmetry: str = "auto"


PAIRS = (
    Pair("circle", "heart"),
    Pair("circle", "square"),
    Pair("triangle", "circle", upright=True),
    Pair("hexagon", "star", symmetry="mirror"),
    Pair("square", "circle", upright=True),
    Pair("ellipse:3:2", "shield"),
    Pair("circle", "bell"),
    Pair("square", "plus"),
    Pair("circle", "flower"),
    Pair("square", "triangle", upright=True),
    Pair("square", "leaf", symmetry="none"),
    Pair("egg", "bean"),
)


def made(pair: Pair) -> Document:
    """Design a pair and keep the first design, without how it was sampled."""
    cut = FabricationSettings()
    wanted = DesignSettings(
        k=DESIGNS,
        seed=SEED,
        polish=POLISH,
        regular=REGULAR,
        symmetry=KeptSymmetry(pair.symmetry),
        start=start_shape(pair.start),
    )
    request = request_for(read_target(pair.target), wanted, cut)
    result = completed(run_design(request, cut), lambda _: None)
    document = document_of(result, cut)
    number = next(k for k, one in enumerate(document.candidates) if not pair.upright or abs(turn_of(one)) < UPRIGHT)
    # As it was, without how it was sampled.
    chosen = replace(document.candidates[number], sampled_sheet=None)
    return replace(document, candidates=(chosen,), chosen=0, marks=(), labels=())


def turn_of(candidate: Candidate) -> float:
    """By how much the flat sheet stands turned over the target, degrees."""
    return math.degrees(math.remainder(candidate.score.transform.angle, 2.0 * math.pi))


def main() -> int:
    """Write all pairs in the place of those that were there."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for old in FOLDER.glob("*.kiri"):
        old.unlink()
    for number, pair in enumerate(PAIRS, start=1):
        document = made(pair)
        path = FOLDER / f"{number:02d}-{pair.start.partition(':')[0]}-to-{pair.target}.kiri"
        save(document, path)
        (candidate,) = document.candidates
        score, verdict = candidate.score, assess(candidate, document.fabrication, document.target).verdict
        sys.stdout.write(
            f"{path.stem}: IoU {score.iou_exact:.4f}, CV {score.evenness.area_cv:.2f}, start error "
            f"{100 * start_error(candidate.sheet):.2f} %, verdict {verdict.level.value}, {path.stat().st_size} bytes\n"
        )
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
