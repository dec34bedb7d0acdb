"""Fixes of pinned designs: changes whose pieces were made, and whose verdict is the one that is told."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.__main__ import main
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import never
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import FabricationSettings, pin_sizes, with_choices
from kirigami_studio.studio import fixes
from kirigami_studio.studio.assembling import assembled
from kirigami_studio.studio.fixes import Advice
from kirigami_studio.studio.making import CutRequest, fixing, judged_pieces
from kirigami_studio.studio.verdict import judge_assembled
from tests.pinned_assemblies import plain_pinwheel


@pytest.fixture(scope="module")
def pinwheel() -> Document:
    return plain_pinwheel()


def cut(document: Document, **choices: object) -> Document:
    return replace(document, fabrication=with_choices(document.fabrication, choices))


def advice(document: Document, others: bool = False) -> Advice:
    request = CutRequest.of(document)
    verdict = judged_pieces(request)
    assert not verdict.ok
    *_, found = fixing(request, verdict, document.named_candidates if others else {}, None, never)
    assert isinstance(found, Advice)
    for fix in found.fixes:
        again = judge_assembled(fix.candidate, assembled(fix.candidate, fix.settings, request.target))  # type: ignore[arg-type]
        assert again == fix.verdict and again.better_than(verdict)
    return found


def test_that_ears_that_meet_become_smaller_and_the_sheet_is_then_ready(pinwheel: Document) -> None:
    crowded = cut(pinwheel, ear_mm=15.0)
    found = advice(crowded)
    first = found.fixes[0]
    assert first.verdict.ok and first.change.code == "fix.ear" and first.solves == ("pinned.ears_meet",)
    assert first.settings == replace(crowded.fabrication, ear_mm=first.settings.ear_mm)
    assert 5.6 < pin_sizes(first.settings).ear_mm < 15.0
    assert len({fix.change.code for fix in found.fixes}) == len(found.fixes)
    said = first.to_json()
    assert said["level"] == "ready_to_cut" and said["ear_mm"] == first.settings.ear_mm and said["fastener"] == "brad"


def test_that_screws_that_are_too_large_give_way_to_brads_or_the_sheet_grows(
    pinwheel: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fixes, "EARS", ())
    monkeypatch.setattr(fixes, "WIDTHS", (1.5,))
    small = cut(pinwheel, width_mm=66.0, fastener="m3")
    found = advice(small)
    assert found.fixes and found.fixes[0].verdict.ok
    for fix in found.fixes:
        assert fix.settings.fastener is not Fastener.M3 or fix.settings.width_mm > 66.0


def test_that_a_fix_is_one_step_that_leads_to_its_verdict(pinwheel: Document) -> None:
    crowded = cut(pinwheel, ear_mm=15.0)
    fix = advice(crowded).fixes[0]
    after = fix.edit(crowded).document
    assert judged_pieces(CutRequest.of(after)) == fix.verdict


def test_that_an_ear_without_room_for_its_hole_gets_the_usual_one(pinwheel: Document) -> None:
    refused = cut(pinwheel, ear_mm=1.5)
    first = advice(refused).fixes[0]
    assert first.verdict.ok and first.settings.ear_mm is None


def test_that_it_is_said_where_nothing_works(pinwheel: Document, monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[FabricationSettings] = []

    def refuse(candidate: object, settings: FabricationSettings, target: object) -> None:
        tried.append(settings)
        raise KirigamiError("pins.sheet_too_narrow", width_mm=1.0, margin_mm=1.0)

    request = CutRequest.of(cut(pinwheel, ear_mm=15.0))
    verdict = judged_pieces(request)
    monkeypatch.setattr(fixes, "assembled", refuse)
    *_, found = fixing(request, verdict, {}, None, never)
    assert isinstance(found, Advice) and found.fixes == () and found.tried.code == "fix.none_of_pieces"
    assert found.tried.fields["count"] == len(tried) > 3


def test_that_export_with_fixes_tells_them_for_pieces(
    pinwheel: Document, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fixes, "WIDTHS", ())
    store.save(cut(pinwheel, ear_mm=15.0), tmp_path / "square.kiri")
    wish = ["export", str(tmp_path / "square.kiri"), "--out", str(tmp_path / "square.png"), "--fixes", "--json"]
    assert main(wish) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["fixes"][0]["code"] == "fix.ear" and said["fixes"][0]["level"] == "ready_to_cut" and said["tried"]
