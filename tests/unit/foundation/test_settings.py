"""Settings: which values fit, what a refusal says, and that those who share a setting refuse alike."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from enum import StrEnum

import pytest

from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.errors import FabricationError, KirigamiError
from kirigami_studio.foundation.settings import NamedSetting, Setting, check, settings_of
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.request import Request
from kirigami_studio.settings.design import DesignChoices, DesignSettings, chosen_settings
from kirigami_studio.settings.fabrication import FabricationSettings


class Colour(StrEnum):
    RED = "red"
    BLUE = "blue"


@dataclass(frozen=True, slots=True)
class Sample:
    count: int = field(default=1, metadata=Setting(least=0, most=3).metadata)
    share: float = field(default=0.5, metadata=Setting(least=0.0, most=1.0, above_least=True, below_most=True).metadata)
    length: float | None = field(default=None, metadata=Setting(least=0.0, error=FabricationError).metadata)
    colour: Colour = field(default=Colour.RED, metadata=Setting(code="settings.no_such_choice").metadata)
    name: str = field(default="a", metadata=Setting().metadata)
    note: str = field(default="", metadata=Setting(may_be_empty=True).metadata)
    on: bool = field(default=False, metadata=Setting().metadata)
    free: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        check(self)


@pytest.mark.parametrize(
    "changes",
    [
        {"count": -1}, {"count": 4}, {"count": 1.0}, {"count": True}, {"count": "1"}, {"count": None},
        {"share": 0.0}, {"share": 1.0}, {"share": math.nan}, {"share": math.inf}, {"share": False},
        {"length": -0.1}, {"length": "long"}, {"colour": "green"}, {"colour": None},
        {"name": ""}, {"name": 3}, {"note": None}, {"on": 1}, {"on": "yes"},
    ],
)  # fmt: skip
def test_that_a_value_that_does_not_fit_is_refused_with_its_name(changes: dict[str, object]) -> None:
    ((name, value),) = changes.items()
    with pytest.raises(KirigamiError) as caught:
        Sample(**changes)  # type: ignore[arg-type]
    assert caught.value.fields["name"] == name and caught.value.fields["value"] is value
    assert name in str(caught.value)
    assert isinstance(caught.value, FabricationError) == (name == "length")


@pytest.mark.parametrize(
    "changes",
    [{"count": 0}, {"count": 3}, {"share": 1e-9}, {"length": 0}, {"length": None}, {"note": ""}, {"on": True}],
)
def test_that_a_value_that_fits_stays_as_it_is(changes: dict[str, object]) -> None:
    ((name, value),) = changes.items()
    assert getattr(Sample(**changes), name) is value  # type: ignore[arg-type]


def test_that_a_choice_is_read_by_its_word_and_a_refusal_lists_them_all() -> None:
    assert Sample(colour="blue").colour is Colour.BLUE  # type: ignore[arg-type]
    with pytest.raises(KirigamiError, match=r"no colour 'green'\. Choose one of red, blue"):
        Sample(colour="green")  # type: ignore[arg-type]


def test_that_settings_come_in_the_order_of_their_fields_with_kind_and_default() -> None:
    found = settings_of(Sample)
    assert list(found) == ["count", "share", "length", "colour", "name", "note", "on"]
    assert (found["length"].kind, found["length"].optional, found["length"].default) == (float, True, None)
    assert found["colour"].kind is Colour and found["colour"].default is Colour.RED


def test_that_the_window_s_range_is_that_of_the_setting_in_what_is_shown() -> None:
    one = NamedSetting("angle", float, False, 0.0, Setting(least=0.0, most=math.pi, scale=180.0 / math.pi, high=179.0))
    assert one.numbers == {"least": 0.0, "most": math.pi, "low": 0.0, "high": 179.0}
    assert replace(one, setting=Setting(least=1, most=9)).numbers == {"least": 1, "most": 9, "low": 1, "high": 9}


def refusal(make: object, name: str, value: object) -> tuple[type, str, str]:
    with pytest.raises(KirigamiError) as caught:
        make(**{name: value})  # type: ignore[operator]
    return type(caught.value), caught.value.code, str(caught.value)


@pytest.mark.parametrize("name", [name for name, one in settings_of(DesignChoices).items() if one.is_plain])
def test_that_project_settings_and_requests_refuse_alike(name: str) -> None:
    one = settings_of(DesignChoices)[name]
    wrong: list[object] = [None, (), "" if one.kind is str else "no such value"]
    for end, step in ((one.setting.least, -1), (one.setting.most, 1)):
        wrong += [] if end is None else [one.kind(end + step)]

    def request(**changes: object) -> Request:
        return Request(load("circle"), (4, 4), **changes)  # type: ignore[arg-type]

    for value in wrong:
        assert refusal(DesignSettings, name, value) == refusal(request, name, value)
    assert getattr(request(), name) == getattr(DesignSettings(), name) == one.default


def test_that_a_request_of_settings_gives_them_back() -> None:
    fixed = chosen_settings((5, 6), {"k": 4, "prefer": "calm", "symmetry": "none"}, start=DesignSettings().start)
    assert (fixed.regular, fixed.auto_grid, fixed.grid) == (1.0, False, (5, 6))
    assert Request.of(load("circle"), fixed).settings == fixed
    free = chosen_settings(None, {"regular": 0.2, "prefer": "calm"})
    asked = Request.of(load("circle"), free)
    assert asked.grid is None and asked.regular == 0.2
    assert asked.resolved(free.grid).settings == free


def test_that_a_cut_has_one_set_of_usual_options() -> None:
    assert CutOptions() == FabricationSettings().options
