"""The Draw menu: the tools of the drawing board and how the next shape joins the target."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from operator import attrgetter

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.target.arrangements import EVERY, Arrangement
from kirigami_studio.gui.target.target_panel import TargetPanel
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.outlines.combining import Combine


def commands(panel: TargetPanel, post: Callable[[Message], None]) -> tuple[Command, ...]:
    """Return the commands of the Draw menu for a drawing board; ``post`` shows refusals."""
    return (_board(panel), *_tools(panel, post), *_modes(panel), *_aids(panel), *_arrangements(panel))


def _board(panel: TargetPanel) -> Command:
    edit = panel.buttons["edit"]
    return Command(
        tr("D&raw"), "edit_target", tr("&Edit target"), tr("Open or leave the drawing board"), edit.click, "E", "edit"
    )


def _tools(panel: TargetPanel, post: Callable[[Message], None]) -> tuple[Command, ...]:
    """A command for each tool, which opens the board."""

    def tool(which: Tool, text: str, key: str, tip: str, icon: str = "", gap: bool = False) -> Command:
        take = partial(_on_tool, panel, post, which)
        return Command(tr("D&raw"), which.value, text, tip, take, key, icon or which.value, gap)

    return (
        tool(Tool.POINTS, tr("Move &points"), "N", tr("Drag the target's points"), gap=True),
        tool(Tool.POSE, tr("&Move, resize and rotate"), "V", tr("Move, resize and rotate the target")),
        tool(Tool.FREEHAND, tr("&Freehand"), "D", tr("Draw the target in one stroke"), "draw", gap=True),
        tool(Tool.POLYGON, tr("Pen"), "P", tr("Draw the target point by point: click corners, drag curves")),
        tool(Tool.RECTANGLE, tr("Rec&tangle"), "R", tr("Draw a rectangle")),
        tool(Tool.ELLIPSE, tr("E&llipse"), "O", tr("Draw an ellipse or a circle")),
        tool(Tool.REGULAR, tr("Re&gular polygon"), "G", tr("Draw a regular polygon")),
        tool(Tool.STAR, tr("&Star"), "S", tr("Draw a star")),
        tool(Tool.TEXT, tr("Te&xt"), "X", tr("Draw letters joined into one piece")),
    )


def _modes(panel: TargetPanel) -> tuple[Command, ...]:
    """How the next shape joins the target; only on the board."""

    def mode(name: str, how: Combine, text: str, key: str, tip: str, icon: str) -> Command:
        take, on_board = partial(_set_mode, panel, how), attrgetter("editing_target")
        return Command(tr("D&raw"), name, text, tip, take, key, icon, how is Combine.NEW, enabled_when=on_board)

    new, join = tr("The next shape is another object"), tr("Add the next shape to the objects it overlaps")
    cut = tr("Cut the next shape out of the objects it overlaps")
    share = tr("Keep of the objects that the next shape overlaps what lies in it")
    return (
        mode("mode_new", Combine.NEW, tr("&New shape"), "Alt+1", new, "replace"),
        mode("mode_add", Combine.ADD, tr("&Add shape"), "Alt+2", join, "add"),
        mode("mode_subtract", Combine.SUBTRACT, tr("Su&btract shape"), "Alt+3", cut, "subtract"),
        mode("mode_intersect", Combine.INTERSECT, tr("Intersect wit&h shape"), "Alt+4", share, "intersect"),
    )


def _aids(panel: TargetPanel) -> tuple[Command, ...]:
    command, cycle = partial(Command, tr("D&raw")), partial(_cycle_axis, panel)
    axis, grid = tr("Switch to the next mirror axis"), tr("Show the grid and snap to it")
    return (
        command("axis", tr("M&irror while drawing"), axis, cycle, "Shift+M", "axis-upright", gap=True),
        command("grid", tr("Snap to g&rid"), grid, panel.tools.grid.click, "Ctrl+Shift+G", "grid"),
    )


def _arrangements(panel: TargetPanel) -> tuple[Command, ...]:
    """The Arrange menu: what can be done with the selected objects."""
    context = panel.view.context

    def command(one: Arrangement) -> Command:
        arrange, possible = partial(context.arrange, one.id), lambda now: one.id in now.arrangements
        return Command(
            tr("&Arrange"), one.id, tr(one.text), tr(one.tip), arrange, one.key, gap=one.gap, enabled_when=possible
        )

    return tuple(command(one) for one in EVERY.values())


def _on_tool(panel: TargetPanel, post: Callable[[Message], None], tool: Tool) -> None:
    if panel.tools.buttons[tool].isEnabled():
        panel.set_tool(tool)
    else:
        sentence = tr("No target to edit yet. Draw or open one first.")
        post(Message(sentence, Tone.HINT))


def _set_mode(panel: TargetPanel, mode: Combine) -> None:
    if panel.tools.modes[mode].isEnabled():
        panel.tools.take_mode(mode)


def _cycle_axis(panel: TargetPanel) -> None:
    panel.set_editing(True)
    panel.tools.axis.cycle()
