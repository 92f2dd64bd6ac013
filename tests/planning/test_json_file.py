"""Files of ours: written whole or not at all, through links, never over what is read; read or refused in words."""

import os
import stat
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

import pytest

from planning.errors import InputError
from planning.json_file import check_output, expect_format, read_json, to_record, write_atomically


def test_a_written_file_replaces_the_old_one_and_leaves_nothing_else(tmp_path):
    path = tmp_path / "größe 1.json"
    for content in (b"old", b"new"):
        write_atomically(path, content)
        assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]
    assert stat.S_IMODE(path.stat().st_mode) == 0o644


def test_a_link_stays_a_link_and_its_target_is_written(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    link, target = tmp_path / "link.json", tmp_path / "elsewhere" / "target.json"
    link.symlink_to(target)
    write_atomically(link, b"through")
    assert link.is_symlink()
    assert target.read_bytes() == b"through"
    assert list(target.parent.iterdir()) == [target]


@pytest.mark.skipif(os.name == "nt", reason="pipes of a POSIX system")
def test_a_pipe_is_written_into_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_atomically(pipe, b"content")
    assert os.read(reader, 100) == b"content"
    os.close(reader)
    assert pipe.is_fifo()


def test_outputs_are_refused_before_work_begins(tmp_path):
    source, link = tmp_path / "source.json", tmp_path / "link.json"
    source.write_text("{}")
    link.symlink_to(source)
    for path, message in [
        (tmp_path / "no" / "p.json", "there is no folder"),
        (source / "p.json", "there is no folder"),
        (tmp_path, "this is a folder"),
        (source, "would replace"),
        (link, "would replace"),
        (tmp_path / "." / "source.json", "would replace"),
    ]:
        with pytest.raises(InputError, match=message):
            check_output(path, [source])
    check_output(source)
    check_output(tmp_path / "new.json", [source, tmp_path / "missing.json"])


def test_a_write_protected_file_is_left_alone(tmp_path, monkeypatch):
    path = tmp_path / "p.json"
    path.write_text("mine")
    path.chmod(0o444)
    # The superuser may write everything, so the system's answer is set.
    monkeypatch.setattr("os.access", lambda place, _: place != path)
    with pytest.raises(InputError, match="the file is write-protected"):
        write_atomically(path, b"other")
    assert path.read_text() == "mine"


@pytest.mark.skipif(os.name == "nt", reason="pipes of a POSIX system")
def test_a_write_protected_folder_is_told_of_before_work_begins(tmp_path, monkeypatch):
    locked, link, pipe = tmp_path / "locked", tmp_path / "link.json", tmp_path / "locked" / "pipe"
    locked.mkdir()
    (locked / "old.json").write_text("old")
    link.symlink_to(locked / "old.json")
    os.mkfifo(pipe)
    # The superuser may write everywhere, so the system's answer is set.
    monkeypatch.setattr("os.access", lambda place, _: place != locked)
    for path in (locked / "new.json", locked / "old.json", link):
        with pytest.raises(InputError, match=r"folder '.*locked' is write-protected; name a file in another one"):
            check_output(path)
    check_output(pipe)
    check_output(tmp_path / "new.json")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "line 1: the file is empty"),
        (b"\n \t", "line 1: the file is empty"),
        (b"{", "not valid JSON, line 1, column 2"),
        (b"\xff", "UTF-8.*offset 0"),
        (b"[" * 600 + b"]" * 600, "nested too deeply"),
        (b'{"a": [1, {"b": -Infinity}]}', r"a\[1\]\.b: expected a finite number"),
        (b'{"a": 1e400}', "a: expected a finite number"),
        (b"[" + b"9" * 5000 + b"]", "too many digits"),
    ],
)
def test_what_is_no_json_is_refused_with_place_and_reason(tmp_path, content, message):
    path = tmp_path / "x.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_json(path)
    assert str(caught.value).startswith(str(path))


def test_a_byte_order_mark_is_read_over(tmp_path):
    path = tmp_path / "x.json"
    path.write_bytes(b'\xef\xbb\xbf{"a": "\xc3\xa4"}')
    assert read_json(path) == {"a": "ä"}


def test_another_format_is_named_before_any_field(tmp_path):
    path = tmp_path / "x.json"
    expect_format({"format": "a/1"}, "a/1", path)
    expect_format({}, "a/1", path)
    for found in ("b/1", "a/2", 3, None):
        with pytest.raises(InputError, match=r"format: expected 'a/1', got .*; is it the right file\?"):
            expect_format({"format": found}, "a/1", path)


@pytest.mark.parametrize(
    ("content", "kind", "message"),
    [
        ({"a": 1}, dict[str, str | None], "expected text or nothing, got whole number"),
        ([1.5], list[int], "expected whole number, got number"),
        ([True], list[float], "expected number, got true/false"),
    ],
)
def test_kinds_are_told_in_words(tmp_path, content, kind, message):
    with pytest.raises(InputError, match=message):
        to_record(content, kind, tmp_path / "x.json")


class Side(Enum):
    LEFT, RIGHT = "left", "right"


@dataclass(frozen=True)
class Inner:
    kind: Literal["big", "small"] = "big"
    side: Side | None = None


@dataclass(frozen=True)
class Outer:
    inner: Inner | None = None
    more: tuple[Inner, ...] = ()
    named: dict[str, Inner] = field(default_factory=dict)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"inner": {"kind": "large"}}, "inner.kind: expected big, small, got 'large'"),
        ({"more": [{}, {"side": "up"}]}, "more[1].side: expected left, right, got 'up'"),
        ({"named": {"a b": {"kind": "large"}}}, "named[...].kind: expected big, small, got 'large'"),
    ],
)
def test_words_that_may_stand_there_are_told(tmp_path, content, message):
    with pytest.raises(InputError) as caught:
        to_record(content, Outer, tmp_path / "x.json")
    assert str(caught.value) == f"{tmp_path / 'x.json'}: {message}"


def test_a_word_in_a_list_of_words_is_told_too(tmp_path):
    with pytest.raises(InputError, match=r"\[1\]: expected big, small, got 'large'"):
        to_record(["big", "large"], list[Literal["big", "small"]], tmp_path / "x.json")
