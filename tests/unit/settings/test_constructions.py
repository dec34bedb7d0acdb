"""Settings of constructions: the one that suits a material, pins, ears, and what they need."""

from __future__ import annotations

import pytest

from kirigami_studio.fabricate.fastener import SIZES, Fastener, PrintedPins
from kirigami_studio.fabricate.machine import MachineKind
from kirigami_studio.fabricate.material import Construction, presets
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    construction_for,
    is_pinned,
    is_printed,
    machine_for,
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


def test_that_printed_sheets_are_of_a_material_that_printers_take_unless_another_is_named() -> None:
    asked = new_settings({"construction": "printed"})
    assert (asked.material, asked.width_mm) == ("pla-print", presets()["pla-print"].sheet_mm)
    assert machine_for(asked).kind is MachineKind.PRINTER and is_pinned(asked) and is_printed(asked)
    mini = new_settings({"construction": "printed", "machine": "fdm-180"})
    assert (mini.material, machine_for(mini).key) == ("pla-print", "fdm-180")
    film = with_choices(new_settings({"machine": "uv-laser"}), {"construction": "printed"})
    assert (film.material, film.machine) == ("pla-print", "")
    assert with_choices(new_settings({"material": "tpu-print"}), {"construction": "printed"}).material == "tpu-print"
    assert with_choices(film, {"material": "acrylic-co2"}).material == "acrylic-co2"
    assert new_settings({"construction": "printed", "material": "acrylic-co2"}).material == "acrylic-co2"


def test_that_the_clearance_is_that_of_the_construction_unless_asked_for() -> None:
    printed, plywood = new_settings({"construction": "printed"}), new_settings({"material": "plywood-co2"})
    assert (pin_sizes(printed).clearance_mm, pin_sizes(plywood).clearance_mm) == (PrintedPins().clearance_mm, 0.6)
    for settings in (printed, plywood):
        assert pin_sizes(with_choices(settings, {"clearance_mm": 0.4})).clearance_mm == 0.4
    sizes = pin_sizes(printed)
    assert (sizes.hole_mm, sizes.ear_mm, sizes.margin_mm) == (PrintedPins().pin_mm, PrintedPins().ear_mm, 0.0)
    assert pin_gap_mm(printed) == pytest.approx(sizes.ear_mm + 2.0 * sizes.clearance_mm + sizes.neck_mm)


def test_that_an_unknown_construction_is_refused() -> None:
    with pytest.raises(UsageError) as refused:
        new_settings({"construction": "woven"})
    assert refused.value.code == "settings.no_such_choice"
