"""What the window does to Python itself: imports on another thread, garbage and turns, and the types of Qt."""

from __future__ import annotations

import _imp
import contextlib
import gc
import importlib
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

from PySide6.QtCore import QElapsedTimer, QObject, QTimer, Signal

# Python's search for cyclic garbage, done in the window's thread only and when there is time.
#
# Left to itself it runs on whatever thread makes the next object. On the thread of a job it would free widgets there,
# which Qt does not survive, and it would hold the interpreter's lock for as long as the search takes: a tenth of a
# second and more once the numerical libraries are loaded.

INTERVAL_MS = 250
"""While modules are imported 90 000 objects are made in a second, and a search through them takes 40 ms."""

FULL_EVERY = 240
"""Least number of rounds between searches through everything that was made since the last of them; such a search took
75 ms after three plans of 560 views."""


MANY_MODULES = 30
"""New modules from which on they are left out of long searches: with those of the first flight, MAVLink's above all,
the search after it took 179 ms of the window's thread instead of 59 ms, on a busy machine."""


def _never() -> bool:
    return False


class GarbageCollector(QObject):
    """Takes the search over, until `close`.

    What exists when it is made or `freeze` is called, modules above all, is left out from then on: that is most of all
    objects.

    Parameters
    ----------
    is_busy
        While it is, the window must answer at once: long searches wait.
    """

    def __init__(self, parent: QObject | None = None, is_busy: Callable[[], bool] = _never) -> None:
        super().__init__(parent)
        self._is_busy = is_busy
        self._round, self._was_on = 0, gc.isenabled()
        self._n_modules = len(sys.modules)
        # What others left out stays so: Python gives back all or nothing, and a search through all of it takes seconds.
        self._may_leave_out = gc.get_freeze_count() == 0
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._collect)
        gc.disable()
        # The first search would look at all that was imported for the window: 160 ms of the first press on it.
        self.freeze()
        self._timer.start(INTERVAL_MS)

    def freeze(self) -> None:
        """What has been imported until now stays."""
        self._n_modules = len(sys.modules)
        if self._may_leave_out:
            gc.freeze()

    def close(self) -> None:
        """Leave the search as it was."""
        self._timer.stop()
        if self._may_leave_out:
            gc.unfreeze()
        if self._was_on:
            gc.enable()

    def _collect(self) -> None:
        self._round += 1
        if len(sys.modules) - self._n_modules >= MANY_MODULES:
            gc.collect(1)
            self.freeze()
        elif self._round >= FULL_EVERY and not self._is_busy():
            self._round = 0
            gc.collect()
            self.freeze()
        elif gc.get_count()[0] > gc.get_threshold()[0]:
            # What outlives a round waits for the next long search: rounds that look at it again, as Python's own do,
            # took up to 40 ms once a plan was there.
            gc.collect(1)


LOOK_MS = 10
"""How often it is looked what has been imported. The thread tells nobody itself: its listener may be gone by then."""


BUSY_S, REST_S, MOST_RESTS = 0.03, 0.005, 20
"""The window is busy where it has not looked for so long. Then the thread that imports rests before each module, as
long as the window is busy, and no more often than so: a page was made in 100 ms instead of 220 ms beside it."""


@contextlib.contextmanager
def _lock_of_imports_let_go() -> Iterator[None]:
    """Python asks where a module is under one lock for all threads: let others import meanwhile."""
    try:
        _imp.release_lock()
    except RuntimeError:
        # Asked by somebody else than Python's own import, who holds nothing.
        yield
        return
    try:
        yield
    finally:
        _imp.acquire_lock()


class _GiveWay:
    """Asked by Python for each module that it imports; finds none, and rests on the one thread while others are busy.

    Parameters
    ----------
    is_busy
        Whether somebody else wants the interpreter more.
    """

    def __init__(self, is_busy: Callable[[], bool]) -> None:
        self._is_busy, self._thread = is_busy, threading.get_ident()

    def find_spec(self, _name: str, _path: object = None, _target: object = None) -> None:
        """Nothing: those that come after find it."""
        if threading.get_ident() == self._thread and self._is_busy():
            with _lock_of_imports_let_go():
                for _ in range(MOST_RESTS):
                    time.sleep(REST_S)
                    if not self._is_busy():
                        break


