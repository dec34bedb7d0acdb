"""Two palettes, one look: every colour of the window and of the drawings comes from here.

Blue is the sheet, orange the target: the pair that people with any colour vision tell apart.  Faults are black on
yellow and carry a shape of their own, so that no meaning rests on colour alone.  Cuts are blue, orange, green-blue and
black (the colours of Okabe and Ito), connectors five shades of purple from narrow to wide.
Side ratios run from blue to orange through the colour of the ground, areas from faint to strong green-blue.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from string import Template
from typing import Any, Protocol, runtime_checkable

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QGuiApplication, QPalette
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.foundation.resources import resource


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours by role, as ``#rrggbb``.

    ``window`` to ``muted`` and the accents are for widgets; ``canvas`` onwards is what the drawing code uses.
    """

    name: str
    window: str
    surface: str
    raised: str
    border: str
    strong_border: str
    text: str
    muted: str
    accent: str
    accent_hover: str
    accent_soft: str
    on_accent: str
    disabled: str
    warning: str
    warning_soft: str
    error_soft: str
    canvas: str
    grid: str
    panel_even: str
    panel_odd: str
    panel_line: str
    target: str
    target_fill: str
    missing: str
    extra: str
    fault: str
    fault_line: str
    cut_sheet: str
    slits: str
    edge_slits: str
    relief: str
    engraved: str
    current_cut: str
    widths: tuple[str, ...]
    diverging: tuple[str, ...]
    sequential: tuple[str, ...]
    good: str
    bad: str

    @property
    def dark(self) -> bool:
        return self.name == "dark"


@runtime_checkable
class Themed(Protocol):
    """A widget with colours of its own; the window gives it the palette of the theme."""

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        ...


def themed(widgets: Iterable[QWidget]) -> Iterator[Themed]:
    """Return those that have colours of their own; only few classes do, and asking is slow, so each is asked once."""
    known: dict[type[QWidget], bool] = {}
    for widget in widgets:
        kind = type(widget)
        if kind not in known:
            known[kind] = issubclass(kind, Themed)
        if known[kind] and isinstance(widget, Themed):
            yield widget


#: Colours by role, light and dark.
COLOURS: dict[str, tuple[Any, Any]] = {
    "window": ("#eceff3", "#13161a"),
    "surface": ("#ffffff", "#1b1f24"),
    "raised": ("#f4f6f9", "#242a31"),
    "border": ("#d9dfe6", "#313942"),
    "strong_border": ("#b9c3ce", "#475260"),
    "text": ("#18202a", "#e8edf2"),
    "muted": ("#566271", "#9dabb8"),
    "accent": ("#0a61b5", "#5aa9f5"),
    "accent_hover": ("#084f96", "#7dbcf8"),
    "accent_soft": ("#e1eefb", "#1a324b"),
    "on_accent": ("#ffffff", "#06131f"),
    "disabled": ("#98a3af", "#66727e"),
    "warning": ("#a34a00", "#ffb066"),
    "warning_soft": ("#fff1df", "#35260f"),
    "error_soft": ("#fdebdc", "#3a2511"),
    "canvas": ("#fbfcfe", "#0f1215"),
    "grid": ("#e6ebf0", "#1c2127"),
    "panel_even": ("#8bb9e6", "#2c669f"),
    "panel_odd": ("#b3d2f1", "#4485c2"),
    "panel_line": ("#2b669f", "#0d1b2a"),
    "target": ("#d4610a", "#ff9d4d"),
    "target_fill": ("#f9dcc2", "#4a2f18"),
    "missing": ("#e8822a", "#ff9d4d"),
    "extra": ("#0c2f5e", "#cfe6ff"),
    "fault": ("#ffd60a", "#ffd60a"),
    "fault_line": ("#14110a", "#14110a"),
    "cut_sheet": ("#e9edf2", "#262d35"),
    "slits": ("#0064a6", "#56b4e9"),
    "edge_slits": ("#c95000", "#f09a3e"),
    "relief": ("#008a66", "#2fc79d"),
    "engraved": ("#b0126a", "#ff8cc6"),
    "current_cut": ("#ffb000", "#ffe14d"),
    "good": ("#177645", "#4fc98f"),
    "bad": ("#b3261e", "#ff8d83"),
}
#: Shades by role, light and dark.
SHADES: dict[str, tuple[Any, Any]] = {
    "widths": (
        ("#4a0d67", "#73308f", "#9a58b3", "#bb85cf", "#d6b0e4"),
        ("#f6dcff", "#dfb2f2", "#c088da", "#9d63ba", "#7a4597"),
    ),
    "diverging": (
        ("#08407e", "#5a9bd5", "#f3f1ec", "#eb9a4a", "#a34300"),
        ("#8fcbff", "#2f7fc4", "#262a30", "#c46a16", "#ffbe78"),
    ),
    "sequential": (
        ("#f1f7f5", "#8fcbb8", "#1f8a6d", "#00463a"),
        ("#16211f", "#1f6b58", "#35b793", "#b5f3df"),
    ),
}


def _palette(name: str, place: int) -> Palette:
    colours: dict[str, Any] = {role: pair[place] for role, pair in (COLOURS | SHADES).items()}
    return Palette(name, **colours)


LIGHT, DARK = _palette("light", 0), _palette("dark", 1)
PALETTES = {palette.name: palette for palette in (LIGHT, DARK)}


def system_palette() -> Palette:
    """Return the palette that fits the desktop's colour scheme; light when it does not say."""
    return DARK if QGuiApplication.styleHints().colorScheme() == Qt.ColorScheme.Dark else LIGHT


def style_sheet(palette: Palette) -> str:
    """Return the bundled style sheet with this palette's colours filled in."""
    template = Template(resource("styles", "studio.qss").read_text(encoding="utf-8"))
    icons = resource("icons").as_posix()
    return template.substitute(asdict(palette), icons=icons)


def apply(application: QApplication, palette: Palette) -> None:
    """Style the whole application with one palette."""
    sheet = style_sheet(palette)
    if application.styleSheet() == sheet:  # setting it again would polish every widget once more, for nothing
        return
    # The style sheet hides the name of the style below it, which was set with the first one.
    if not application.styleSheet() and application.style().objectName() != "fusion":
        application.setStyle("Fusion")
    application.setStyleSheet("")  # over a sheet in place Qt dresses every widget again and again: four times as long
    application.setPalette(_qt_palette(palette))
    application.setStyleSheet(sheet)


def _qt_palette(palette: Palette) -> QPalette:
    roles = QPalette.ColorRole
    colours = {
        roles.Window: palette.window,
        roles.WindowText: palette.text,
        roles.Base: palette.surface,
        roles.AlternateBase: palette.raised,
        roles.Text: palette.text,
        roles.PlaceholderText: palette.muted,
        roles.Button: palette.raised,
        roles.ButtonText: palette.text,
        roles.ToolTipBase: palette.raised,
        roles.ToolTipText: palette.text,
        roles.Highlight: palette.accent,
        roles.HighlightedText: palette.on_accent,
        roles.Link: palette.accent,
    }
    result = QPalette()
    for role, colour in colours.items():
        result.setColor(role, QColor(colour))
    for role in (roles.WindowText, roles.Text, roles.ButtonText):
        result.setColor(QPalette.ColorGroup.Disabled, role, QColor(palette.disabled))
    return result
