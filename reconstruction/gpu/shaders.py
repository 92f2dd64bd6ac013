"""WGSL from the files of `data`: constants, parts that several kernels share, and lines written out several times.

A file is WGSL but for lines that begin with `//:`

    //: include view            the file view.wgsl, once
    //: for q in QUADS          its lines, once for each value of the list QUADS, `$q` replaced by it
    //: if NAME / else          by whether a constant is other than 0
    //: end

Numbers among the constants are declared as constants of WGSL. Lines are written out because loops over private arrays
are not unrolled by all drivers, and arrays that are indexed by a variable are slow memory.

No branch and no loop's end depends on uniforms alone, but for those of a model that stay as they are: lavapipe compiles
such a kernel anew whenever other uniforms, as of the camera, change.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files

Constant = int | float | tuple[int, ...]


@cache
def _lines_of(name: str) -> tuple[str, ...]:
    return tuple(files(__package__).joinpath("data", f"{name}.wgsl").read_text("utf-8").splitlines())


def shader(name: str, constants: Mapping[str, Constant]) -> str:
    """The text of the kernel `name`, for compilers.

    Raises
    ------
    ValueError
        A line is not understood, or names no constant.
    """
    declared = [f"const {key} = {_number(value)};" for key, value in constants.items() if not isinstance(value, tuple)]
    return "\n".join([*declared, *_written_out(_lines_of(name), constants, set())]) + "\n"


def _number(value: int | float) -> str:
    return f"{value}u" if isinstance(value, int) else f"f32({value!r})"


def _written_out(lines: Sequence[str], constants: Mapping[str, Constant], included: set[str]) -> Iterator[str]:
    at = 0
    while at < len(lines):
        words = lines[at].split()
        if words[:1] != ["//:"]:
            yield lines[at]
            at += 1
            continue
        match words[1:]:
            case ["include", name]:
                if name not in included:
                    included.add(name)
                    yield from _written_out(_lines_of(name), constants, included)
                at += 1
            case ["for", variable, "in", name]:
                inner, _, at = _block(lines, at)
                values = _constant(constants, name)
                if not isinstance(values, tuple):
                    raise ValueError(f"{name}: expected a list, got {values}")
                for value in values:
                    replaced = [line.replace(f"${variable}", str(value)) for line in inner]
                    yield from _written_out(replaced, constants, included)
            case ["if", name]:
                inner, other, at = _block(lines, at)
                yield from _written_out(inner if _constant(constants, name) else other, constants, included)
            case _:
                raise ValueError(f"expected include, for or if, got {lines[at]!r}")


def _constant(constants: Mapping[str, Constant], name: str) -> Constant:
    if name not in constants:
        raise ValueError(f"{name}: expected one of {', '.join(constants)}")
    return constants[name]


def _block(lines: Sequence[str], start: int) -> tuple[Sequence[str], Sequence[str], int]:
    """Lines of a block that begins at `start`, those behind its `else`, and where the lines behind it begin."""
    depth, middle = 0, None
    for at in range(start, len(lines)):
        words = lines[at].split()
        word = words[1] if words[:1] == ["//:"] else ""
        depth += (word in ("for", "if")) - (word == "end")
        if word == "else" and depth == 1:
            middle = at
        if depth == 0:
            end = at if middle is None else middle
            return lines[start + 1 : end], () if middle is None else lines[middle + 1 : at], at + 1
    raise ValueError(f"expected an end of {lines[start]!r}")
