"""Start the studio: Qt, window, preferences, first target; then, in the first pause, import the generator."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import platformdirs
from PySide6.QtCore import (
    QCoreApplication,
    QEvent,
    QObject,
    QSettings,
    Qt,
    QTimer,
)
from PySide6.QtGui import QFileOpenEvent, QFont, QFontDatabase, QGuiApplication
from PySide6.QtWidgets import QApplication

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.files.file_dialogs import FileDialogs
from kirigami_studio.gui.widgets import theme
from kirigami_studio.gui.widgets.language import SYSTEM, speak
from kirigami_studio.gui.widgets.uncaught_errors import log_qt_messages, show_uncaught
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.services import Services
from kirigami_studio.project import preferences
from kirigami_studio.studio import importing

FIRST_TARGET = "heart"
PREFERENCES = "preferences.toml"
RECENT = "recent.toml"
RECOVERY = "recovery"
SMALLEST_FONT = 9.5
NO_DISPLAY = mark(
    "No display available. Use the command line (kirigami-studio --help), or run an "
    "off-screen session: {program} -m kirigami_studio.lab.demonstrations.offscreen_session --out "
    "out."
)
#: Python's switch interval in seconds: how long a computing thread may keep the interpreter from the UI thread.
#: With the default of 5 ms the UI froze for 50 to 160 ms while the worker trimmed: a worker that often releases
#: the interpreter wakes the UI thread each time, too late, and the wait starts again.
SWITCH_INTERVAL = 0.0005
#: Where distributions keep fonts; the off-screen platform does not ask fontconfig.
FONT_FOLDERS = ("/usr/share/fonts/truetype/dejavu", "/usr/share/fonts/TTF", "/usr/share/fonts/dejavu")
#: Rest (ms) after which an import disturbs nobody: longer than the pause between two gestures.
REST_MS = 2500
TOUCHES = frozenset(
    {
        QEvent.Type.MouseMove,
        QEvent.Type.MouseButtonPress,
        QEvent.Type.MouseButtonRelease,
        QEvent.Type.KeyPress,
        QEvent.Type.Wheel,
        QEvent.Type.DragMove,
        QEvent.Type.Drop,
        QEvent.Type.Resize,
    }
)


class FileOpening(QObject):
    """Calls ``act`` with each file that the desktop opens in the running program, as macOS does at a double click."""

    def __init__(self, act: Callable[[str], None], parent: QObject) -> None:
        super().__init__(parent)
        self._act = act
        self.opened = False
        application = QCoreApplication.instance()
        if application is not None:
            application.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if isinstance(event, QFileOpenEvent) and event.file():
            self.opened = True
            self._act(event.file())
            return True
        return False


#: What says that somebody works here: until then the window stays small in memory.
ACTS = frozenset({QEvent.Type.MouseButtonPress, QEvent.Type.KeyPress, QEvent.Type.Drop})


class WarmUp(QObject):
    """Calls ``act`` once: in the first pause without input after a button or key was pressed, unless ``busy``."""

    def __init__(
        self, act: Callable[[], None], busy: Callable[[], bool], parent: QObject, rest_ms: int = REST_MS
    ) -> None:
        super().__init__(parent)
        self._act = act
        self._busy = busy
        self._used = False
        self.timer = QTimer(self)
        self.timer.setInterval(rest_ms)
        self.timer.setSingleShot(True)
        self.timer.timeout.connect(self._rested)
        application = QCoreApplication.instance()
        if application is not None:
            application.installEventFilter(self)

    @property
    def waiting(self) -> bool:
        """Whether it waits for a pause."""
        return self.timer.isActive()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        self._used = self._used or event.type() in ACTS
        if self._used and event.type() in TOUCHES:
            self.timer.start()
        return False

    def _rested(self) -> None:
        if self._busy():
            self.timer.start()
            return
        application = QCoreApplication.instance()
        if application is not None:
            application.removeEventFilter(self)
        self._act()


def create_application(argv: list[str]) -> QApplication:
    """Return the application object; the first call makes it."""
    existing = QApplication.instance()
    if isinstance(existing, QApplication):
        return existing
    log_qt_messages()
    sys.setswitchinterval(SWITCH_INTERVAL)
    if os.environ.get("QT_QPA_PLATFORM") == "offscreen" and "QT_QPA_FONTDIR" not in os.environ:
        folder = next((folder for folder in FONT_FOLDERS if Path(folder).is_dir()), None)
        if folder is not None:
            os.environ["QT_QPA_FONTDIR"] = folder
    QCoreApplication.setOrganizationName("Kirigami Studio")
    QCoreApplication.setApplicationName("Kirigami Studio")
    QGuiApplication.setDesktopFileName("kirigami-studio")
    QGuiApplication.setHighDpiScaleFactorRoundingPolicy(Qt.HighDpiScaleFactorRoundingPolicy.PassThrough)
    application = QApplication(argv)
    application.setFont(readable_font(application.font()))
    speak(SYSTEM)
    return application


def readable_font(font: QFont) -> QFont:
    """Return the system's font, or the best one installed when it has none, at a readable size."""
    result = QFont(font)
    if not QFontDatabase.hasFamily(result.family()) or result.family() == "Sans Serif":
        known = ("Inter", "Noto Sans", "Cantarell", "Ubuntu", "DejaVu Sans")
        family = next((name for name in known if QFontDatabase.hasFamily(name)), None)
        if family is not None:
            result.setFamily(family)
    if 0 < result.pointSizeF() < SMALLEST_FONT:
        result.setPointSizeF(SMALLEST_FONT)
    return result


