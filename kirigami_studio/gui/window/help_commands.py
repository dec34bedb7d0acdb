"""The Help menu: the guide, the keys, the sample, the licences."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.window.open_dialogs import Dialogs


def commands(dialogs: Dialogs, open_sample: Callable[[], None]) -> tuple[Command, ...]:
    """Return the commands of the Help menu."""
    command = partial(Command, tr("&Help"))
    keys, sample = tr("Search all keys and gestures"), tr("Open a sample project with heart designs")
    about = tr("Version and licences of the program and of what comes with it")
    return (
        command("guide", tr("&Guide"), tr("Open the user guide"), dialogs.show_guide, "F1", "guide"),
        command("shortcuts", tr("&Keyboard shortcuts"), keys, dialogs.show_shortcuts, "?; Ctrl+/"),
        command("sample", tr("Open &sample project"), sample, open_sample, gap=True),
        command("about", tr("&About Kirigami Studio"), about, dialogs.show_about, gap=True),
    )
