"""`signing`: what is asked, what is answered, and what is refused."""

import io

import pytest

from groundstation.cli.main import main
from groundstation.services.fly import signing
from missions.mavlink.signing import KeyStore


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(signing, "key_store", lambda: KeyStore(tmp_path, may_use_system=False))


def run(*arguments):
    return main(["signing", *arguments], lambda _wish: 0)


def test_a_key_is_set_from_a_pipe_seen_and_forgotten(capsys, monkeypatch):
    assert run("status") == 0
    assert "no key" in capsys.readouterr().out
    monkeypatch.setattr("sys.stdin", io.StringIO("correct horse battery staple\n"))
    assert run("set") == 0
    assert run("status") == 0
    assert "there is a key" in capsys.readouterr().out
    assert run("forget") == 0
    assert run("status") == 0
    assert capsys.readouterr().out.rstrip().endswith("there is no key")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("give",), "the url of a link"),
        (("status", "tcp:127.0.0.1:1"), "want none"),
        (("give", "tcp:127.0.0.1:1"), "signing set"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(capsys, arguments, words):
    assert run(*arguments) == 1
    printed = capsys.readouterr()
    assert words in printed.err
    assert printed.err.count("\n") == 1
    assert printed.out == ""


def test_a_short_passphrase_is_refused(capsys, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("short\n"))
    assert run("set") == 1
    assert "12 characters" in capsys.readouterr().err
