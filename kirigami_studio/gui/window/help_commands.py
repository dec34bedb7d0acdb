"""The Help menu: the guide, the keys, the tour, the sample, the licences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


def commands(window: MainWindow) -> tuple[Command, ...]:
    """Return the commands of the Help menu."""
    dialogs, menu = window.dialogs, tr("&Help")
    return (
        Command(
            "guide", menu, tr("&Guide"), tr("Open the user guide"), dialogs.show_guide, shortcuts=("F1",), icon="guide"
        ),
        Command(
            "shortcuts",
            menu,
            tr("&Keyboard shortcuts"),
            tr("Search all keys and gestures"),
            dialogs.show_shortcuts,
            shortcuts=("?", "Ctrl+/"),
        ),
        Command(
            "tour",
            menu,
            tr("&Tour"),
            tr("Take a six-step tour"),
            lambda: window.tour.start(),
            gap=True,
        ),
        Command(
            "sample",
            menu,
            tr("Open &sample project"),
            tr("Open a sample project with heart designs"),
            window.files.open_sample,
        ),
        Command(
            "about",
            menu,
            tr("&About Kirigami Studio"),
            tr("Version and licences of the program and of what comes with it"),
            dialogs.show_about,
            gap=True,
        ),
    )
