"""Light or dark: the desktop's theme, or the one that the user has chosen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtGui import QGuiApplication

from kirigami_studio.gui.look import theme
from kirigami_studio.gui.look.preferring import Preferring

if TYPE_CHECKING:
    from kirigami_studio.gui.main_window import MainWindow

SYSTEM = "system"


class Appearance(QObject):
    """Follows the desktop until the user chooses a theme, and again when asked to."""

    def __init__(self, window: MainWindow, preferences: Preferring) -> None:
        super().__init__(window)
        self._window = window
        self._preferences = preferences

    @property
    def follows_system(self) -> bool:
        """Whether the window has the desktop's theme."""
        return self._preferences.present.theme == SYSTEM

    def listen(self) -> None:
        """Change the theme whenever the desktop changes its own, if that is wanted."""
        QGuiApplication.styleHints().colorSchemeChanged.connect(self.refresh)

    def refresh(self) -> None:
        """Show the theme that the preferences ask for."""
        palette = theme.PALETTES.get(self._preferences.present.theme) or theme.system_palette()
        if palette is not self._window.palette_:
            self._window.set_theme(palette)
        self._window.commands.refresh()

    def switch(self) -> None:
        """Change between light and dark; the choice stays until the desktop is to be followed again."""
        self._preferences.choose_theme(theme.LIGHT.name if self._window.palette_.dark else theme.DARK.name)
        self.refresh()

    def follow_system(self) -> None:
        """Follow the desktop's theme, or stop at the present one."""
        self._preferences.choose_theme(self._window.palette_.name if self.follows_system else SYSTEM)
        self.refresh()
