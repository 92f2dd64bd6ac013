import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.splats.ply import read_blocks, read_header, write_blocks

ROW = np.dtype([("x", "<f4"), ("red", "u1"), ("panel", "<i4")])
HEAD = b"ply\nformat binary_little_endian 1.0\n"


def some_rows(n):
    table = np.zeros(n, ROW)
    table["x"], table["red"], table["panel"] = np.arange(n), np.arange(n) % 256, -np.arange(n)
    return table


def written(path, n, at_once=7):
    rows = some_rows(n)
    write_blocks(path, n, ROW, ["hello", "origin: 1 2"], (rows[i : i + at_once] for i in range(0, n, at_once)))
    return rows


@pytest.mark.parametrize("n", [0, 1, 20])
def test_rows_come_back_in_blocks_of_any_size(tmp_path, n):
    rows = written(tmp_path / "a.ply", n)
    header = read_header(tmp_path / "a.ply")
    assert (header.n_rows, header.comments) == (n, ("hello", "origin: 1 2"))
    assert header.columns == (("x", "<f4"), ("red", "u1"), ("panel", "<i4"))
    blocks = list(read_blocks(tmp_path / "a.ply", header, 6))
    assert all(len(block) <= 6 for block in blocks)
    assert sum(len(block) for block in blocks) == n
    assert not n or np.array_equal(np.concatenate(blocks), rows)


def test_nothing_is_left_of_a_file_that_could_not_be_finished(tmp_path):
    (tmp_path / "a.ply").write_bytes(b"old")

    def broken():
        yield some_rows(2)
        raise RuntimeError("stopped")

    with pytest.raises(RuntimeError, match="stopped"):
        write_blocks(tmp_path / "a.ply", 4, ROW, [], broken())
    assert [path.name for path in tmp_path.iterdir()] == ["a.ply"]
    assert (tmp_path / "a.ply").read_bytes() == b"old"


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match=r"b.ply: cannot be written"):
        write_blocks(tmp_path / "no" / "b.ply", 0, ROW, [], [])
    with pytest.raises(InputError, match=r"c.ply: cannot be read"):
        read_header(tmp_path / "c.ply")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is no PLY file"),
        (b"solid stl", "is no PLY file"),
        (b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1", "found 'ascii'; save it"),
        (HEAD + b"element vertex 1\nproperty float x\n", "header does not end"),
        (HEAD + b"comment " + b"a" * 70_000 + b"\nend_header\n", "header does not end"),
        (HEAD + b"element vertex 2\nproperty float x\nend_header\n1234", "says that it has 2 points, 8 bytes, and 4"),
        (HEAD + b"element vertex 99999999999999999\nproperty float x\nend_header\n", "at most 200000000"),
        (HEAD + b"element vertex 9999999999999999999\nproperty float x\nend_header\n", "line 3 .* not understood"),
        (HEAD + b"element vertex -1\nproperty float x\nend_header\n", "line 3 .* not understood"),
        (HEAD + b"element vertex 1\nproperty list uchar int a\nend_header\n", "line 4 .* not understood"),
        (HEAD + b"element vertex 1\nproperty quad x\nend_header\n", "line 4 .* not understood"),
        (HEAD + b"property float x\nend_header\n", "line 3 .* not understood"),
        (HEAD + b"element vertex 1\nproperty float x\nproperty int x\nend_header\n12345678", "property 'x' twice"),
        (HEAD + b"element vertex 1\nend_header\n", "have 0 properties"),
        (
            HEAD + b"element vertex 1\n" + b"".join(b"property char a%d\n" % i for i in range(600)) + b"end_header\n",
            "600 prop",
        ),
        (HEAD + b"element face 1\nproperty float x\nend_header\n1234", "first element is 'face'"),
        (HEAD + b"end_header\n", "first element is 'none'"),
    ],
)
def test_headers_that_lie_or_are_damaged_are_refused(tmp_path, content, message):
    (tmp_path / "a.ply").write_bytes(content)
    with pytest.raises(InputError, match=rf"a.ply.*{message}"):
        read_header(tmp_path / "a.ply")


def test_faces_after_the_points_are_passed_over(tmp_path):
    head = HEAD + b"element vertex 1\nproperty float x\nelement face 1\nproperty list uchar int v\nend_header\n"
    (tmp_path / "a.ply").write_bytes(head + struct.pack("<f", 7.0) + b"\x01\x00\x00\x00\x00")
    (block,) = read_blocks(tmp_path / "a.ply", read_header(tmp_path / "a.ply"))
    assert block["x"].tolist() == [7.0]


def test_a_file_that_became_shorter_meanwhile_is_noticed(tmp_path):
    written(tmp_path / "a.ply", 20)
    header = read_header(tmp_path / "a.ply")
    content = (tmp_path / "a.ply").read_bytes()
    (tmp_path / "a.ply").write_bytes(content[:-30])
    with pytest.raises(InputError, match="ends after 16 of its 20 points"):
        list(read_blocks(tmp_path / "a.ply", header, 8))


@settings(max_examples=100, deadline=None)
@given(
    st.lists(
        st.sampled_from(
            [
                *("format binary_little_endian 1.0", "element vertex 3", "element vertex 0", "element face 2"),
                *("property float x", "property uchar y", "property list uchar int z", "property"),
                *("comment é", "obj_info q", "element", "\x00", "  "),
            ]
        ),
        max_size=7,
    ),
    st.binary(max_size=40),
)
def test_whatever_is_in_a_file_it_is_read_or_refused_with_a_message(tmp_path_factory, lines, tail):
    path = tmp_path_factory.getbasetemp() / "any.ply"
    path.write_bytes("\n".join(["ply", *lines, "end_header", ""]).encode() + tail)
    try:
        header = read_header(path)
    except InputError:
        return
    assert sum(len(block) for block in read_blocks(path, header, 2)) == header.n_rows
