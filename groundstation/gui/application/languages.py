"""The window's language: English in the code, others from Qt Linguist files in `gui/translations`."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QT_TRANSLATE_NOOP, QLibraryInfo, QLocale, QTranslator
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QApplication

from groundstation.services.settings import Language

KEYS_UNNAMED = (QT_TRANSLATE_NOOP("QShortcut", "Return"), QT_TRANSLATE_NOOP("QShortcut", "Enter"))
"""Keys that Qt's own translations leave in English; it looks for their names here first."""

FOLDER = Path(__file__).parents[1] / "translations"


def shown_keys(keys: QKeySequence) -> str:
    """Keys in the user's language, as menus name them."""
    return keys.toString(QKeySequence.SequenceFormat.NativeText)


class Translations:
    """Installs the translators of one language, and takes those of the one before away."""

    def __init__(self, application: QApplication) -> None:
        self._application = application
        self._installed: list[QTranslator] = []
        self._language: Language | None = None

    def use(self, language: Language) -> None:
        """Speak a language from now on; widgets that exist already keep theirs."""
        if language is self._language:
            return
        self.remove()
        self._language = language
        locale = QLocale.system() if language is Language.SYSTEM else QLocale(str(language))
        QLocale.setDefault(locale)
        # Texts of Qt's own dialogs first: the translator installed last is asked first.
        for name, folder in (
            ("qtbase", QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)),
            ("reflight", str(FOLDER)),
        ):
            translator = QTranslator()
            if translator.load(locale, name, "_", folder):
                self._application.installTranslator(translator)
                self._installed.append(translator)

    def remove(self) -> None:
        """Speak English again."""
        self._language = None
        for translator in self._installed:
            self._application.removeTranslator(translator)
        self._installed = []
