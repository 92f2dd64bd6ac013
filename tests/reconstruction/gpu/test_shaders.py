"""Kernels as they are written out for compilers."""

from __future__ import annotations

from importlib.resources import files

import pytest

from reconstruction.gpu import shaders
from reconstruction.gpu.shaders import shader


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch):
    def of(text: str, **constants: int | float | tuple[int, ...]) -> list[str]:
        parts = {"part": ("part",), "main": tuple(text.splitlines())}
        monkeypatch.setattr(shaders, "_lines_of", parts.__getitem__)
        return shader("main", constants).split()

    return of


def test_loops_are_written_out_within_each_other(written) -> None:
    text = "//: for p in P\n//: for q in Q\nv$p_$q\n//: end\n//: end\nlast"
    assert written(text, P=(0, 1), Q=(2, 3)) == ["v0_2", "v0_3", "v1_2", "v1_3", "last"]


def test_parts_are_chosen_by_constants_and_included_once(written) -> None:
    text = "//: include part\n//: include part\n//: if A\none\n//: if B\ntwo\n//: end\n//: else\nthree\n//: end"
    assert written(text, A=1, B=0) == ["const", "A", "=", "1u;", "const", "B", "=", "0u;", "part", "one"]
    assert written(text, A=0, B=0)[-2:] == ["part", "three"]


def test_what_is_not_understood_is_refused(written) -> None:
    for text, reason in (
        ("//: for p in P\nx", "expected an end"),
        ("//: repeat\n", "expected include, for or if"),
        ("//: if NONE\nx\n//: end", "NONE: expected one of"),
        ("//: for p in N\nx\n//: end", "expected a list"),
    ):
        with pytest.raises(ValueError, match=reason):
            written(text, P=(1,), N=3)


def test_every_file_begins_with_what_it_is_for() -> None:
    for path in files("reconstruction.gpu").joinpath("data").iterdir():
        lines = path.read_text("utf-8").splitlines()
        assert lines[0].startswith("// "), path.name
        assert all(len(line) <= 120 for line in lines), path.name