def create_window(
    palette: theme.Palette | None = None, earlier: MainWindow | None = None, file_dialogs: FileDialogs | None = None
) -> MainWindow:
    """Return a new window with its own session, not shown yet; closing it ends its worker.

    It goes on with the project of an ``earlier`` window, which is closed and goes.
    """
    services = Services(earlier=None if earlier is None else earlier.services)
    window = MainWindow(services, palette or theme.system_palette(), file_dialogs)
    services.setParent(window)
    if earlier is not None:
        for keeper in (earlier.services, earlier.pasting):  # of folders with pictures behind targets
            keeper.setParent(services)
        earlier.deleteLater()
        services.session.announce()
    importing.settle()
    return window


def display_present() -> bool:
    """Whether there is a display; without one Qt would end the process."""
    if not sys.platform.startswith("linux") or "QT_QPA_PLATFORM" in os.environ:
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def open_first(window: MainWindow, source: str) -> None:
    """Start with a project, a target file or a library silhouette."""
    if Path(source).suffix.lower() == ".kiri":
        window.services.project.open(Path(source))
    else:
        window.services.targeting.start_with(source)


def preferred_language(path: Path) -> str:
    """The language that the preferences name; a file that cannot be read is spoken of once there is a window."""
    try:
        return preferences.load(path).language
    except KirigamiError:
        return SYSTEM


def run(argv: list[str]) -> int:
    """Open the window and stay until it is closed.

    Parameters
    ----------
    argv : list of str
        Program name, then at most one file: a project, a target or the name of a library silhouette.

    Returns
    -------
    code : int
        Exit code, 0 when the user closed the window, 1 when there is no display to open it on.
    """
    if not display_present():
        program = "kirigami-studio" if getattr(sys, "frozen", False) else "python"
        sys.stderr.write(f"{tr(NO_DISPLAY, program=program)}\n")
        return 1
    application = create_application(argv[:1] or ["kirigami-studio"])
    window = open_window(application)
    opening = FileOpening(window.files.open, window)

    def begin() -> None:
        if not opening.opened:  # else the desktop was faster
            open_first(window, argv[1] if len(argv) > 1 else FIRST_TARGET)

    QTimer.singleShot(0, window, begin)
    QTimer.singleShot(0, window, window.presenters.welcome.begin)
    code = application.exec()
    while window.starts_again:
        window = open_window(application, window)
        FileOpening(window.files.open, window)
        code = application.exec()
    return code


def open_window(application: QApplication, earlier: MainWindow | None = None) -> MainWindow:
    """Show a window in the preferred language, with what is remembered from the last one.

    Parameters
    ----------
    earlier : MainWindow, optional
        A closed one, with whose project it goes on.

    Returns
    -------
    window : MainWindow
    """
    config = platformdirs.user_config_path("kirigami-studio", appauthor=False)
    speak(preferred_language(config / PREFERENCES))
    window = create_window(earlier=earlier)
    services = window.services
    show_uncaught(window.messages.add)
    window.restore(QSettings())
    services.preferences.use(config / PREFERENCES)
    services.project.recent.load(config / RECENT)
    services.project.recovery.use(platformdirs.user_state_path("kirigami-studio", appauthor=False) / RECOVERY)
    application.aboutToQuit.connect(window.remember)
    window.appearance.refresh()
    window.appearance.listen()
    window.show()
    WarmUp(window.presenters.run.warm_up, lambda: services.session.queue.busy, window)
    return window


if __name__ == "__main__":
    sys.exit(run(sys.argv))
