"""What goes wrong in a method that Qt calls is told, and the program goes on."""

import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.gui.application.errors import catching
from groundstation.services.jobs.runner import JobRunner
from groundstation.services.project.session import Session
from planning.base.findings import Severity
from tests.gui.driving import turn_until

PROGRAM = """
import sys
import groundstation.gui
from PySide6.QtCore import QAbstractListModel, QObject, QSize, QTimer
from PySide6.QtWidgets import QApplication, QListView, QVBoxLayout, QWidget

application = QApplication(["reflight-tests"])

def wrong():
    {wrong}

class Painted(QWidget):
    def paintEvent(self, event):
        wrong()

class Sized(QWidget):
    def sizeHint(self):
        return wrong()

class Rows(QAbstractListModel):
    def rowCount(self, parent=None):
        return 1

    def data(self, index, role=0):
        return wrong()

class Watching(QObject):
    def eventFilter(self, watched, event):
        return wrong()

class Closed(QWidget):
    n_closed = 0

    def close(self):
        self.n_closed += 1
        return super().close()

told = []
sys.excepthook = lambda kind, error, trace: told.append(kind.__name__)
window = QWidget()
layout = QVBoxLayout(window)
view, rows, watching = QListView(), Rows(), Watching()
view.setModel(rows)
painted = Painted()
painted.setMinimumSize(20, 20)
for widget in (painted, Sized(), view):
    layout.addWidget(widget)
closed = Closed()
window.windowTitleChanged.connect(closed.close)  # tells a text, of which it wants nothing
window.setWindowTitle("shown")
window.show()
QTimer.singleShot(300, lambda: view.viewport().installEventFilter(watching))
QTimer.singleShot(600, application.quit)
application.exec()
print(closed.n_closed, len(told) > 0, *set(told))
"""


@pytest.mark.parametrize(
    ("wrong", "name"),
    [
        ("return [][0]", "IndexError"),
        ("return 1 // 0", "ZeroDivisionError"),
        ("return int('x')", "ValueError"),
        ("return {}['x']", "KeyError"),
        ("raise ValueError('x')", "ValueError"),
    ],
)
def test_errors_in_what_qt_calls_are_told_and_the_program_goes_on(wrong, name):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(wrong=wrong)],
        capture_output=True,
        text=True,
        check=False,
        env={"QT_QPA_PLATFORM": "offscreen", "PATH": "/usr/bin:/bin", "LANG": "C.UTF-8"},
    )
    assert (done.returncode, done.stdout.split()) == (0, ["1", "True", name]), done.stderr[-2000:]


def plain(a, b=2):
    return a, b


def starred(a, *rest, b=2, **named):
    return a, rest, b, named


def named_only(a, *, b=2, c):
    return a, b, c


class Held:
    def method(self, __x, y=3):  # a name that Python changes
        return __x, y


@pytest.mark.parametrize("function", [plain, starred, named_only, Held.method])
@given(st.lists(st.integers(), max_size=4), st.dictionaries(st.sampled_from("abcyz"), st.integers(), max_size=2))
def test_parameters_stay_as_they_are(function, values, named):
    def outcome(called):
        try:
            return called(*values, **named)
        except TypeError as error:
            return str(error)

    assert outcome(catching(function)) == outcome(function)
    assert catching(function).__code__.co_argcount == function.__code__.co_argcount
    assert catching(function).__name__ == function.__name__


def test_the_user_is_told_once_of_each_place_where_something_went_wrong(application, monkeypatch, capsys):
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.application.errors import tell_errors

    context = ApplicationContext(Session(), JobRunner())
    heard = []
    context.messageShown.connect(heard.append)
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)
    tell_errors(context)
    for values in ([], [], [0], [0]):
        try:
            1 // values[0]
        except (IndexError, ZeroDivisionError) as error:
            sys.excepthook(type(error), error, error.__traceback__)
    sys.excepthook(KeyboardInterrupt, KeyboardInterrupt(), None)
    turn_until(application, lambda: len(heard) == 1)
    application.processEvents()
    (message,) = heard
    assert message.severity is Severity.ERROR
    assert "IndexError: list index out of range; test_errors.py, line" in message.text
    assert "It goes on" in message.text
    assert capsys.readouterr().err.count("IndexError") == 2
    context.close()