def _waits_for_import(thread: int) -> bool:
    """Whether a thread is waiting for a module that another one is importing.

    Its stack says so, too, but who looks at a stack holds it for a moment: what a function of it has made, such
    as a painter of a widget, then outlives the function, and Qt paints into nothing.
    """
    return bool(getattr(importlib._bootstrap, "_blocking_on", {}).get(thread))


class BackgroundImport(QObject):
    """Imports modules one after the other, with many rests while the thread that made it is busy.

    Signals
    -------
    imported(str)
        Name of a module, in the order asked for, in the window's thread. Also for one that failed: whoever imports it
        again gets the error.
    """

    imported = Signal(str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._waiting: list[str] = []
        self._done: list[str] = []
        self._lock, self._is_importing = threading.Lock(), False
        self._urgent = ""
        self._told = 0
        self._looked_s = time.perf_counter()
        self._window = threading.get_ident()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)

    def add(self, *modules: str) -> None:
        """Import these, too, after those that were asked for before: one at a time, for some need each other."""
        with self._lock:
            self._waiting += modules
            is_new, self._is_importing = not self._is_importing, True
        if is_new:
            threading.Thread(target=self._import, name="import", daemon=True).start()
        self._timer.start(LOOK_MS)

    def hurry(self, module: str) -> None:
        """Import one before the others that are not begun, and without rests: the window has nothing else to do."""
        self._urgent = module
        with self._lock:
            self._waiting.sort(key=lambda each: each != module)

    def _import(self) -> None:
        gives_way: Any = _GiveWay(self._is_busy)
        sys.meta_path.insert(0, gives_way)
        while (module := self._next()) is not None:
            # Whoever imports it again, in the window's thread, gets the error and can tell it.
            with contextlib.suppress(Exception):
                importlib.import_module(module)
            self._done.append(module)
        # Another list: a thread that is going through this one would miss whoever moved up.
        sys.meta_path = [each for each in sys.meta_path if each is not gives_way]

    def _next(self) -> str | None:
        with self._lock:
            self._is_importing = bool(self._waiting)
            return self._waiting.pop(0) if self._waiting else None

    def _is_busy(self) -> bool:
        is_late = not self._urgent and time.perf_counter() - self._looked_s > BUSY_S
        return is_late and not _waits_for_import(self._window)

    def _look(self) -> None:
        self._looked_s = time.perf_counter()
        while self._told < len(self._done):
            module = self._done[self._told]
            self._told += 1
            if module == self._urgent:
                self._urgent = ""
            self.imported.emit(module)
        if not self._is_importing and self._told == len(self._done):
            self._timer.stop()


SWITCH_S = 0.001
"""For which a thread may keep the interpreter while others wait. The window's thread gives it up in many calls of Qt,
and then waits so long for each: with Python's own 5 ms a page of widgets took three times its own time to make while
modules were imported on another thread."""


def take_short_turns() -> None:
    """Let threads take turns often, so that the window's thread gets its own soon."""
    sys.setswitchinterval(SWITCH_S)


N_SPARE_TYPES = 1800
"""Types that make the table of PySide large enough for all others: 681 there are by then, and some 500 are to come.

With these there are some 2500, for which tables of all three C++ libraries have room for 3000 and more. They take 45 ms
and 4 MB."""

_spare_types: list[type] = []


def make_types_of_qt() -> None:
    """Have all types of Qt's modules that are imported by now made on this thread, before there are others.

    PySide makes a type when it is first asked for, and is not made for two threads that ask: they leave its table of
    types that are to be made damaged, and the process ends with a segmentation fault. While the thread that imports
    asked for all of them, for the 3-D view, the window's thread made those of its events and widgets. There are some
    450 left once the window is made, which take 90 ms here instead of over there.

    With Python before 3.12 PySide keeps what it knows of a type in a hash table, in which Qt looks widgets up without
    the interpreter's lock. A class that another thread makes may have the table grow meanwhile, from 1109 to 2357
    places at the last tabs, and the process ends, too: spare types make it grow here.
    """
    for name, module in tuple(sys.modules.items()):
        if name.startswith("PySide6.Qt"):
            for each in dir(module):
                getattr(module, each)
    if sys.version_info < (3, 12) and not _spare_types:
        _spare_types.extend(type("Spare", (QElapsedTimer,), {}) for _ in range(N_SPARE_TYPES))


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
