"""Every command of the window in one table: name, text, icon, shortcut, menu and tooltip."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu

from kirigami_studio.gui import icons
from kirigami_studio.gui.theme import Palette


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
    Command("new", "&New project", "&File", ("Ctrl+N",), tip="Start empty"),
    Command("open_project", "Open &project …", "&File", ("Ctrl+Shift+O",), "project", "Open a .kiri project", True),
    Command("save", "&Save project", "&File", ("Ctrl+S",), "save", "Save the project", True),
    Command("save_as", "Save project &as …", "&File", ("Ctrl+Shift+S",), tip="Save under another name"),
    Command("open_target", "&Open target …", "&File", ("Ctrl+O",), "open", "Open a target silhouette", gap=True),
    Command("library", "Target &library …", "&File", ("Ctrl+L",), "library", "Choose a silhouette of the library"),
    Command(
        "export", "Export &DXF …", "&File", ("Ctrl+E",), "export", "Write the cut file in mm, or a picture", gap=True
    ),
    Command(
        "export_all", "Export &everything …", "&File", ("Ctrl+Shift+E",), "", "Write every kind of file into one folder"
    ),
    Command("animation", "Export a&nimation …", "&File", (), "", "Write the deployment as a looping GIF"),
    Command("quit", "&Quit", "&File", ("Ctrl+Q",), tip="Close Kirigami Studio", gap=True),
    Command("undo", "&Undo", "&Edit", ("Ctrl+Z",), "undo", "Undo", True),
    Command("redo", "&Redo", "&Edit", ("Ctrl+Y", "Ctrl+Shift+Z"), "redo", "Redo", True),
    Command("history", "&History …", "&Edit", ("Ctrl+Shift+H",), tip="List all steps and go to one"),
    Command("paste", "&Paste target", "&Edit", ("Ctrl+V",), "", "Take a picture, SVG or path as target", gap=True),
    Command("copy_picture", "&Copy picture", "&Edit", ("Ctrl+Shift+C",), "", "Copy a picture of the view in use"),
    Command("copy_cuts", "Copy cuts as S&VG", "&Edit", ("Ctrl+Alt+C",), "", "Copy the cut plan as SVG in mm"),
    Command("clear", "&Clear target", "&Edit", (), "clear", "Remove the target"),
    Command("edit_target", "&Edit target", "D&raw", ("E",), "edit", "Open or leave the drawing board"),
    Command("points", "Move &points", "D&raw", ("N",), "points", "Drag the points of the target", gap=True),
    Command("pose", "&Move, resize and rotate", "D&raw", ("V",), "pose", "Move, stretch and turn the target"),
    Command("freehand", "&Freehand", "D&raw", ("D",), "draw", "Draw the target in one stroke", gap=True),
    Command("polygon", "P&olygon", "D&raw", ("P",), "polygon", "Draw the target corner by corner"),
    Command("rectangle", "Rec&tangle", "D&raw", ("R",), "rectangle", "Draw a rectangle"),
    Command("ellipse", "E&llipse", "D&raw", ("O",), "ellipse", "Draw an ellipse or a circle"),
    Command("regular", "Re&gular polygon", "D&raw", ("G",), "regular", "Draw a regular polygon"),
    Command("star", "&Star", "D&raw", ("S",), "star", "Draw a star"),
    Command("text", "Te&xt", "D&raw", ("X",), "text", "Draw letters that hang together"),
    Command("mode_new", "&New shape", "D&raw", ("=",), "replace", "The next shape replaces the target", gap=True),
    Command("mode_add", "&Add shape", "D&raw", ("+",), "add", "The next shape joins the target"),
    Command("mode_subtract", "Ta&ke away", "D&raw", ("-",), "subtract", "The next shape is cut off the target"),
    Command(
        "axis", "M&irror while drawing", "D&raw", ("Shift+M",), "axis-upright", "Next choice of mirror axes", gap=True
    ),
    Command("grid", "Snap to &grid", "D&raw", ("Ctrl+Shift+G",), "grid", "Show the grid and snap to it"),
    Command("generate", "&Generate", "&Design", ("Ctrl+G", "Ctrl+Return"), "generate", "Design sheets for the target"),
    Command("cancel", "&Cancel", "&Design", ("Esc",), "stop", "Stop generating"),
    Command(
        "trim",
        "&Trim to target",
        "&Design",
        ("Ctrl+T",),
        "trim",
        "Cut the edge panels along the target",
        False,
        True,
        True,
    ),
    Command("hand", "Edit by &hand", "&Design", ("H",), "hand", "Change voids and outline by hand", False, True),
    Command("lock", "&Lock voids", "&Design", ("L",), "lock", "Lock or unlock the selected voids"),
    Command("lock_all", "Lock all &voids", "&Design", tip="No void may be changed by hand"),
    Command("unlock_all", "&Unlock all voids", "&Design", tip="Every void may be changed by hand"),
    Command("refit", "&Fit again", "&Design", ("Ctrl+F",), "refit", "Improve the design from where it is"),
    Command("materials", "&Materials …", "&Design", ("Ctrl+M",), "material", "Copy, change and calibrate materials"),
    Command("next", "&Next design", "&Design", ("Ctrl+Down", "PgDown"), "", "Choose the next design", gap=True),
    Command("previous", "&Previous design", "&Design", ("Ctrl+Up", "PgUp"), "", "Choose the previous design"),
    Command(
        "again", "&More designs", "&Design", ("Ctrl+R",), "again", "Add designs drawn from the next seed", gap=True
    ),
    Command(
        "more_like", "More &like this", "&Design", ("Ctrl+Shift+R",), "alike", "Add designs drawn near the chosen one"
    ),
    Command("pin", "&Pin design", "&Design", ("I",), "pin", "Pin the chosen design, or unpin it", gap=True),
    Command("reject", "Re&ject design", "&Design", (), "reject", "Reject the chosen design (Del in the gallery)"),
    Command("play", "&Play / pause", "&View", ("Space",), "play", "Play the deployment"),
    Command(
        "slower", "S&lower", "&View", ("<",), tip="Play the deployment slower, down to a quarter of the usual speed"
    ),
    Command("faster", "Fa&ster", "&View", (">",), tip="Play the deployment faster, up to four times the usual speed"),
    Command(
        "play_mode", "Play to and fro, in a loop or &once", "&View", ("Shift+P",), tip="Change how playing goes on"
    ),
    Command("to_flat", "&Flat sheet (180°)", "&View", ("Ctrl+Left",), "", "Show the compact sheet"),
    Command("to_target", "&Target angle", "&View", ("Ctrl+Right",), "", "Show the target angle"),
    Command(
        "show_target", "Target &outline", "&View", ("T",), "target", "Show the target's outline", False, True, True
    ),
    Command("show_mismatch", "&Mismatch", "&View", ("M",), "mismatch", "Show missing and extra area", False, True),
    Command("show_faults", "F&aults", "&View", ("F",), "fault", "Mark places that are not physical", False, True),
    Command(
        "show_ratios", "&Ratio heat map", "&View", ("Shift+H",), "heat", "Colour voids by their ratio", False, True
    ),
    Command(
        "show_openings",
        "&Void opening",
        "&View",
        ("Shift+O",),
        "opening",
        "Colour voids by their area at this angle, mm²",
        False,
        True,
    ),
    Command(
        "show_small_parts",
        "&Smallest features",
        "&View",
        ("Shift+T",),
        "small",
        "Mark the shortest panel edges and narrowest necks, mm between the centre lines of the cuts",
        False,
        True,
    ),
    Command("show_panel_numbers", "Panel &numbers", "&View", ("Shift+I",), "numbers", "Row, column", False, True),
    Command("show_void_numbers", "Vo&id numbers", "&View", ("Shift+N",), "numbers", "Row, column", False, True),
    Command("next_fault", "Ne&xt fault", "&View", ("F3",), tip="Bring the next fault to the middle, enlarged"),
    Command("previous_fault", "Previo&us fault", "&View", ("Shift+F3",), tip="Bring the fault before to the middle"),
    Command(
        "before", "&Before polish", "&View", ("B",), "before", "Show the design as it was drawn", False, True, True
    ),
    Command("cuts", "&Cuts", "&View", ("C",), "cuts", "Show the cut plan as it will burn", False, True),
    Command("plots", "P&lots", "&View", ("J",), "plots", "Show match, size and gaps at every angle", False, True),
    Command("compare", "Side by &side", "&View", ("K",), "compare", "Compare two designs side by side", False, True),
    Command("swap", "S&wap compared designs", "&View", ("Shift+K",), "swap", "Choose the design that is compared"),
    Command("fit", "Show &everything", "&View", ("0",), "fit", "Fit the layout into the view", gap=True),
    Command("theme", "&Dark theme", "&View", ("Ctrl+D",), "moon", "Switch between light and dark", True, gap=True),
    Command("theme_system", "Follow the s&ystem", "&View", (), "", "Look as the desktop does", False, True),
    Command("guide", "&Guide", "&Help", ("F1",), "guide", "Open the user guide", True),
    Command("shortcuts", "&Keyboard shortcuts", "&Help", ("?", "Ctrl+/"), "", "List and search all keys and gestures"),
    Command("tour", "&Tour", "&Help", (), "", "Be led through the window in six steps", gap=True),
    Command("sample", "Open &sample project", "&Help", (), "", "Open a project with designs for the heart"),
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
    actions["theme"].setText("&Light theme" if palette.dark else "&Dark theme")
    actions["theme"].setIcon(icons.icon("sun" if palette.dark else "moon", palette))
