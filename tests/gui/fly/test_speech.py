"""Warnings are spoken by the speech program of the system: which, when, and in what words."""

import itertools
import os
import stat
import time

import pytest
from PySide6.QtWidgets import QApplication

from groundstation.gui.fly.speech import MAX_CHARACTERS, Voice, WarningSpeaker, speech_program
from groundstation.services.fly.announce import AGAIN_S, Announcements
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity

NOTE = """#!/bin/sh
for each in "$@"; do printf '%s|' "$each" >> {log}; done
[ "$1" = "-v" ] && cat >> {log}
printf '\\n' >> {log}
sleep {sleep_s}
"""


def warning(code, severity=Severity.WARNING, since_s=0.0):
    return FlightWarning(code, severity, code, since_s, 1.0, 0.0, "")


def on_path(folder, monkeypatch, name, sleep_s=0):
    """A speech program that writes down what it would say."""
    log = folder / "said.txt"
    program = folder / name
    program.write_text(NOTE.format(log=log, sleep_s=sleep_s))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}/usr/bin{os.pathsep}/bin")
    return log


def wait_for(condition):
    end = time.monotonic() + 30.0
    while not condition():
        QApplication.processEvents()
        time.sleep(0.01)
        assert time.monotonic() < end


@pytest.mark.parametrize(
    ("name", "language", "wanted"),
    [
        ("spd-say", "de", "-w|-l|de|--|--stop; $(rm -rf /) der Wind|"),
        ("espeak-ng", "en", "-v|en|--stdin|--stop; $(rm -rf /) der Wind"),
    ],
)
def test_a_sentence_reaches_the_program_as_it_is_whatever_stands_in_it(
    application, tmp_path, monkeypatch, name, language, wanted
):
    """Names of sites come from files: none of them is an option or read by a shell."""
    log = on_path(tmp_path, monkeypatch, name)
    voice = Voice(language=language)
    assert voice.is_there()
    assert voice.say("--stop; $(rm -rf /)\n der   Wind")
    wait_for(lambda: not voice.is_speaking())
    assert log.read_text().strip() == wanted


def test_one_sentence_at_a_time_and_none_without_end(application, tmp_path, monkeypatch):
    log = on_path(tmp_path, monkeypatch, "spd-say", sleep_s=20)
    voice = Voice(language="en")
    assert voice.say("x" * 10_000)
    wait_for(lambda: log.exists() and log.read_text().endswith("\n"))
    assert not voice.say("another")
    voice.stop()
    wait_for(lambda: not voice.is_speaking())
    assert voice.say("another")
    voice.stop()
    wait_for(lambda: not voice.is_speaking())
    assert max(map(len, log.read_text().split("|"))) == MAX_CHARACTERS


def test_without_a_program_nothing_is_spoken_and_nothing_breaks(application, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert speech_program("de") is None
    voice = Voice(language="de")
    assert not voice.is_there()
    assert not voice.say("a word")
    speaker = WarningSpeaker(voice)
    speaker.take((warning("wind"),), {"wind": "a word"})


def test_the_worst_is_spoken_first_each_again_only_after_a_while():
    """And what is over and comes back is new."""
    said, heard, now_s = Announcements(), [], 0.0
    found = (warning("wind", since_s=5.0), warning("battery", Severity.ERROR, 1.0))
    while now_s < 60.0:
        due = said.after(found).next(found, now_s)
        if due is not None:
            heard.append((now_s, due.code))
            said = said.after(found).with_spoken(due, now_s)
        now_s += 0.5
    assert heard[:2] == [(0.0, "battery"), (0.5, "wind")]
    for code, severity in (("battery", Severity.ERROR), ("wind", Severity.WARNING)):
        times = [time_s for time_s, spoken in heard if spoken == code]
        assert min(later - earlier for earlier, later in itertools.pairwise(times)) >= AGAIN_S[severity]
    assert said.after(()).next(found, 60.0).code == "battery"


def test_a_warning_that_gets_worse_is_spoken_at_once():
    found = (warning("battery"),)
    said = Announcements().with_spoken(found[0], 10.0)
    assert said.next(found, 11.0) is None
    worse = (warning("battery", Severity.ERROR),)
    assert said.next(worse, 11.0) == worse[0]
    assert said.with_spoken(worse[0], 11.0).next(found, 12.0) is None, "better is no news"


def test_muted_it_falls_silent_and_speaks_again_when_asked(application, tmp_path, monkeypatch):
    log = on_path(tmp_path, monkeypatch, "spd-say")
    now = [0.0]
    voice = Voice(language="en")
    speaker = WarningSpeaker(voice, clock=lambda: now[0])
    found, worded = (warning("wind", Severity.ERROR),), {"wind": "the wind is 9.0 m/s"}
    speaker.set_muted(is_muted=True)
    speaker.take(found, worded)
    assert not log.exists()
    speaker.set_muted(is_muted=False)
    speaker.take(found, worded)
    wait_for(lambda: log.exists() and not voice.is_speaking())
    assert log.read_text().strip() == "-w|-l|en|--|Danger: the wind is 9.0 m/s|"
    speaker.take(found, worded)
    assert not voice.is_speaking()
    now[0] = AGAIN_S[Severity.ERROR]
    speaker.take(found, worded)
    wait_for(lambda: len(log.read_text().splitlines()) == 2)
