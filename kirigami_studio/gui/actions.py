"""Every command of the window in one table: name, text, icon, shortcut, menu and tooltip."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.theme import Palette


@dataclass(frozen=True, slots=True)
class Command:
    """One row of the table.

    Attributes
    ----------
    name : str
        Key by which the window connects it.
    text : str
        As in the menu, ``&`` before the mnemonic.
    menu : str
        Menu it stands in.
    shortcuts : tuple of str
        Key sequences, the first is shown.
    icon : str
        Bundled icon, or "" for none.
    tip : str
    toolbar : bool
    checkable : bool
    gap : bool
        A separator comes before it.
    """

    name: str
    text: str
    menu: str
    shortcuts: tuple[str, ...] = ()
    icon: str = ""
    tip: str = ""
    toolbar: bool = False
    checkable: bool = False
    gap: bool = False


COMMANDS = (
    Command("new", tr("&New project"), tr("&File"), ("Ctrl+N",), tip=tr("Start an empty project")),
    Command(
        "open_project",
        tr("Open &project …"),
        tr("&File"),
        ("Ctrl+Shift+O",),
        "project",
        tr("Open a .kiri project"),
        True,
    ),
    Command("save", tr("&Save project"), tr("&File"), ("Ctrl+S",), "save", tr("Save the project"), True),
    Command(
        "save_as",
        tr("Save project &as …"),
        tr("&File"),
        ("Ctrl+Shift+S",),
        tip=tr("Save the project under another name"),
    ),
    Command(
        "open_target", tr("&Open target …"), tr("&File"), ("Ctrl+O",), "open", tr("Open a target silhouette"), gap=True
    ),
    Command(
        "library",
        tr("Target &library …"),
        tr("&File"),
        ("Ctrl+L",),
        "library",
        tr("Choose a silhouette from the library"),
    ),
    Command(
        "export",
        tr("Export &DXF …"),
        tr("&File"),
        ("Ctrl+E",),
        "export",
        tr("Export a cut file in mm, or a picture"),
        gap=True,
    ),
    Command(
        "export_all",
        tr("Export &everything …"),
        tr("&File"),
        ("Ctrl+Shift+E",),
        "",
        tr("Export every file type to one folder"),
    ),
    Command("animation", tr("Export an&imation …"), tr("&File"), (), "", tr("Export the deployment as a looping GIF")),
    Command("quit", tr("&Quit"), tr("&File"), ("Ctrl+Q",), tip=tr("Close Kirigami Studio"), gap=True),
    Command("undo", tr("&Undo"), tr("&Edit"), ("Ctrl+Z",), "undo", tr("Undo"), True),
    Command("redo", tr("&Redo"), tr("&Edit"), ("Ctrl+Y", "Ctrl+Shift+Z"), "redo", tr("Redo"), True),
    Command("history", tr("&History …"), tr("&Edit"), ("Ctrl+Shift+H",), tip=tr("List all steps and jump to one")),
    Command(
        "paste",
        tr("&Paste target"),
        tr("&Edit"),
        ("Ctrl+V",),
        "",
        tr("Paste a picture, SVG or path as the target"),
        gap=True,
    ),
    Command(
        "copy_picture", tr("&Copy picture"), tr("&Edit"), ("Ctrl+Shift+C",), "", tr("Copy a picture of the active view")
    ),
    Command(
        "copy_cuts", tr("Copy cuts as S&VG"), tr("&Edit"), ("Ctrl+Alt+C",), "", tr("Copy the cut plan as SVG in mm")
    ),
    Command("clear", tr("Clear tar&get"), tr("&Edit"), (), "clear", tr("Remove the target")),
    Command("edit_target", tr("&Edit target"), tr("D&raw"), ("E",), "edit", tr("Open or leave the drawing board")),
    Command("points", tr("Move &points"), tr("D&raw"), ("N",), "points", tr("Drag the target's points"), gap=True),
    Command(
        "pose", tr("&Move, resize and rotate"), tr("D&raw"), ("V",), "pose", tr("Move, resize and rotate the target")
    ),
    Command("freehand", tr("&Freehand"), tr("D&raw"), ("D",), "draw", tr("Draw the target in one stroke"), gap=True),
    Command("polygon", tr("P&olygon"), tr("D&raw"), ("P",), "polygon", tr("Draw the target corner by corner")),
    Command("rectangle", tr("Rec&tangle"), tr("D&raw"), ("R",), "rectangle", tr("Draw a rectangle")),
    Command("ellipse", tr("E&llipse"), tr("D&raw"), ("O",), "ellipse", tr("Draw an ellipse or a circle")),
    Command("regular", tr("Re&gular polygon"), tr("D&raw"), ("G",), "regular", tr("Draw a regular polygon")),
    Command("star", tr("&Star"), tr("D&raw"), ("S",), "star", tr("Draw a star")),
    Command("text", tr("Te&xt"), tr("D&raw"), ("X",), "text", tr("Draw letters joined into one piece")),
    Command(
        "mode_new",
        tr("&New shape"),
        tr("D&raw"),
        ("=",),
        "replace",
        tr("Replace the target with the next shape"),
        gap=True,
    ),
    Command("mode_add", tr("&Add shape"), tr("D&raw"), ("+",), "add", tr("Add the next shape to the target")),
    Command(
        "mode_subtract",
        tr("Su&btract shape"),
        tr("D&raw"),
        ("-",),
        "subtract",
        tr("Cut the next shape out of the target"),
    ),
    Command(
        "axis",
        tr("M&irror while drawing"),
        tr("D&raw"),
        ("Shift+M",),
        "axis-upright",
        tr("Switch to the next mirror axis"),
        gap=True,
    ),
    Command("grid", tr("Snap to g&rid"), tr("D&raw"), ("Ctrl+Shift+G",), "grid", tr("Show the grid and snap to it")),
    Command(
        "generate",
        tr("&Generate"),
        tr("&Design"),
        ("Ctrl+G", "Ctrl+Return"),
        "generate",
        tr("Design sheets for the target"),
    ),
    Command("cancel", tr("&Cancel"), tr("&Design"), ("Esc",), "stop", tr("Stop generating, trimming or fitting")),
    Command(
        "trim",
        tr("&Trim to target"),
        tr("&Design"),
        ("Ctrl+T",),
        "trim",
        tr("Cut the edge panels along the target"),
        False,
        True,
        True,
    ),
    Command(
        "hand", tr("Edit by &hand"), tr("&Design"), ("H",), "hand", tr("Edit voids and outline by hand"), False, True
    ),
    Command("lock", tr("&Lock voids"), tr("&Design"), ("L",), "lock", tr("Lock or unlock the selected voids")),
    Command("lock_all", tr("Lock all &voids"), tr("&Design"), tip=tr("Lock every void against manual edits")),
    Command("unlock_all", tr("&Unlock all voids"), tr("&Design"), tip=tr("Unlock every void for manual edits")),
    Command(
        "refit", tr("&Fit again"), tr("&Design"), ("Ctrl+F",), "refit", tr("Improve the match from the current design")
    ),
    Command(
        "materials",
        tr("&Materials …"),
        tr("&Design"),
        ("Ctrl+M",),
        "material",
        tr("Copy, edit and calibrate materials"),
    ),
    Command(
        "next", tr("&Next design"), tr("&Design"), ("Ctrl+Down", "PgDown"), "", tr("Choose the next design"), gap=True
    ),
    Command(
        "previous", tr("P&revious design"), tr("&Design"), ("Ctrl+Up", "PgUp"), "", tr("Choose the previous design")
    ),
    Command(
        "again",
        tr("M&ore designs"),
        tr("&Design"),
        ("Ctrl+R",),
        "again",
        tr("Generate more designs from the next seed"),
        gap=True,
    ),
    Command(
        "more_like",
        tr("More li&ke this"),
        tr("&Design"),
        ("Ctrl+Shift+R",),
        "alike",
        tr("Generate more designs like the chosen one"),
    ),
    Command("pin", tr("&Pin design"), tr("&Design"), ("I",), "pin", tr("Pin or unpin the chosen design"), gap=True),
    Command(
        "reject", tr("Re&ject design"), tr("&Design"), (), "reject", tr("Reject the chosen design (Del in the gallery)")
    ),
    Command("play", tr("&Play / pause"), tr("&View"), ("Space",), "play", tr("Play the deployment")),
    Command(
        "slower",
        tr("S&lower"),
        tr("&View"),
        ("<",),
        tip=tr("Play the deployment slower, down to a quarter of normal speed"),
    ),
    Command(
        "faster",
        tr("Fa&ster"),
        tr("&View"),
        (">",),
        tip=tr("Play the deployment faster, up to four times normal speed"),
    ),
    Command(
        "play_mode",
        tr("Next play m&ode"),
        tr("&View"),
        ("Shift+P",),
        tip=tr("Switch between back and forth, loop and once"),
    ),
    Command("to_flat", tr("&Flat sheet (180°)"), tr("&View"), ("Ctrl+Left",), "", tr("Show the sheet flat")),
    Command("to_target", tr("&Target angle"), tr("&View"), ("Ctrl+Right",), "", tr("Show the target angle")),
    Command(
        "show_target",
        tr("Target &outline"),
        tr("&View"),
        ("T",),
        "target",
        tr("Show the target's outline"),
        False,
        True,
        True,
    ),
    Command(
        "show_mismatch",
        tr("&Mismatch"),
        tr("&View"),
        ("M",),
        "mismatch",
        tr("Show missing and extra area"),
        False,
        True,
    ),
    Command(
        "show_faults", tr("F&aults"), tr("&View"), ("F",), "fault", tr("Mark inverted panels and contacts"), False, True
    ),
    Command(
        "show_ratios",
        tr("&Ratio heat map"),
        tr("&View"),
        ("Shift+H",),
        "heat",
        tr("Colour voids by their ratio"),
        False,
        True,
    ),
    Command(
        "show_openings",
        tr("&Void opening"),
        tr("&View"),
        ("Shift+O",),
        "opening",
        tr("Colour voids by their area at this angle, mm²"),
        False,
        True,
    ),
    Command(
        "show_small_parts",
        tr("&Smallest features"),
        tr("&View"),
        ("Shift+T",),
        "small",
        tr("Mark the shortest edges and narrowest necks, in mm between cut centre lines"),
        False,
        True,
    ),
    Command(
        "show_panel_numbers",
        tr("Panel &numbers"),
        tr("&View"),
        ("Shift+I",),
        "numbers",
        tr("Number panels by row and column"),
        False,
        True,
    ),
    Command(
        "show_void_numbers",
        tr("Vo&id numbers"),
        tr("&View"),
        ("Shift+N",),
        "numbers",
        tr("Number voids by row and column"),
        False,
        True,
    ),
    Command("next_fault", tr("Ne&xt fault"), tr("&View"), ("F3",), tip=tr("Zoom to the next fault")),
    Command(
        "previous_fault",
        tr("Previo&us fault"),
        tr("&View"),
        ("Shift+F3",),
        tip=tr("Zoom to the previous fault"),
    ),
    Command(
        "before",
        tr("&Before polish"),
        tr("&View"),
        ("B",),
        "before",
        tr("Show the design before polishing"),
        False,
        True,
        True,
    ),
    Command("cuts", tr("&Cuts"), tr("&View"), ("C",), "cuts", tr("Show the cut plan at kerf width"), False, True),
    Command(
        "plots", tr("P&lots"), tr("&View"), ("J",), "plots", tr("Show match, size and gaps at every angle"), False, True
    ),
    Command(
        "compare",
        tr("Side by &side"),
        tr("&View"),
        ("K",),
        "compare",
        tr("Compare two designs side by side"),
        False,
        True,
    ),
    Command(
        "swap",
        tr("S&wap compared designs"),
        tr("&View"),
        ("Shift+K",),
        "swap",
        tr("Make the compared design the chosen one"),
    ),
    Command("fit", tr("Fit vi&ew"), tr("&View"), ("0",), "fit", tr("Zoom to show everything"), gap=True),
    Command(
        "theme",
        tr("&Dark theme"),
        tr("&View"),
        ("Ctrl+D",),
        "moon",
        tr("Switch between light and dark"),
        True,
        gap=True,
    ),
    Command("theme_system", tr("Follow the s&ystem"), tr("&View"), (), "", tr("Match the system theme"), False, True),
    Command("guide", tr("&Guide"), tr("&Help"), ("F1",), "guide", tr("Open the user guide"), True),
    Command(
        "shortcuts",
        tr("&Keyboard shortcuts"),
        tr("&Help"),
        ("?", "Ctrl+/"),
        "",
        tr("Search all keys and gestures"),
    ),
    Command("tour", tr("&Tour"), tr("&Help"), (), "", tr("Take a six-step tour"), gap=True),
    Command("sample", tr("Open &sample project"), tr("&Help"), (), "", tr("Open a sample project with heart designs")),
)


def build(window: QMainWindow) -> tuple[dict[str, QAction], list[QMenu]]:
    """Create all actions and the window's menus."""
    actions: dict[str, QAction] = {}
    menus: dict[str, QMenu] = {}
    for command in COMMANDS:
        if command.menu not in menus:
            menus[command.menu] = window.menuBar().addMenu(command.menu)
        action = QAction(command.text, window)
        action.setObjectName(command.name)
        action.setCheckable(command.checkable)
        action.setShortcuts([QKeySequence(keys) for keys in command.shortcuts])
        action.setStatusTip(command.tip)
        action.setToolTip(with_shortcut(command.tip, command.shortcuts))
        if command.gap:
            menus[command.menu].addSeparator()
        menus[command.menu].addAction(action)
        window.addAction(action)
        actions[command.name] = action
    return actions, list(menus.values())


def insert_menu(window: QMainWindow, before: str, menu: QMenu) -> None:
    """Put a menu of menus before the command of this name."""
    for action in window.menuBar().actions():
        parent = action.menu()
        if not isinstance(parent, QMenu):
            continue
        place = next((entry for entry in parent.actions() if entry.objectName() == before), None)
        if place is not None:
            parent.insertMenu(place, menu)


def with_shortcut(tip: str, shortcuts: tuple[str, ...]) -> str:
    """Tooltip with its first key sequence."""
    return f"{tip} ({shortcuts[0]})" if shortcuts else tip


def dress(actions: dict[str, QAction], palette: Palette) -> None:
    """Tint all icons."""
    for command in COMMANDS:
        if command.icon:
            actions[command.name].setIcon(icons.icon(command.icon, palette))
    actions["theme"].setText(tr("&Light theme") if palette.dark else tr("&Dark theme"))
    actions["theme"].setIcon(icons.icon("sun" if palette.dark else "moon", palette))
