"""Blends of four channels at the eight vertices of a cell, each vertex's channels in one register of the processor.

Numba's compiler takes such sums apart into single numbers, three times as slow; here they are put together for it.
Arrays are float32, flat, C-contiguous, and hold four channels a vertex. A cell's first vertex begins at number `at`;
its neighbours along x, y and z are 4, `over` and `up` numbers further on. Nothing is checked: callers stay inside.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types as numba_types
from numba.extending import intrinsic

CHANNELS, VERTICES = 4, 8
types: Any = numba_types
FLOAT, ALIGN = ir.FloatType(), 4
QUAD = ir.VectorType(FLOAT, CHANNELS)
FUSED = ("contract",)
"""Products and sums may be rounded once, together."""

Codegen = Callable[[Any, Any, Any, Any], Any]


@intrinsic  # type: ignore[untyped-decorator]
def blended(_context: Any, flat: Any, at: Any, over: Any, up: Any, weights: Any) -> tuple[Any, Codegen]:
    """Four channels between a cell's vertices, whose eight `weights` come in the order of x, y and z."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        corners = _corners(context, builder, signature, arguments)
        shares = [builder.extract_value(arguments[4], k) for k in range(VERTICES)]
        total = None
        for corner, share in zip(corners, shares, strict=True):
            part = builder.fmul(_filled(builder, share), builder.load(corner, align=ALIGN), flags=FUSED)
            total = part if total is None else builder.fadd(total, part, flags=FUSED)
        return _tuple_of(builder, [_lane(builder, total, k) for k in range(CHANNELS)])

    return types.UniTuple(types.float32, CHANNELS)(flat, at, over, up, weights), codegen


@intrinsic  # type: ignore[untyped-decorator]
def spread(_context: Any, flat: Any, at: Any, over: Any, up: Any, weights: Any, amounts: Any) -> tuple[Any, Codegen]:
    """Add four channels' `amounts` to a cell's vertices, by their eight `weights`."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        added = _quad(builder, arguments[5])
        for number, corner in enumerate(_corners(context, builder, signature, arguments)):
            share = _filled(builder, builder.extract_value(arguments[4], number))
            part = builder.fmul(share, added, flags=FUSED)
            builder.store(builder.fadd(builder.load(corner, align=ALIGN), part, flags=FUSED), corner, align=ALIGN)
        return context.get_dummy_value()

    return types.none(flat, at, over, up, weights, amounts), codegen


@intrinsic  # type: ignore[untyped-decorator]
def weighed(_context: Any, flat: Any, at: Any, over: Any, up: Any, amounts: Any) -> tuple[Any, Codegen]:
    """Of each of a cell's eight vertices, the sum of its four channels times `amounts`."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        factors = _quad(builder, arguments[4])
        sums = []
        for corner in _corners(context, builder, signature, arguments):
            part = builder.fmul(factors, builder.load(corner, align=ALIGN), flags=FUSED)
            a, b, c, d = (_lane(builder, part, k) for k in range(CHANNELS))
            sums.append(builder.fadd(builder.fadd(a, b), builder.fadd(c, d)))
        return _tuple_of(builder, sums)

    return types.UniTuple(types.float32, VERTICES)(flat, at, over, up, amounts), codegen


def _corners(context: Any, builder: Any, signature: Any, arguments: Any) -> list[Any]:
    """Pointers to the channels of a cell's vertices: x changes first, z last."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    at, over, up = arguments[1:4]
    beside = ir.Constant(at.type, CHANNELS)
    rows = [at, builder.add(at, over), builder.add(at, up)]
    rows.append(builder.add(rows[2], over))
    places = [place for row in rows for place in (row, builder.add(row, beside))]
    return [builder.bitcast(builder.gep(array.data, [place]), QUAD.as_pointer()) for place in places]


def _filled(builder: Any, value: Any) -> Any:
    """A register with a number in each lane."""
    return _joined(builder, [value] * CHANNELS)


def _quad(builder: Any, values: Any) -> Any:
    """A register with the numbers of a tuple."""
    return _joined(builder, [builder.extract_value(values, k) for k in range(CHANNELS)])


def _joined(builder: Any, values: list[Any]) -> Any:
    register = ir.Constant(QUAD, ir.Undefined)
    for k, value in enumerate(values):
        register = builder.insert_element(register, value, ir.Constant(ir.IntType(32), k))
    return register


def _lane(builder: Any, register: Any, number: int) -> Any:
    return builder.extract_element(register, ir.Constant(ir.IntType(32), number))


def _tuple_of(builder: Any, values: list[Any]) -> Any:
    found = ir.Constant(ir.ArrayType(FLOAT, len(values)), ir.Undefined)
    for k, value in enumerate(values):
        found = builder.insert_value(found, value, k)
    return found
