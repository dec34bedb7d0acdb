"""Window, command line and Python API are three faces of one program: the same request, the same designs and files.

The window's job runs as ``gui`` hands it to its queue, without a window.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

import kirigami_studio as ks
from kirigami_studio.cli import main
from kirigami_studio.gui.window.services import Services
from kirigami_studio.outlines.read import read_target
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import new_settings
from kirigami_studio.studio.making import ExportedFiles

#: Voids, designs and seed of every case: panels are small enough for some designs to jam or to be refused as cut.
GRID, DESIGNS, SEED = (6, 6), 6, 3
PATIENCE = 300_000
#: Without a material, everywhere the one that new projects have.
CASES = (*product(("heart", "star", "butterfly", "gear"), ("film-uv", "paper-hand", "card-co2")), ("star", None))


@dataclass(frozen=True)
class Answer:
    """What a face makes of a request: sample numbers from the best on, the best ratios, the verdict, its cut file.

    The verdict is as JSON: its level, the four answers, where the sheet jams and how that is known, problems, notes.
    """

    order: tuple[int, ...]
    best: Sequence[Sequence[float]]
    verdict: dict[str, object]
    dxf: bytes


def named(material: str | None) -> dict[str, str]:
    return {} if material is None else {"material": material}


def of_window(qtbot: QtBot, target: str, material: str | None, folder: Path) -> Answer:
    services = Services()
    try:
        settings = DesignSettings(GRID, k=DESIGNS, seed=SEED, auto_grid=False)
        cut = new_settings(named(material))
        services.session.restart(Document(read_target(target), settings, fabrication=cut), None)
        with qtbot.waitSignal(services.run.completed, timeout=PATIENCE):
            services.generation.generate()
        exported: list[ExportedFiles] = []
        services.exporter.exported.connect(exported.append)
        services.exporter.export(folder / "window" / "cut.dxf")
        qtbot.waitUntil(lambda: bool(exported), timeout=PATIENCE)
        document, verdict = services.session.document, exported[0].verdict
        assert document.candidate is document.candidates[0] and verdict is not None
        # Card, table and banner have the verdict of the file.
        qtbot.waitUntil(lambda: not services.verdict.state.pending, timeout=PATIENCE)
        shown = services.estimates.verdicts[document.candidates[0]]
        assert services.verdict.state.verdict == shown and shown.read
        assert shown.to_json() == verdict.to_json()
        order = tuple(one.index for one in document.candidates)
        best = document.candidates[0].sheet.field.ratio.tolist()
        return Answer(order, best, verdict.to_json(), (folder / "window" / "cut.dxf").read_bytes())
    finally:
        services.close()


def of_command_line(capsys: pytest.CaptureFixture[str], target: str, material: str | None, folder: Path) -> Answer:
    rows, columns = GRID
    wish = ("--grid", f"{rows}x{columns}", "--k", str(DESIGNS), "--seed", str(SEED))
    wish += () if material is None else ("--material", material)
    assert main(["design", target, *wish, "--out", str(folder / "line"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    again = folder / "again" / "cut.dxf"
    assert main(["export", str(folder / "line" / "design.kiri"), "--out", str(again), "--json"]) == 0
    exported = json.loads(capsys.readouterr().out)
    # What design writes is what export writes of its project, and has the same verdict.
    assert (folder / "line" / "cut.dxf").read_bytes() == again.read_bytes()
    assert found["verdict"] == exported["verdict"]
    assert set(found["verdict"]["answers"]) == {"matches", "fits_material", "closes", "files"}
    for one in (found, exported, found["candidates"][0]["as_cut"]):
        assert (one["jam_deg"], one["jam_from"]) == (found["verdict"]["jam_deg"], found["verdict"]["jam_from"])
    main(["check", str(again), "--design", str(folder / "line" / "design.kiri"), "--json"])
    checked = json.loads(capsys.readouterr().out)
    assert checked["verdict"]["answers"] == found["verdict"]["answers"]
    assert (checked["jam_deg"], checked["jam_from"]) == (found["jam_deg"], found["jam_from"])
    order = tuple(one["index"] for one in found["candidates"])
    return Answer(order, found["best"]["ratio"], exported["verdict"], again.read_bytes())


def of_python(target: str, material: str | None, folder: Path) -> Answer:
    designs = ks.design(target, grid=GRID, k=DESIGNS, seed=SEED, material=material)
    exported = designs.best.export(folder / "python" / "cut.dxf")
    assert exported.verdict is not None
    order = tuple(one.candidate.index for one in designs)
    return Answer(order, designs.best.ratios.tolist(), exported.verdict.to_json(), exported.path.read_bytes())


@pytest.mark.torch
@pytest.mark.qt
@pytest.mark.parametrize(("target", "material"), CASES)
def test_that_three_faces_give_the_same_designs_verdict_and_file(
    qtbot: QtBot, capsys: pytest.CaptureFixture[str], tmp_path: Path, target: str, material: str | None
) -> None:
    line = of_command_line(capsys, target, material, tmp_path)
    for face in (of_python(target, material, tmp_path), of_window(qtbot, target, material, tmp_path)):
        assert face.order == line.order
        assert face.best == line.best
        assert face.verdict == line.verdict
        assert face.dxf == line.dxf
