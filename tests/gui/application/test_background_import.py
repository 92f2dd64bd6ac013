"""Modules are imported on another thread, which rests while the window is busy."""

import sys
import threading

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
    loading = BackgroundImport(names)
    loading.imported.connect(told.append)
    loading.start()
    turn_until(application, lambda: told == names)
    assert sys.meta_path == before


def test_a_window_that_waits_for_a_module_is_not_made_to_wait_longer():
    held, waiting = threading.Event(), threading.Event()
    module = "a_module_that_takes_long"

    class Slow:
        def find_spec(self, name, _path=None, _target=None):
            if name == module:
                waiting.set()
                held.wait(20.0)

    slow = Slow()
    sys.meta_path.insert(0, slow)
    try:
        threads = [threading.Thread(target=_import, args=(module,)) for _ in range(2)]
        for thread in threads:
            thread.start()
            waiting.wait(20.0)
        while not interpreter._waits_for_import(threads[1].ident):
            assert threads[1].is_alive()
        assert not interpreter._waits_for_import(threading.get_ident())
    finally:
        held.set()
        sys.meta_path.remove(slow)
        for thread in threads:
            thread.join()


def _import(name):
    try:
        __import__(name)
    except ImportError:
        return
