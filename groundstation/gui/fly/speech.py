"""Speaks warnings with the speech program of the system, one sentence at a time, in the window's language.

Qt's own speech is part of a package of 175 MB (PySide6-Addons 6.11.3 for Linux), of which a ground station would use
a few kilobytes; it talks to the same programs.
"""

from __future__ import annotations

import shutil
import sys
import time
from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication, QLocale, QObject, QProcess, QTimer

from groundstation.services.fly.announce import Announcements
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity
from planning.base.progress import Clock

LONGEST_MS = 20_000
"""A sentence that takes longer is broken off: a speech program that hangs must not keep the next warning back."""

MAX_CHARACTERS = 300

WINDOWS_SPEECH = (
    "[Console]::InputEncoding = [Text.Encoding]::UTF8; Add-Type -AssemblyName System.Speech; "
    "$voice = New-Object System.Speech.Synthesis.SpeechSynthesizer; "
    "try {{ $voice.SelectVoiceByHints('NotSet', 'NotSet', 0, '{0}') }} catch {{ }}; "
    "$voice.Speak([Console]::In.ReadToEnd())"
)
"""Takes a voice of the language where there is one. The text comes by the standard input: no shell ever reads it."""


@dataclass(frozen=True, slots=True)
class SpeechProgram:
    """A program that speaks what it is given: as its last argument, or by its standard input."""

    path: str
    arguments: tuple[str, ...]
    takes_input: bool


def speech_program(language: str) -> SpeechProgram | None:
    """The speech program of this computer for a language such as `de`; None where there is none.

    On Linux speech-dispatcher or eSpeak, on macOS `say`, whose voice is the one of the system settings, on Windows
    System.Speech by PowerShell.
    """
    if sys.platform == "darwin":
        found = shutil.which("say")
        return None if found is None else SpeechProgram(found, ("-f", "-"), True)
    if sys.platform == "win32":
        found = shutil.which("powershell")
        arguments = ("-NoProfile", "-NonInteractive", "-Command", WINDOWS_SPEECH.format(_culture(language)))
        return None if found is None else SpeechProgram(found, arguments, True)
    for name, arguments, takes_input in (
        ("spd-say", ("-w", "-l", language, "--"), False),
        ("espeak-ng", ("-v", language, "--stdin"), True),
        ("espeak", ("-v", language, "--stdin"), True),
    ):
        found = shutil.which(name)
        if found is not None:
            return SpeechProgram(found, arguments, takes_input)
    return None


def _culture(language: str) -> str:
    return {"de": "de-DE"}.get(language, "en-US")


class Voice(QObject):
    """Speaks one sentence at a time; what comes meanwhile is dropped, for it is asked again what matters then."""

    def __init__(self, parent: QObject | None = None, language: str = "") -> None:
        super().__init__(parent)
        self._program = speech_program(language or QLocale().name()[:2])
        self._process: QProcess | None = None
        self._limit = QTimer(self, interval=LONGEST_MS, singleShot=True)
        self._limit.timeout.connect(self.stop)

    def is_there(self) -> bool:
        """Whether this computer can speak."""
        return self._program is not None

    def is_speaking(self) -> bool:
        """Whether a sentence is being spoken."""
        return self._process is not None and self._process.state() != QProcess.ProcessState.NotRunning

    def say(self, text: str) -> bool:
        """Speak a sentence; False where there is no voice, or it is speaking."""
        if self._program is None or self.is_speaking():
            return False
        self._forget()
        said, program = " ".join(text.split())[:MAX_CHARACTERS], self._program
        process = self._process = QProcess(self)
        process.setStandardOutputFile(QProcess.nullDevice())
        process.setStandardErrorFile(QProcess.nullDevice())
        arguments = [*program.arguments] if program.takes_input else [*program.arguments, said]
        process.start(program.path, arguments)
        if program.takes_input:
            process.write(said.encode())
        process.closeWriteChannel()
        self._limit.start()
        return True

    def stop(self) -> None:
        """Fall silent."""
        if self._process is not None and self.is_speaking():
            self._process.kill()

    def _forget(self) -> None:
        if self._process is not None:
            self._process.deleteLater()
            self._process = None


class WarningSpeaker(QObject):
    """Speaks the warnings of a flight as they come and go."""

    def __init__(self, voice: Voice, parent: QObject | None = None, clock: Clock = time.monotonic) -> None:
        super().__init__(parent)
        self._voice, self._clock = voice, clock
        self._said = Announcements()
        self._is_muted = False

    def set_muted(self, *, is_muted: bool) -> None:
        """Speak no more, or again."""
        self._is_muted = is_muted
        if is_muted:
            self._voice.stop()

    def take(self, warnings: tuple[FlightWarning, ...], worded: dict[str, str]) -> None:
        """Speak the one that is due; `worded` has the text of each, by its code, in the user's language and units."""
        self._said = self._said.after(warnings)
        if self._is_muted or self._voice.is_speaking():
            return
        now_s = self._clock()
        due = self._said.next(warnings, now_s)
        if due is not None and self._voice.say(_sentence(due, worded[due.code])):
            self._said = self._said.with_spoken(due, now_s)


def _sentence(warning: FlightWarning, words: str) -> str:
    translate = QCoreApplication.translate
    is_error = warning.severity is Severity.ERROR
    title = translate("WarningSpeaker", "Danger") if is_error else translate("WarningSpeaker", "Warning")
    return translate("WarningSpeaker", "{0}: {1}").format(title, words)
