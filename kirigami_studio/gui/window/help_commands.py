"""The Help menu: the guide, the keys, the sample, the licences."""

from __future__ import annotations

from collections.abc import Callable

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.window.open_dialogs import Dialogs


def commands(dialogs: Dialogs, open_sample: Callable[[], None]) -> tuple[Command, ...]:
    """Return the commands of the Help menu."""
    menu = tr("&Help")
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
            "sample",
            menu,
            tr("Open &sample project"),
            tr("Open a sample project with heart designs"),
            open_sample,
            gap=True,
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
