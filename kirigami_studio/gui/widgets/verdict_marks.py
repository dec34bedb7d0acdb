"""Icon and colour of a verdict wherever it is shown, pale for an estimate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kirigami_studio.gui.widgets.theme import Palette

if TYPE_CHECKING:
    from kirigami_studio.studio.verdict import Verdict

#: Icon of each level, by its name in JSON, and of what nobody has checked so far.
ICONS = {"ready_to_cut": "check", "cut_with_care": "warning", "will_not_work": "fault", "": "info"}
#: Opacity of the mark of an estimate.
PALE = 0.55
#: Stands before the words of an estimate where there is no room for more.
ABOUT = "\N{ALMOST EQUAL TO} "


def level_of(verdict: Verdict | None) -> str:
    """The level by its name in JSON, "" for what nobody has checked so far."""
    return "" if verdict is None or not verdict.is_checked else verdict.level.value


def colour_of(level: str, palette: Palette) -> str:
    """The colour of a level by its name in JSON, or of the state of an answer by its own."""
    if level in ("ready_to_cut", "good"):
        return palette.good
    if level in ("will_not_work", "bad"):
        return palette.bad
    return palette.warning if level in ("cut_with_care", "care") else palette.muted
