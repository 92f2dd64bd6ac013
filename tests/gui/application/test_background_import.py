"""Modules are imported on another thread, which rests while the window is busy."""

import contextlib
import importlib
import subprocess
import sys
import threading

import pytest

from groundstation.gui.application import interpreter
from groundstation.gui.application.interpreter import MOST_RESTS, BackgroundImport, _GiveWay
from tests.gui.driving import turn_until


def test_the_thread_that_imports_rests_while_the_window_is_busy_and_no_longer_than_so(monkeypatch):
    rests = []
    monkeypatch.setattr(interpreter.time, "sleep", rests.append)
    _GiveWay(lambda: False).find_spec("json")
    assert not rests
    _GiveWay(lambda: True).find_spec("json")
    assert len(rests) == MOST_RESTS
    _GiveWay(lambda: len(rests) < MOST_RESTS + 3).find_spec("json")
    assert len(rests) == MOST_RESTS + 3


def test_other_threads_import_at_once(monkeypatch):
    rests = []
    monkeypatch.setattr(interpreter.time, "sleep", rests.append)
    gives_way = _GiveWay(lambda: True)
    other = threading.Thread(target=gives_way.find_spec, args=("json",))
    other.start()
    other.join()
    assert not rests


def test_all_modules_are_told_of_in_order_and_python_searches_as_before(application):
    before, told = list(sys.meta_path), []
    names = ["colorsys", "no_such_module_at_all", "this_is_none_either"]
    loading = BackgroundImport()
    loading.imported.connect(told.append)
    loading.add(*names)
    turn_until(application, lambda: told == names)
    loading.add("quopri")
    turn_until(application, lambda: told == [*names, "quopri"])
    turn_until(application, lambda: sys.meta_path == before)


def test_a_thread_that_is_asking_for_a_module_meanwhile_asks_everybody(application, modules_that_wait):
    module, running, held = modules_that_wait
    before, told = list(sys.meta_path), []
    loading = BackgroundImport()
    loading.imported.connect(told.append)
    loading.add(module)
    assert running.wait(20.0)
    asked = iter(sys.meta_path)
    assert isinstance(next(asked), _GiveWay)
    held.set()
    turn_until(application, lambda: told == [module] and sys.meta_path == before)
    assert list(asked) == before


def test_what_is_wanted_now_is_imported_before_what_waits(application, modules_that_wait):
    module, running, held = modules_that_wait
    loading, told = BackgroundImport(), []
    loading.imported.connect(told.append)
    loading.add(module, "colorsys", "quopri")
    assert running.wait(20.0)
    loading.hurry("quopri")
    held.set()
    turn_until(application, lambda: told == [module, "quopri", "colorsys"])


def test_others_import_while_the_thread_rests():
    """Python asks for modules under one lock: resting with it would hold up whatever the window imports."""
    done = threading.Event()
    rested = []

    def others_import():
        if not rested:
            rested.append(True)
            threading.Thread(target=lambda: (_import("no_such_module_for_others"), done.set())).start()
        return not done.is_set()

    def work():
        gives_way = _GiveWay(others_import)
        sys.meta_path.insert(0, gives_way)
        _import("no_such_module_for_the_thread")
        sys.meta_path.remove(gives_way)
        rested.append(done.is_set())

    importing = threading.Thread(target=work)
    importing.start()
    importing.join()
    assert rested == [True, True]


def test_a_window_that_waits_for_a_module_is_not_made_to_wait_longer(modules_that_wait):
    module, running, held = modules_that_wait
    threads = [threading.Thread(target=_import, args=(module,)) for _ in range(2)]
    threads[0].start()
    assert running.wait(20.0)
    threads[1].start()
    while not interpreter._waits_for_import(threads[1].ident):
        assert threads[1].is_alive()
    assert not interpreter._waits_for_import(threading.get_ident())
    held.set()
    for thread in threads:
        thread.join()


@pytest.fixture
def modules_that_wait(tmp_path, monkeypatch):
    """A module that, while it is imported, says so and waits until it is let go: its name and the two events."""
    name = "a_module_that_takes_long"
    running, held = threading.Event(), threading.Event()
    (tmp_path / f"{name}.py").write_text("import sys\nsys.running.set()\nsys.held.wait(60.0)\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "running", running, raising=False)
    monkeypatch.setattr(sys, "held", held, raising=False)
    yield name, running, held
    held.set()
    sys.modules.pop(name, None)


def _import(name):
    with contextlib.suppress(ImportError):
        importlib.import_module(name)


ALL_TYPES = """
import importlib, pkgutil
from shiboken6 import Shiboken
import groundstation.gui.window.project_controller
from groundstation.gui.application.interpreter import make_types_of_qt

def n_types():
    found, waiting = set(), [Shiboken.Object]
    while waiting:
        new = set(type.__subclasses__(waiting.pop())) - found
        found |= new
        waiting += new
    return len(found)

make_types_of_qt()
at_start = n_types()
for module in pkgutil.walk_packages(groundstation.gui.__path__, "groundstation.gui."):
    importlib.import_module(module.name)
print(at_start, n_types())
"""


@pytest.mark.long
@pytest.mark.skipif(sys.version_info >= (3, 12), reason="PySide keeps what it knows of types otherwise")
def test_no_table_of_types_grows_beside_the_window():
    done = subprocess.run([sys.executable, "-c", ALL_TYPES], capture_output=True, text=True, check=True)
    at_start, at_end = map(int, done.stdout.split())
    # Where tables of libstdc++, libc++ and Microsoft's library have grown before, and where they do next.
    assert max(2357, 1597, 2048) < at_start < at_end < min(5087, 3203, 4096)
