"""An unexpected error while a sheet is made: nothing unverified appears, and whoever asked hears of it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.material import library
from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.steps import never
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.window.services import Services
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio import verdict as verdicts
from kirigami_studio.studio.cutting import expected_seconds, plan_sheet
from kirigami_studio.studio.making import CutRequest, ExportedFiles, Output, exporting, exporting_coupon, planned
from kirigami_studio.studio.verdict import SIGNS_OF_A_JAM

#: What goes wrong, and where: the verdict's sentences, the second reader, the sheet as cut.
FAULTS = (
    "kirigami_studio.studio.making.judged",
    "kirigami_studio.export.export_set.verify_export",
    "kirigami_studio.studio.verdict.simulate",
)


@pytest.fixture(scope="module")
def request_() -> CutRequest:
    field = RatioField.from_log10(np.random.default_rng(0).uniform(-0.5, 0.5, (4, 4)))
    motion = deploy(field)
    target = Outline.from_points(motion.outline(0.0), "own")
    design = Candidate(Sheet(field), evaluate(motion, target), seed=0, index=0)
    document = Document(target, DesignSettings((4, 4)), (design,), 0, FabricationSettings(connector_mm=0.2))
    planned(CutRequest.of(document))
    return CutRequest.of(document)


def planted(*_: object, **__: object) -> object:
    raise IndexError("list index out of range")


def export(request: CutRequest, output: Output) -> ExportedFiles:
    (found,) = exporting(request, output, True, never)
    assert isinstance(found, ExportedFiles)
    return found


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("name", ["cut.dxf", "cut.svg", "cut.pdf"])
def test_that_an_error_while_a_file_is_verified_and_judged_leaves_no_file(
    request_: CutRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, fault: str, name: str
) -> None:
    if name == "cut.pdf" and fault == FAULTS[1]:
        pytest.skip("a PDF is read back as it is written")
    older = tmp_path / f"older{Path(name).suffix}"
    older.write_bytes(b"an earlier export")
    monkeypatch.setattr(fault, planted)
    for path in (tmp_path / name, older):
        with pytest.raises(IndexError):
            export(request_, Output(path, record=True))
    assert [path.name for path in tmp_path.iterdir()] == [older.name]
    assert older.read_bytes() == b"an earlier export"


@pytest.mark.parametrize("fault", FAULTS[1:])
def test_that_an_error_while_a_set_is_written_leaves_no_file_that_nobody_verified(
    request_: CutRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, fault: str
) -> None:
    monkeypatch.setattr(fault, planted)
    with pytest.raises(IndexError):
        export(request_, Output(tmp_path / "set", "cut", record=True))
    assert list(tmp_path.rglob("*.*")) == []


def test_that_what_is_exported_has_its_verification_and_verdict(request_: CutRequest, tmp_path: Path) -> None:
    found = export(request_, Output(tmp_path / "cut.dxf", record=True))
    assert found.files == (tmp_path / "cut.dxf", tmp_path / "cut.json") and found.ok and found.verdict is not None
    (verified,) = found.verifications
    assert verified.path == tmp_path / "cut.dxf"
    # A whole set holds the same cut file.
    whole = export(request_, Output(tmp_path / "set", "cut"))
    assert (tmp_path / "set" / "cut.dxf").read_bytes() == (tmp_path / "cut.dxf").read_bytes()
    assert whole.verdict is not None and whole.verdict.level is found.verdict.level


@pytest.mark.qt
@pytest.mark.parametrize("closes", [False, True])
def test_that_an_error_in_the_verdict_is_shown_and_never_leaves_it_checking(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, request_: CutRequest, closes: bool
) -> None:
    assert request_.document is not None
    judge: Callable[..., object] = verdicts.judge

    def fails(candidate: object, plan: object, report: object, as_cut: object, *rest: object) -> object:
        """The preliminary verdict is made, the one on the closed sheet is not; or neither is."""
        return judge(candidate, plan, report, as_cut, *rest) if as_cut is None and closes else planted()

    monkeypatch.setattr(verdicts, "judge", fails)
    monkeypatch.setattr("kirigami_studio.studio.making._PLANS", OrderedDict())
    services, posted = Services(), []
    services.session.message_posted.connect(posted.append)
    try:
        services.session.restart(request_.document, None)
        qtbot.waitUntil(lambda: services.verdict.state.verdict is not None, timeout=60_000)
        qtbot.waitUntil(lambda: not services.verdict.busy and not services.session.queue.busy, timeout=60_000)
        state = services.verdict.state
        assert state.verdict is not None and not state.verdict.ok
        assert any("list index out of range" in line for line in state.lines)
        if closes:
            (message,) = [one for one in posted if isinstance(one, Message) and one.tone is Tone.ERROR]
            assert "list index out of range" in message.sentence
    finally:
        services.close()


def test_that_no_coupon_warns_of_a_jam_or_has_a_verdict(tmp_path: Path) -> None:
    for material in library().items.values():
        (found,) = exporting_coupon(material, tmp_path / f"{material.key}.dxf", FabricationSettings(), never)
        (read,) = found.verifications
        said = [*read.findings, *read.warnings, *found.planned.plan.notes, *found.planned.report.problems]
        assert not SIGNS_OF_A_JAM & {one.code for one in said} and read.void_miss_um is None
        assert found.verdict is None and read.ok and not any("jam" in one.text for one in said)


def test_that_a_sheet_whose_connectors_are_all_cut_is_written_and_will_not_work(
    request_: CutRequest, tmp_path: Path
) -> None:
    count = cut_table(4, 4).hinge_count
    settings = replace(request_.settings, options=CutOptions(removed=tuple(range(count))))
    found = export(replace(request_, settings=settings), Output(tmp_path / "cut.dxf"))
    assert (tmp_path / "cut.dxf").is_file() and found.verdict is not None
    assert found.verdict.level is verdicts.Level.FAILS and not found.ok
    assert found.verdict.as_cut is None and found.verdict.to_json()["jam_deg"] is None


@pytest.mark.parametrize(
    ("machine", "material"), [("", "film-uv"), ("diode-10w", "card-co2"), ("cricut-maker", "drag-knife")]
)
def test_that_the_time_of_cutting_that_is_expected_before_a_run_is_near_that_of_a_plan(
    machine: str, material: str
) -> None:
    settings = FabricationSettings(machine=machine, material=material, width_mm=160.0)
    plan = plan_sheet(deploy(RatioField.uniform(8, 8)), settings)
    ratio = expected_seconds(settings, (8, 8)) / plan.times.total
    assert 0.8 < ratio < 1.25, ratio
    assert expected_seconds(replace(settings, machine="hand")) == 0.0, "nobody knows how fast hands are"
    assert expected_seconds(replace(settings, material="none such")) == 0.0
