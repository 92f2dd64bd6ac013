"""Cyclic garbage is searched for in the window's thread only, and Python takes the search back afterwards."""

import gc
import threading

import pytest


class Cycle:
    def __init__(self):
        self.me = self


@pytest.fixture
def collections():
    """Threads in which searches ran."""
    threads = []

    def note(phase, _info):
        if phase == "start":
            threads.append(threading.get_ident())

    gc.callbacks.append(note)
    yield threads
    gc.callbacks.remove(note)


def litter(n=5000):
    for _ in range(n):
        Cycle()


def is_searched(thing):
    return any(each is thing for each in gc.get_objects())


def test_a_job_that_makes_garbage_searches_for_none(application, collections):
    from groundstation.gui.application.interpreter import GarbageCollector

    before, often = gc.isenabled(), gc.get_threshold()
    gc.set_threshold(700, 10, 10)
    gc.enable()
    collector = GarbageCollector()
    try:
        collector.freeze()
        collections.clear()  # Python may have searched here before the collector took over
        worker = threading.Thread(target=litter)
        worker.start()
        worker.join()
        assert not collections
        collector._collect()
        assert set(collections) == {threading.get_ident()}
    finally:
        collector.close()
    assert gc.isenabled()
    collections.clear()
    worker = threading.Thread(target=litter)
    worker.start()
    worker.join()
    assert worker.ident in collections, "left to itself, Python searches on any thread"
    gc.set_threshold(*often)
    if not before:
        gc.disable()


def test_what_others_left_out_stays_left_out_and_what_the_window_made_is_freed(application):
    """Python gives back all that was left out at once: a search took 2.5 s after each window of these tests."""
    import weakref

    from groundstation.gui.application.interpreter import GarbageCollector

    of_others = Cycle()
    gc.freeze()
    assert not is_searched(of_others)
    collector = GarbageCollector()
    thing = Cycle()
    gone = weakref.ref(thing)
    collector.freeze()
    collector.close()
    assert not is_searched(of_others)
    assert is_searched(thing)
    del thing
    gc.collect()
    assert gone() is None


@pytest.mark.slow
def test_a_window_that_left_things_out_gives_them_back(application):
    from groundstation.gui.application.interpreter import GarbageCollector

    n_frozen = gc.get_freeze_count()
    gc.unfreeze()
    try:
        collector = GarbageCollector()
        collector.freeze()
        assert gc.get_freeze_count() > 0
        collector.close()
        assert gc.get_freeze_count() == 0
    finally:
        if n_frozen:  # what is garbage by now would be left out for ever
            gc.collect()
            gc.freeze()


def test_a_round_frees_what_was_left_behind(application):
    import weakref

    from groundstation.gui.application.interpreter import FULL_EVERY, GarbageCollector

    collector = GarbageCollector()
    try:
        thing = Cycle()
        gone = weakref.ref(thing)
        del thing
        for _ in range(FULL_EVERY):
            collector._collect()
        assert gone() is None
    finally:
        collector.close()


def test_the_long_search_waits_while_the_window_is_busy(application):
    import weakref

    from groundstation.gui.application.interpreter import FULL_EVERY, GarbageCollector

    busy = [True]
    collector = GarbageCollector(is_busy=lambda: busy[0])
    try:
        thing = Cycle()
        litter(gc.get_threshold()[0] + 1)
        collector._collect()
        gone = weakref.ref(thing)
        del thing  # older than a round: only the long search finds it
        for _ in range(2 * FULL_EVERY):
            collector._collect()
        assert gone() is not None
        busy[0] = False
        collector._collect()
        assert gone() is None
    finally:
        collector.close()


@pytest.mark.long
def test_modules_that_were_imported_later_are_left_out_of_long_searches(application, monkeypatch):
    import sys
    import types

    from groundstation.gui.application.interpreter import MANY_MODULES, GarbageCollector

    others = gc.get_freeze_count() > 0
    gc.unfreeze()
    collector = GarbageCollector()
    try:
        collector.freeze()
        before = gc.get_freeze_count()
        for number in range(MANY_MODULES - 1):
            monkeypatch.setitem(sys.modules, f"made_{number}", types.ModuleType(f"made_{number}"))
        collector._collect()
        assert gc.get_freeze_count() == before
        monkeypatch.setitem(sys.modules, "made_last", types.ModuleType("made_last"))
        litter(100)
        collector._collect()
        assert gc.get_freeze_count() > before
    finally:
        collector.close()
        if others:
            gc.freeze()
