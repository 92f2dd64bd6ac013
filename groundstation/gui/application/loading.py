"""Imports what takes long on another thread, so that the window is painted and answers meanwhile."""

from __future__ import annotations

import contextlib
import importlib
import sys
import threading
from collections.abc import Sequence

from PySide6.QtCore import QObject, QTimer, Signal

LOOK_MS = 10
"""How often it is looked what has been imported. The thread tells nobody itself: its listener may be gone by then."""


class BackgroundImport(QObject):
    """Imports modules one after the other.

    Signals
    -------
    imported(str)
        Name of a module, in the order asked for, in the window's thread. Also for one that failed: whoever imports it
        again gets the error.
    """

    imported = Signal(str)

    def __init__(self, modules: Sequence[str], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._modules = tuple(modules)
        self._done: list[str] = []
        self._told = 0
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)

    def start(self) -> None:
        """Begin."""
        modules, done = self._modules, self._done

        def work() -> None:
            for module in modules:
                # Whoever imports it again, in the window's thread, gets the error and can tell it.
                with contextlib.suppress(Exception):
                    importlib.import_module(module)
                done.append(module)

        threading.Thread(target=work, name="import", daemon=True).start()
        self._timer.start(LOOK_MS)

    def _look(self) -> None:
        while self._told < len(self._done):
            self._told += 1
            self.imported.emit(self._done[self._told - 1])
        if self._told == len(self._modules):
            self._timer.stop()


def leave_modules_alone() -> None:
    """Keep Qt's Python from reading the source of every module that is imported after it.

    It looks for modules that ask for its own other spellings, which none of ours does. Looking, it asks modules for
    attributes while they are half imported: pydantic, which comes with Open3D, then fails, and with it the first
    coverage or flight that wants rays. Only what it finds the spellings by is replaced; where that is called otherwise,
    nothing is done.
    """
    feature = sys.modules.get("shibokensupport.feature")
    if feature is not None and hasattr(feature, "_mod_uses_pyside"):
        vars(feature)["_mod_uses_pyside"] = lambda _module: False
