"""The Draw menu: the tools of the drawing board and how the next shape joins the target."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.target.arrangements import EVERY, Arrangement
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.outlines.combining import Combine

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


def commands(window: MainWindow) -> tuple[Command, ...]:
    """Return the commands of the Draw menu."""
    return (_board(window), *_tools(window), *_modes(window), *_aids(window), *_arrangements(window))


def _board(window: MainWindow) -> Command:
    return Command(
        "edit_target",
        tr("D&raw"),
        tr("&Edit target"),
        tr("Open or leave the drawing board"),
        window.target.buttons["edit"].click,
        shortcuts=("E",),
        icon="edit",
    )


def _tools(window: MainWindow) -> tuple[Command, ...]:
    """A command for each tool, which opens the board."""

    def tool(which: Tool, text: str, key: str, tip: str, icon: str = "", gap: bool = False) -> Command:
        take = partial(_take_tool, window, which)
        return Command(which.value, tr("D&raw"), text, tip, take, (key,), icon or which.value, gap)

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


def _modes(window: MainWindow) -> tuple[Command, ...]:
    """How the next shape joins the target; only on the board."""

    def mode(name: str, how: Combine, text: str, key: str, tip: str, icon: str) -> Command:
        return Command(
            name,
            tr("D&raw"),
            text,
            tip,
            partial(_set_mode, window, how),
            (key,),
            icon,
            gap=how is Combine.NEW,
            enabled_when=lambda now: now.editing_target,
        )

    new, join = tr("The next shape is another object"), tr("Add the next shape to the objects it overlaps")
    cut = tr("Cut the next shape out of the objects it overlaps")
    share = tr("Keep of the objects that the next shape overlaps what lies in it")
    return (
        mode("mode_new", Combine.NEW, tr("&New shape"), "Alt+1", new, "replace"),
        mode("mode_add", Combine.ADD, tr("&Add shape"), "Alt+2", join, "add"),
        mode("mode_subtract", Combine.SUBTRACT, tr("Su&btract shape"), "Alt+3", cut, "subtract"),
        mode("mode_intersect", Combine.INTERSECT, tr("Intersect wit&h shape"), "Alt+4", share, "intersect"),
    )


def _aids(window: MainWindow) -> tuple[Command, ...]:
    strip = window.target.tools
    return (
        Command(
            "axis",
            tr("D&raw"),
            tr("M&irror while drawing"),
            tr("Switch to the next mirror axis"),
            partial(_cycle_axis, window),
            shortcuts=("Shift+M",),
            icon="axis-upright",
            gap=True,
        ),
        Command(
            "grid",
            tr("D&raw"),
            tr("Snap to g&rid"),
            tr("Show the grid and snap to it"),
            strip.grid.click,
            shortcuts=("Ctrl+Shift+G",),
            icon="grid",
        ),
    )


def _arrangements(window: MainWindow) -> tuple[Command, ...]:
    """The Arrange menu: what can be done with the selected objects."""
    context = window.target.view.context

    def command(one: Arrangement) -> Command:
        return Command(
            one.id,
            tr("&Arrange"),
            tr(one.text),
            tr(one.tip),
            partial(context.arrange, one.id),
            (one.key,) if one.key else (),
            gap=one.gap,
            enabled_when=lambda now: one.id in now.arrangements,
        )

    return tuple(command(one) for one in EVERY.values())


def _take_tool(window: MainWindow, tool: Tool) -> None:
    if window.target.tools.buttons[tool].isEnabled():
        window.target.set_tool(tool)
    else:
        sentence = tr("No target to edit yet. Draw or open one first.")
        window.messages.add(Message(sentence, Tone.HINT))


def _set_mode(window: MainWindow, mode: Combine) -> None:
    if window.target.tools.modes[mode].isEnabled():
        window.target.tools.set_mode(mode)


def _cycle_axis(window: MainWindow) -> None:
    window.target.set_editing(True)
    window.target.tools.axis.cycle()
