"""Settings of constructions: the one that suits a material, pins, ears, and what they need."""

from __future__ import annotations

import pytest

from kirigami_studio.fabricate.fastener import SIZES, Fastener
from kirigami_studio.fabricate.material import Construction, presets
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    construction_for,
    new_settings,
    pin_gap_mm,
    pin_sizes,
    with_choices,
)


@pytest.mark.parametrize("key", sorted(presets()))
def test_that_a_sheet_is_made_as_suits_its_material_unless_asked_for(key: str) -> None:
    usual = new_settings({"material": key})
    assert usual.construction is None
    assert construction_for(usual) is presets()[key].construction
    assert construction_for(with_choices(usual, {"construction": "pinned"})) is Construction.PINNED


@pytest.mark.parametrize("fastener", list(Fastener))
def test_that_ears_have_walls_as_wide_as_the_hole_and_clear_the_heads(fastener: Fastener) -> None:
    sizes = pin_sizes(FabricationSettings(fastener=fastener))
    assert sizes.hole_mm == SIZES[fastener].hole_mm
    assert 0.5 * (sizes.ear_mm - sizes.hole_mm) == pytest.approx(max(sizes.hole_mm, 2.0))
    assert sizes.apart_mm == pytest.approx(sizes.ear_mm + 2 * 0.6 + sizes.neck_mm)
    assert sizes.apart_mm > sizes.head_mm > sizes.hole_mm


def test_that_only_pinned_sheets_keep_their_pins_apart() -> None:
    plywood = new_settings({"material": "plywood-co2", "ear_mm": 9.0, "clearance_mm": 0.5})
    assert pin_gap_mm(plywood) == pytest.approx((9.0 + 2 * 0.5 + 2.0) * 380.0 / (380.0 - 9.0))
    assert pin_gap_mm(with_choices(plywood, {"construction": "one-sheet"})) == 0.0
    assert pin_gap_mm(new_settings({"material": "film-uv"})) == 0.0


def test_that_an_ear_within_its_hole_is_refused() -> None:
    with pytest.raises(UsageError) as refused:
        pin_sizes(FabricationSettings(pin_mm=6.0, ear_mm=6.0))
    assert refused.value.code == "settings.ear_within_hole"


@pytest.mark.parametrize(
    ("name", "value"),
    [("pin_mm", 0.0), ("pin_mm", float("nan")), ("ear_mm", 1e9), ("clearance_mm", -0.1), ("gap_mm", float("inf"))],
)
def test_that_impossible_lengths_are_refused(name: str, value: float) -> None:
    with pytest.raises(UsageError) as refused:
        FabricationSettings(**{name: value})
    assert refused.value.code == "settings.length_out_of_range"


def test_that_printed_pins_are_refused_with_what_can_be_printed() -> None:
    with pytest.raises(UsageError) as refused:
        new_settings({"construction": "printed"})
    assert refused.value.code == "settings.printed_not_fitted"


def test_that_an_unknown_construction_is_refused() -> None:
    with pytest.raises(UsageError) as refused:
        new_settings({"construction": "woven"})
    assert refused.value.code == "settings.no_such_choice"
