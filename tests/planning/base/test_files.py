"""Files of others: only regular ones of a size that their kind has are read, and what a text becomes is bounded."""

import io
import json
import os
import random
import struct
import threading
import tracemalloc
import zipfile
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import MAX_MESSAGE, InputError, shortened
from planning.base.files import (
    MAX_XML_DEPTH,
    MIB,
    FileLimit,
    HostileXml,
    _json_bytes,
    _xml_bytes,
    check_input_file,
    check_json_size,
    check_lines,
    check_zip_directory,
    parse_xml,
    read_input_file,
    sha256_of_file,
)

THING = FileLimit("a thing", MIB, "make it smaller")


def refusals(path, limit=THING):
    said = set()
    for read in (check_input_file, read_input_file, lambda *a: sha256_of_file(*a)):
        with pytest.raises(InputError) as caught:
            read(path, limit)
        said.add(str(caught.value))
    (text,) = said
    assert text.startswith(f"{path}: ")
    return text.removeprefix(f"{path}: ")


def test_what_is_no_regular_file_is_refused_and_never_waited_for(tmp_path):
    for name, target in (("zero", "/dev/zero"), ("random", "/dev/urandom"), ("tty", "/dev/null")):
        (tmp_path / name).symlink_to(target)
        assert refusals(tmp_path / name) == "expected a thing, found a device or a pipe; name a file"
    os.mkfifo(tmp_path / "pipe")
    assert "a device or a pipe" in refusals(tmp_path / "pipe")
    assert refusals(tmp_path) == "expected a thing, found a folder; name a file"
    (tmp_path / "loop").symlink_to("loop")
    assert "cannot be read (" in refusals(tmp_path / "loop")
    assert refusals(tmp_path / "none") == "cannot be read: there is no such file"
    assert "null byte" in refusals(tmp_path / "a\0b")
    assert "cannot be read (" in refusals(tmp_path / ("x" * 300))


def test_a_name_that_becomes_a_pipe_meanwhile_is_not_waited_for(tmp_path, monkeypatch):
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setattr("planning.base.files.check_input_file", lambda *_: None)
    with pytest.raises(InputError, match="a device or a pipe"):
        read_input_file(tmp_path / "pipe", THING)


def test_files_beyond_the_limit_are_refused_and_those_at_it_are_read(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(bytes(MIB))
    assert read_input_file(path, THING) == bytes(MIB)
    path.write_bytes(bytes(MIB + 1))
    assert refusals(path) == "the file has more than 1 MiB; expected a thing; make it smaller"
    with path.open("r+b") as file:
        file.truncate(1 << 45)
    assert "more than 1 MiB" in refusals(path)
    assert "more than 3 KiB; expected a note" in refusals(path, FileLimit("a note", 3 * 1024))


def test_reading_takes_no_more_memory_than_the_file_has(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"x" * 1000)
    tracemalloc.start()
    assert len(read_input_file(path, FileLimit("a thing", 1 << 40))) == 1000
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 200_000


def test_a_file_that_says_it_is_empty_or_grows_is_read_to_its_end_or_refused(tmp_path):
    # The system's own files have no size.
    assert b"MemTotal" in read_input_file(Path("/proc/meminfo"), THING)
    path = tmp_path / "a"
    path.write_bytes(b"")
    stop, failed = threading.Event(), []

    def grow():
        with path.open("ab", buffering=0) as file:
            while not stop.is_set():
                file.write(bytes(50_000))

    writer = threading.Thread(target=grow)
    writer.start()
    try:
        for _ in range(2000):
            try:
                content = read_input_file(path, FileLimit("a thing", 30 * MIB))
                assert len(content) <= 30 * MIB
            except InputError as error:
                failed.append(str(error))
                break
    finally:
        stop.set()
        writer.join()
    assert "more than 30 MiB" in failed[0]


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=20) | st.dictionaries(st.text(max_size=8), inner, max_size=20),
    max_leaves=200,
)


def taken(make):
    """Bytes that a value takes."""
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    made = make()
    after = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert made is not None
    return after - before


