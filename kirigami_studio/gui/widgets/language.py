"""The language of the window: the desktop's or a chosen one, for words, numbers and Qt's own texts."""

from __future__ import annotations

import os

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QLocale, QTranslator

from kirigami_studio.foundation import words

#: The preferred language that follows the desktop.
SYSTEM = "system"
#: What each language calls itself.
NAMES = {"en": "English", "de": "Deutsch"}
#: Name of Qt's translator among the application's children.
TRANSLATOR = "qtTranslator"


def speak(preferred: str) -> None:
    """Choose the language, "system" or a code, of what is written from now on; open windows keep theirs."""
    desktop = QLocale.system()
    os.environ.pop(words.LANGUAGE_VARIABLE, None)
    if preferred == SYSTEM:
        locale = desktop
        words.choose(*(words.environment_languages() or desktop.uiLanguages()), decimal=desktop.decimalPoint())
    else:
        chosen = QLocale(preferred)
        locale = desktop if desktop.language() == chosen.language() else chosen  # which may be another country's
        # Processes that are started speak it too.
        os.environ[words.LANGUAGE_VARIABLE] = words.choose(preferred, decimal=locale.decimalPoint())
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
