"""Files of ours: written whole or not at all, through links, never over what is read; read or refused in words."""

import errno
import os
import stat
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Literal

import pytest

from planning.base import json_file
from planning.base.errors import InputError
from planning.base.json_file import (
    check_output,
    expect_format,
    part_file,
    part_files,
    part_folder,
    read_json,
    read_toml,
    to_record,
    write_atomically,
    write_together,
)


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
        (b'{"a": [1, ' + b"9" * 40 + b"]}", r"a\[1\]: expected a number of at most 20 digits, found one of 40"),
        (b'{"a": ["\\ud800"]}', r"a\[0\]: expected text, found half of a character"),
        (b'{"\\ud800": 1}', r"expected text, found half of a character"),
        (b"[" * 101 + b"]" * 101, "nested too deeply"),
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
    for found, named in (("b/1", "'b/1'"), ("a/2", "'a/2'"), (3, "none"), (None, "none"), ([], "none")):
        with pytest.raises(InputError, match=rf"format: expected 'a/1', got {named}; is it the right file\?"):
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


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a." * 100_000 + b"a = 1", "line 1: a key has more than 16 parts"),
        (b"[x]\n" + b" . ".join([b'"a b"'] * 20) + b" = 1", "line 2: a key has more than 16 parts"),
        (b"[" + b".".join([b"a"] * 20) + b"]", "a key has more than 16 parts"),
        (b"a = " + b"[" * 100_000, "nested too deeply"),
        (b"a = " + b"{b = " * 100_000, "nested too deeply"),
        (b"a = " + b"9" * 5000, "not valid TOML"),
        (b"a = " + b"9" * 40, "a: expected a number of at most 20 digits"),
        (b"a = 1\n" * 300_000, "more than 1 MiB; expected a TOML file"),
        (b"a = \xff", "not valid TOML"),
        (b'a = "\\ud800"', "not valid TOML"),
        (b"a = 1979-99-99", "not valid TOML"),
    ],
)
def test_what_is_no_toml_is_refused_in_no_time(tmp_path, content, message):
    path = tmp_path / "x.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        read_toml(path, dict[str, object])
    assert str(caught.value).startswith(str(path))


def test_sound_toml_is_read(tmp_path):
    path = tmp_path / "x.toml"
    text = 'a.b.c = 1.5\nd = [1.0, 2.0, 3.0]\ne = "' + "x.y." * 500 + '"\n[f]\ng = inf\n'
    path.write_text(text.replace("x.y.", "x, y. "))
    found = read_toml(path, dict[str, object])
    assert found["a"] == {"b": {"c": 1.5}}
    assert found["f"] == {"g": float("inf")}


def test_names_of_files_that_are_no_utf8_are_read_where_files_are_named(tmp_path):
    path = tmp_path / "x.json"
    path.write_bytes(b'{"a": "x\\udcff.jpg"}')
    assert read_json(path, names_files=True) == {"a": "x\udcff.jpg"}
    with pytest.raises(InputError, match="half of a character"):
        read_json(path)


def part_names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_files_that_belong_together_are_all_old_or_all_new(tmp_path):
    one, two, three = (tmp_path / name for name in ("one.json", "two.ply", "three.ply"))
    write_together({one: b"1", two: b"2"})
    write_together({one: b"11", two: b"22", three: b"33"})
    assert [path.read_bytes() for path in (one, two, three)] == [b"11", b"22", b"33"]
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="this is a folder"):
        write_together({one: b"111", two: b"222", tmp_path / "folder": b""})
    with pytest.raises(ZeroDivisionError), part_files([one, two]) as parts:
        parts[parts[0].write_bytes(b"x") // 0].touch()
    assert [path.read_bytes() for path in (one, two, three)] == [b"11", b"22", b"33"]
    assert part_names(tmp_path) == ["folder", "one.json", "three.ply", "two.ply"]


WRITER = """
import sys, time
from pathlib import Path
from planning.base.json_file import part_file, part_folder
with part_file(Path(sys.argv[1])) as part, part_folder(Path(sys.argv[1]).parent, "waiting") as folder:
    part.write_bytes(b"half")
    (folder / "x").touch()
    print("written", flush=True)
    sys.stdin.read()
"""

OTHER = """import sys
from pathlib import Path
from planning.base.json_file import write_atomically
write_atomically(Path(sys.argv[1]), b'x')
"""


def test_what_a_killed_writer_leaves_is_removed_and_what_a_living_one_writes_is_not(tmp_path):
    target, root = tmp_path / "a.json", Path(__file__).resolve().parents[3]
    command = [sys.executable, "-c", WRITER, str(target)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "cwd": root}
    with subprocess.Popen(command, **pipes) as killed, subprocess.Popen(command, **pipes) as living:
        for writer in (killed, living):
            assert writer.stdout.readline() == b"written\n"
        killed.kill()
        killed.communicate()
        (tmp_path / ".hidden").touch()
        assert len(part_names(tmp_path)) == 5
        subprocess.run([sys.executable, "-c", OTHER, str(tmp_path / "b.json")], check=True, cwd=root)
        assert len(part_names(tmp_path)) == 4
        living.communicate()
        assert living.returncode == 0
        assert part_names(tmp_path) == [".hidden", "a.json", "b.json"]
        assert target.read_bytes() == b"half"


def test_files_in_the_making_and_those_who_clear_up_do_not_meet(tmp_path):
    ends = time.monotonic() + 2.0

    def write(name):
        target, count = tmp_path / name, 0
        while time.monotonic() < ends:
            with part_file(target, is_lasting=False) as part, part_folder(tmp_path, name) as folder:
                part.write_bytes(b"%d" % count)
                (folder / "x").write_bytes(b"x")
            assert target.read_bytes() == b"%d" % count
            count += 1
        return count

    def clear():
        while time.monotonic() < ends:
            json_file._clear_parts.__wrapped__(tmp_path)

    with ThreadPoolExecutor(4) as pool:
        cleared = [pool.submit(clear) for _ in range(2)]
        written = [pool.submit(write, name) for name in ("a.json", "b.json")]
        assert all(one.result() > 10 for one in written)
        assert all(one.result() is None for one in cleared)
    assert part_names(tmp_path) == ["a.json", "b.json"]


def test_files_are_written_where_the_file_system_has_no_locks(tmp_path, monkeypatch):
    def no_locks(*_):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("fcntl.flock", no_locks)
    write_atomically(tmp_path / "a.json", b"1")
    with part_folder(tmp_path, "b"):
        json_file._clear_parts.__wrapped__(tmp_path)
        assert len(part_names(tmp_path)) == 2
    assert part_names(tmp_path) == ["a.json"]