@pytest.mark.slow
@given(values)
def test_no_json_takes_much_more_memory_than_is_foreseen(value):
    text = json.dumps([value] * 30)
    assert taken(lambda: json.loads(text)) < 1.3 * _json_bytes(text.encode()) + 4000


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "piece", ["[]", "{}", "[1.5]", '{"a":1}', '{"a":{}}', '"abcd"', "1234", "[[[[1]]]]", '"é"', "0"]
)
def test_json_of_the_worst_kinds_takes_what_is_foreseen(piece):
    text = "[" + ",".join([piece] * 50_000) + "]"
    share = taken(lambda: json.loads(text)) / _json_bytes(text.encode())
    assert 0.05 < share < 1.2


@pytest.mark.few(2)
@pytest.mark.parametrize("piece", ["<a/>", "<a>b</a>", '<a b="c"/>', '<a b="c" d="e"/>', "<a><b/></a>", "<a>1</a>2"])
def test_xml_of_the_worst_kinds_takes_what_is_foreseen(piece):
    text = "<r>" + piece * 20_000 + "</r>"
    share = taken(lambda: fromstring(text)) / _xml_bytes(text.encode())
    assert 0.2 < share < 1.2


def test_texts_that_would_take_gigabytes_are_refused_before_they_are_parsed(tmp_path):
    with pytest.raises(InputError, match=r"its content would take about \d+ GiB of memory; expected at most 2 GiB"):
        check_json_size(b"[]," * 22_000_000, tmp_path / "a.json")
    with pytest.raises(InputError, match="GiB of memory"):
        parse_xml(b"<a/>" * 25_000_000, "a.xml")
    with pytest.raises(InputError, match="has more than 10 lines"):
        check_lines(b"\n" * 21, 10, "a.csv")
    check_lines(b"a\r\n" * 10, 10, "a.csv")


def test_xml_is_refused_by_depth_entities_and_what_it_is_not():
    deep = MAX_XML_DEPTH - 1
    assert parse_xml(b"<a>" * deep + b"</a>" * deep, "a").tag == "a"
    with pytest.raises(HostileXml, match="levels deep"):
        parse_xml(b"<a>" * 100_000 + b"</a>" * 100_000, "a")
    bomb = b'<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><x>&b;</x>'
    for forbid in (True, False):
        with pytest.raises(HostileXml, match="entities"):
            parse_xml(bomb, "a", forbid_dtd=forbid)
    assert parse_xml(b"<!DOCTYPE x><x/>", "a", forbid_dtd=False).tag == "x"
    with pytest.raises(HostileXml):
        parse_xml(b"<!DOCTYPE x><x/>", "a")
    for wrong in (b"", b"<a>", b"\xff\xfe", b'<?xml version="1.0" encoding="klingon"?><a/>'):
        with pytest.raises(ValueError, match=r".") as caught:
            parse_xml(wrong, "a")
        assert not isinstance(caught.value, HostileXml)


@pytest.mark.slow
def test_archives_with_endless_lists_of_files_are_refused():
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w") as archive:
        for number in range(30_000):
            archive.writestr(f"{number:030d}", b"")
    with pytest.raises(InputError, match="the list of its files has more than 2 MiB"):
        check_zip_directory(written, "a.kmz")
    for content in (b"", b"PK", b"PK\x05\x06", random.Random(1).randbytes(100_000)):
        check_zip_directory(io.BytesIO(content), "a.kmz")
    large = struct.pack("<4s4H2LH", b"PK\x05\x06", 0, 0, 0xFFFF, 0xFFFF, 0xFFFFFFFF, 0, 0)
    with pytest.raises(InputError, match="more than 2 MiB"):
        check_zip_directory(io.BytesIO(bytes(1000) + large), "a.kmz")


@given(st.text(max_size=3000))
def test_messages_are_shortened_in_their_middle(text):
    told = shortened(text)
    assert len(told) <= MAX_MESSAGE + 6
    assert told == text or (told[:500] == text[:500] and told[-300:] == text[-300:])
