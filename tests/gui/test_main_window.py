"""The window does the main job: open, look, plan, cancel, stop, check, export."""

import time

import numpy as np
import pytest

from groundstation.services.jobs import JobRunner
from missions.formats import read_missions
from missions.model import FileFormat
from planning.planner import PlanRequest
from planning.scenes import write_scene


@pytest.fixture
def window(application):
    from groundstation.gui.main_window import MainWindow

    runner = JobRunner()
    window = MainWindow(runner)
    window.resize(1200, 800)
    window.show()
    yield window
    window.close()
    runner.shutdown()


def run_until_idle(application, window, timeout_s=60.0):
    """Process events until no job runs; returns the longest time the window did not answer."""
    end, last, longest = time.perf_counter() + timeout_s, time.perf_counter(), 0.0
    while window.is_busy():
        application.processEvents()
        now = time.perf_counter()
        longest, last = max(longest, now - last), now
        assert now < end, "the job did not end"
        time.sleep(0.002)
    for _ in range(5):
        application.processEvents()
    return longest


def opened(application, window, scene, folder):
    window.open_site(write_scene(scene, folder))
    run_until_idle(application, window)


def test_window_opens_plans_checks_and_exports_a_site(application, window, tmp_path):
    opened(application, window, "roof", tmp_path)
    assert "roof: 32 panels" in window.messages()
    before = window.view().screenshot()
    window.form().setValue(PlanRequest(n_views=12, time_budget_s=5.0))
    window.plan()
    run_until_idle(application, window)
    assert "12 views, sorties: 1" in window.messages()
    assert "occlusion: off" in window.messages()
    after = window.view().screenshot()
    assert (before.std(axis=(0, 1)) > 5).all(), "the site is not drawn"
    assert np.count_nonzero((before != after).any(axis=2)) > 500, "the plan is not drawn"
    window.check()
    run_until_idle(application, window)
    assert "ready to fly" in window.messages()
    window.export(tmp_path / "roof.kmz", FileFormat.DJI_KMZ)
    run_until_idle(application, window)
    assert read_missions(tmp_path / "roof.kmz")[0].n_photos == 12


def test_window_answers_while_a_plan_runs_and_cancel_throws_it_away(application, window, tmp_path):
    opened(application, window, "library", tmp_path)
    window.form().setValue(PlanRequest(n_views=60, time_budget_s=60.0))
    window.plan()
    longest, end = 0.0, time.perf_counter() + 1.5
    while time.perf_counter() < end and window.is_busy():
        started = time.perf_counter()
        application.processEvents()
        longest = max(longest, time.perf_counter() - started)
    window._cancel_job()
    run_until_idle(application, window)
    assert "Plan cancelled" in window.messages()
    assert "views, sorties" not in window.messages()
    assert longest < 0.5


def test_good_enough_keeps_the_best_so_far(application, window, tmp_path):
    opened(application, window, "office", tmp_path)
    window.form().setValue(PlanRequest(n_views=40, time_budget_s=60.0))
    started = time.perf_counter()
    window.plan()
    while window.is_busy() and time.perf_counter() - started < 3.0:
        application.processEvents()
    window._stop_here()
    run_until_idle(application, window)
    assert "40 views, sorties: 1" in window.messages()
    assert time.perf_counter() - started < 20.0


def test_errors_say_what_to_do_and_leave_the_window_usable(application, window, tmp_path):
    broken = tmp_path / "broken.json"
    broken.write_text("{}")
    window.open_site(broken)
    run_until_idle(application, window)
    assert "failed" in window.messages()
    assert "missing required field" in window.messages()
    opened(application, window, "single-panel", tmp_path)
    assert "single-panel: 1 panels" in window.messages()


def test_form_gives_back_the_request_it_was_given(application):
    from groundstation.gui.plan_form import PlanForm

    form = PlanForm()
    heard = []
    form.valueChanged.connect(heard.append)
    for request in (
        PlanRequest(share=0.95),
        PlanRequest(n_views=77, method="pso", seed=5),
        PlanRequest(n_batteries=3, profile_id="m30", time_budget_s=12.0),
    ):
        form.setValue(request)
        assert form.value() == request
    heard.clear()
    form._wind.setValue(4.5)
    assert heard[-1].rules.wind_m_s == 4.5
    assert heard[-1].seed == 0


def test_qt_calls_leave_reference_counts_alone(application):
    """PySide6 6.12.0 takes one reference of None with every call on Python 3.11, and aborts after minutes."""
    import sys

    from PySide6.QtWidgets import QLabel

    label = QLabel()
    before = sys.getrefcount(None), sys.getrefcount(False)
    for _ in range(500):
        label.setText("x")
        label.isVisible()
    after = sys.getrefcount(None), sys.getrefcount(False)
    assert all(abs(b - a) < 100 for a, b in zip(before, after, strict=True))
