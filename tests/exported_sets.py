"""Exports of pinned, backed and printed designs, every file checked again: ``python tests/exported_sets.py 20``.

Each is a random design with random choices of its making.  A check of each file alone, and of all files of a kind
beside the design, has to agree with the verdict of the export.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import new_settings
from kirigami_studio.studio.checking import checked, checked_together
from kirigami_studio.studio.making import CutRequest, ExportedFiles, Output, closed, planned, written, written_pieces

MADE_AS = (Construction.PINNED, Construction.BACKED, Construction.PRINTED)
#: Of both layers.
CUT_FILES = (".dxf", ".svg", ".lbrn2")
OTHER_FILES = (".pdf", ".png", ".json", ".csv", ".3mf", ".stl", ".obj", ".txt")
CHOICES: dict[Construction, dict[str, Sequence[object]]] = {
    Construction.PINNED: {
        "material": ("plywood-co2", "acrylic-co2", "card-05-co2"),
        "fastener": ("brad", "m2", "m3", "eyelet", "rivet"),
        "profile": ("any", "lightburn", "k40", "single", "slots", "glowforge"),
        "held_by": ("none", "magnets", "eyelets", "stitches", "tabs"),
        "moved_by": ("none", "none", "crank", "servo"),
        "kerf_mm": (None, 0.1, 0.2),
        "width_mm": (180.0, 260.0, 380.0),
        "engrave": (False, True),
    },
    Construction.BACKED: {
        "material": ("felt-co2", "cotton-co2", "tape-knife", "leather-co2", "plywood-co2"),
        "board_cut": ("through", "kiss"),
        "gap_mm": (0.5, 1.0, 2.0),
        "profile": ("any", "lightburn", "k40", "single", "xtool"),
        "kerf_mm": (None, 0.1),
        "width_mm": (200.0, 300.0, 380.0),
    },
    Construction.PRINTED: {
        "material": ("pla-print", "petg-print"),
        "width_mm": (150.0, 180.0, 240.0),
        "clearance_mm": (None, 0.3, 0.5),
    },
}


def project_of(number: int) -> Document:
    """A random design: a pinwheel of its own for pins, else of ratios near 1; chosen as it is made."""
    random, construction = np.random.default_rng(number), MADE_AS[number % len(MADE_AS)]
    rows, columns = random.integers(2, 5, 2).tolist()
    signs = (-1.0) ** np.add.outer(range(rows), range(columns))
    drawn = random.uniform(0.17, 0.25, (rows, columns)) * signs
    if construction is Construction.BACKED:
        drawn = random.uniform(-0.1, 0.1, (rows, columns))
    sheet = Sheet(RatioField.from_log10(drawn))
    motion = deploy(sheet)
    target = Outline.from_points(motion.outline(0.0), "own")
    options = {name: values[int(random.integers(len(values)))] for name, values in CHOICES[construction].items()}
    chosen = {name: value for name, value in options.items() if value is not None}
    settings = new_settings({"construction": construction.value, **chosen})
    return Document(
        target, DesignSettings((rows, columns)), (Candidate(sheet, evaluate(motion, target), 0, 0),), 0, settings
    )


def exported(project: Document, folder: Path) -> ExportedFiles:
    """Write all files of a project, as ``export --all`` does."""
    request = CutRequest.of(project)
    if request.is_pinned:
        return written_pieces(request, Output(folder, "cut", True))
    made = planned(request)
    return written(request, made, Output(folder, "cut", True), closed(request, made))


def contradictions(project: Document, found: ExportedFiles) -> tuple[int, list[str]]:
    """Cut files of the export of a project, and sentences on checks that do not agree with its verdict."""
    verdict = found.verdict
    assert verdict is not None
    cut: dict[str, list[Path]] = {}
    wrong: list[str] = []
    for path in found.files:
        try:
            alone = checked(path)
        except ExportError as error:
            if error.code != "cut_file.other_kind" or path.suffix not in OTHER_FILES:
                wrong.append(f"{path.name} is refused: {error}")
            continue
        codes = [problem.code for problem in alone.report.problems]
        if codes == ["cut_file.not_for_cutting"]:
            continue
        cut.setdefault(path.suffix, []).append(path)
        if alone.sound is not found.ok or alone.verdict is not None:
            wrong.append(f"{path.name} alone: sound is {alone.sound}, the export's files are {found.ok}: {codes}")
        if alone.said is not verdict.level:
            wrong.append(f"{path.name} says {alone.said}, the export {verdict.level}")
    for kind, paths in cut.items():
        wrong += [f"all {kind}: {text}" for text in _against(project, found, paths)]
    return sum(map(len, cut.values())), wrong


def _against(project: Document, found: ExportedFiles, paths: Sequence[Path]) -> Iterator[str]:
    """Sentences on files that beside their design are judged otherwise than their export was."""
    verdict = found.verdict
    assert verdict is not None
    for one in checked_together(paths, project):
        if one.verdict is None:  # a layer of a backed design says nothing about all of it
            if not one.sound:
                yield f"{one.report.path.name} is not sound"
            continue
        codes = [problem.code for problem in one.verdict.problems]
        known = [problem.code for problem in verdict.problems]
        if one.verdict.level is not verdict.level or sorted(codes) != sorted(known):
            yield f"{one.verdict.level} {codes}, the export {verdict.level} {known}"


def main() -> int:
    """Check random exports, and tell how many files contradict their export."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("designs", type=int, nargs="?", default=20)
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    total, wrong, begun = 0, 0, time.process_time()
    for number in range(arguments.first, arguments.first + arguments.designs):
        with tempfile.TemporaryDirectory() as folder:
            project = project_of(number)
            files, told = contradictions(project, exported(project, Path(folder) / "set"))
        total, wrong = total + files, wrong + len(told)
        lines = (f"{number}: {MADE_AS[number % len(MADE_AS)].value}, {files} cut files", *told)
        sys.stdout.write("\n  ".join(lines) + "\n")
        sys.stdout.flush()
    spent = time.process_time() - begun
    sys.stdout.write(f"{total} cut files, {wrong} contradictions, {spent:.0f} s of processor\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
