"""The language of the window: the desktop's or a chosen one, changed while it is open.

Nothing is built anew, so nothing is lost: every text that stands in a widget, an action or a list is looked up among
the sentences that the program said (:func:`~kirigami_studio.foundation.words.again`) and said again.  What widgets draw
themselves they say while they draw it; those that keep texts hear of the change by ``LanguageChange``.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import (
    QAbstractItemModel,
    QAbstractListModel,
    QCoreApplication,
    QEvent,
    QLibraryInfo,
    QLocale,
    QModelIndex,
    QObject,
    Qt,
    QTranslator,
    Signal,
)
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QAbstractItemView, QApplication, QComboBox, QLineEdit, QTabBar, QWidget

from kirigami_studio.foundation import words
from kirigami_studio.foundation.words import again

#: The preferred language that follows the desktop.
SYSTEM = "system"
#: What each language calls itself.
NAMES = {"en": "English", "de": "Deutsch"}
#: Properties of widgets and actions that hold what is read.
TEXTS = (
    "text",
    "toolTip",
    "statusTip",
    "whatsThis",
    "accessibleName",
    "accessibleDescription",
    "title",
    "windowTitle",
    "placeholderText",
    "prefix",
    "suffix",
    "specialValueText",
)
#: Roles of what stands in lists and tables.
ROLES = (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.AccessibleTextRole)
#: Name of Qt's translator among the application's children.
TRANSLATOR = "qtTranslator"


def speak(preferred: str) -> None:
    """Say from now on what is said in a language: "system" or a code; Qt's own words and numbers follow it."""
    desktop = QLocale.system()
    if preferred == SYSTEM:
        locale = desktop
        words.choose(*(words.environment_languages() or desktop.uiLanguages()), decimal=desktop.decimalPoint())
    else:
        chosen = QLocale(preferred)
        locale = desktop if desktop.language() == chosen.language() else chosen  # which may be another country's
        os.environ["LANGUAGE"] = words.choose(preferred, decimal=locale.decimalPoint())  # processes that are started
    QLocale.setDefault(locale)
    application = QCoreApplication.instance()
    if application is not None:
        _translate_qt(application, words.language())


def _translate_qt(application: QCoreApplication, language: str) -> None:
    for old in application.findChildren(QTranslator, TRANSLATOR):
        application.removeTranslator(old)
        old.deleteLater()
    translator = QTranslator(application)
    translator.setObjectName(TRANSLATOR)
    if translator.load(f"qtbase_{language}", QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)):
        application.installTranslator(translator)
    else:
        translator.deleteLater()


class Language(QObject):
    """Changes the language of one window and everything that belongs to it."""

    changed = Signal()  #: every text has been said again

    def __init__(self, window: QWidget, reword: Callable[[], None]) -> None:
        super().__init__(window)
        self._window = window
        self._reword = reword
        self._environment = os.environ.get("LANGUAGE")

    def change(self, preferred: str) -> None:
        """Speak another language: "system" or a code."""
        if preferred == SYSTEM:
            os.environ.pop("LANGUAGE", None)
            if self._environment is not None:
                os.environ["LANGUAGE"] = self._environment
        speak(preferred)
        for widget in QApplication.topLevelWidgets():
            widget.setLocale(QLocale())
        say_again(self._window)
        self._reword()
        for widget in QApplication.topLevelWidgets():
            QCoreApplication.sendEvent(widget, QEvent(QEvent.Type.LanguageChange))
            widget.update()
        self.changed.emit()


def say_again(root: QObject) -> None:
    """Say all texts of an object, and of all inside it, in the present language."""
    known: dict[type, tuple[str, ...]] = {}
    for found in (root, *root.findChildren(QWidget), *root.findChildren(QAction)):
        kind = type(found)
        if kind not in known:
            known[kind] = tuple(name for name in TEXTS if found.metaObject().indexOfProperty(name) >= 0)
        for name in known[kind]:
            if not (name == "text" and isinstance(found, QLineEdit)):
                _say_property(found, name)
        if isinstance(found, QTabBar):
            for tab in range(found.count()):
                found.setTabText(tab, again(found.tabText(tab)))
                found.setTabToolTip(tab, again(found.tabToolTip(tab)))
        elif isinstance(found, QAbstractItemView | QComboBox):
            model = found.model()
            if type(model).__module__.startswith("PySide6"):  # those of the program say their texts when asked for them
                _say_headings(model)
                _say_entries(model, found.rootIndex() if isinstance(found, QAbstractItemView) else QModelIndex())


def _say_property(found: QObject, name: str) -> None:
    _say_if_new(found.property(name), lambda text: found.setProperty(name, text))


def _say_if_new(said: object, take: Callable[[str], object]) -> None:
    if isinstance(said, str) and said and (text := again(said)) != said:
        take(text)


def _say_headings(model: QAbstractItemModel) -> None:
    for column in range(_columns(model, QModelIndex())):
        for role in ROLES:
            said = model.headerData(column, Qt.Orientation.Horizontal, role)
            _say_if_new(said, partial(_head, model, column, role))


def _columns(model: QAbstractItemModel, parent: QModelIndex) -> int:
    return 1 if isinstance(model, QAbstractListModel) else model.columnCount(parent)  # which lists keep to themselves


def _head(model: QAbstractItemModel, column: int, role: int, text: str) -> None:
    model.setHeaderData(column, Qt.Orientation.Horizontal, text, role)


def _say_entries(model: QAbstractItemModel, parent: QModelIndex) -> None:
    for row in range(model.rowCount(parent)):
        for column in range(_columns(model, parent)):
            index = model.index(row, column, parent)
            for role in ROLES:
                _say_if_new(model.data(index, role), partial(_enter, model, index, role))
        _say_entries(model, model.index(row, 0, parent))


def _enter(model: QAbstractItemModel, index: QModelIndex, role: int, text: str) -> None:
    model.setData(index, text, role)
