"""Eight pixels at once: a number type for compiled kernels that is one vector of float32, and what can be done with it.

The compiler turns loops over pixels into vector instructions only where it understands them, and keeps their sums in
memory. Here the vectors are told; LLVM makes of them what the processor has (AVX-512, AVX, NEON or SSE).

In kernels, Lanes come from `load_lanes`, `load_number` and `spread`, and take +, -, *, / and comparisons, with a plain
number on either side, too. Comparisons give Choices, which take & and are asked by `select`, `any_of` and `bits_of`.
Products may be joined with sums into one instruction; the same processor gives the same bits always.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

N_LANES = 8

FLOAT, BYTE, INTEGER = ir.FloatType(), ir.IntType(8), ir.IntType(32)
FLOATS, INTEGERS = ir.VectorType(FLOAT, N_LANES), ir.VectorType(INTEGER, N_LANES)
BITS = ir.VectorType(ir.IntType(1), N_LANES)

JOINED = ("contract", "nsz")
"""What LLVM may do: join a product and a sum, and take -0 for 0."""

MANTISSA_BITS, EXPONENT_OF_ONE = 23, 127
"""Of float32."""


class _Vector(types.Type):
    """A vector in a register."""


LANES, CHOICES = _Vector("Lanes"), _Vector("Choices")


class _VectorModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: _Vector) -> None:
        super().__init__(manager, kind, FLOATS if kind == LANES else BITS)


register_model(_Vector)(_VectorModel)


def _shuffled(builder: Any, a: Any, b: Any, which: list[int]) -> Any:
    """Numbers of two vectors, those of the second counted from `N_LANES` on."""
    return builder.shuffle_vector(a, b, ir.Constant(INTEGERS, which))


def _spread(builder: Any, number: Any) -> Any:
    nothing = ir.Constant(FLOATS, ir.Undefined)
    return _shuffled(builder, builder.insert_element(nothing, number, INTEGER(0)), nothing, [0] * N_LANES)


def _vectors(builder: Any, kinds: Any, values: Any) -> list[Any]:
    """Operands as vectors, plain numbers in all lanes."""
    return [v if isinstance(kind, _Vector) else _spread(builder, v) for kind, v in zip(kinds, values, strict=True)]


def _lanes_or_number(kind: Any) -> Any:
    return kind if kind == LANES else types.float32


def _let_take(function: Any, result: Any, build: Callable[..., Any], of: Any = LANES) -> None:
    """Let an operator take Lanes, and a plain number as one of two operands; or two Choices."""

    class _Typing(AbstractTemplate):  # type: ignore[misc]
        key = function

        def generic(self, args: Any, kws: Any) -> Any:
            if of not in args or not all(a == of or isinstance(a, types.Number) for a in args):
                return None
            return signature(result, *(a if a == of else types.float32 for a in args))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return build(builder, *_vectors(builder, sig.args, args))

    infer_global(function)(_Typing)
    with_numbers = [(LANES, LANES), (LANES, types.float32), (types.float32, LANES)]
    for kinds in [(of,)] if function is operator.neg else [(of, of)] if of == CHOICES else with_numbers:
        lower_builtin(function, *kinds)(lower)


_let_take(operator.add, LANES, lambda b, x, y: b.fadd(x, y, flags=JOINED))
_let_take(operator.sub, LANES, lambda b, x, y: b.fsub(x, y, flags=JOINED))
_let_take(operator.mul, LANES, lambda b, x, y: b.fmul(x, y, flags=JOINED))
_let_take(operator.truediv, LANES, lambda b, x, y: b.fdiv(x, y))
_let_take(operator.neg, LANES, lambda b, x: b.fneg(x))
_let_take(operator.lt, CHOICES, lambda b, x, y: b.fcmp_ordered("<", x, y))
_let_take(operator.le, CHOICES, lambda b, x, y: b.fcmp_ordered("<=", x, y))
_let_take(operator.gt, CHOICES, lambda b, x, y: b.fcmp_ordered(">", x, y))
_let_take(operator.ge, CHOICES, lambda b, x, y: b.fcmp_ordered(">=", x, y))
_let_take(operator.eq, CHOICES, lambda b, x, y: b.fcmp_ordered("==", x, y))
_let_take(operator.and_, CHOICES, lambda b, x, y: b.and_(x, y), CHOICES)


def for_kernels(function: Callable[..., Any]) -> Any:
    """Of a function that says how an operation is typed and built, the operation; the typing context is left out."""
    return intrinsic(function)


def _place(context: Any, builder: Any, of: Any, array_kind: Any, array: Any, at: Any) -> Any:
    """Pointer to number `at` of an array without gaps, counted through it from its beginning."""
    data = context.make_array(array_kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [at]), of.as_pointer())


@for_kernels
def load_lanes(typing_context: Any, array: Any, at: Any) -> Any:
    """Numbers `at`, `at + 1`, ... of a float32 array without gaps, of any shape."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        loaded = builder.load(_place(context, builder, FLOATS, sig.args[0], *args), typ=FLOATS)
        loaded.align = 4
        return loaded

    return LANES(array, types.intp), build


@for_kernels
def store_lanes(typing_context: Any, array: Any, at: Any, lanes: Any) -> Any:
    """Put them where `load_lanes` finds them."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _place(context, builder, FLOATS, sig.args[0], *args[:2]), align=4)
        return context.get_dummy_value()

    return types.void(array, types.intp, LANES), build


@for_kernels
def load_number(typing_context: Any, array: Any, at: Any) -> Any:
    """Number `at` of a float32 array without gaps, of any shape, in all lanes."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _spread(builder, builder.load(_place(context, builder, FLOAT, sig.args[0], *args), typ=FLOAT))

    return LANES(array, types.intp), build


@for_kernels
def fetch(typing_context: Any, array: Any, at: Any) -> Any:
    """Have number `at` of an array without gaps brought near, for what comes later; 64 bytes come at once."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        kind = ir.FunctionType(ir.VoidType(), [BYTE.as_pointer(), INTEGER, INTEGER, INTEGER])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        to_read, soon_and_often, data = INTEGER(0), INTEGER(3), INTEGER(1)
        place = _place(context, builder, BYTE, sig.args[0], *args)
        builder.call(function, [place, to_read, soon_and_often, data])
        return context.get_dummy_value()

    return types.void(array, types.intp), build


@for_kernels
def spread(typing_context: Any, number: Any) -> Any:
    """The same number in all lanes."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _spread(builder, args[0])

    return LANES(types.float32), build


@for_kernels
def select(typing_context: Any, choices: Any, these: Any, those: Any) -> Any:
    """`these` where chosen, else `those`; both may be plain numbers."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(*_vectors(builder, sig.args, args))

    return LANES(CHOICES, _lanes_or_number(these), _lanes_or_number(those)), build


@for_kernels
def least_of(typing_context: Any, a: Any, b: Any) -> Any:
    """The smaller ones; `b` where one is no number."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        x, y = _vectors(builder, sig.args, args)
        return builder.select(builder.fcmp_ordered("<", x, y), x, y)

    return LANES(_lanes_or_number(a), _lanes_or_number(b)), build


@for_kernels
def most_of(typing_context: Any, a: Any, b: Any) -> Any:
    """The larger ones; `b` where one is no number."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        x, y = _vectors(builder, sig.args, args)
        return builder.select(builder.fcmp_ordered(">", x, y), x, y)

    return LANES(_lanes_or_number(a), _lanes_or_number(b)), build


@for_kernels
def bits_of(typing_context: Any, choices: Any) -> Any:
    """A bit for each lane, the lowest for the first."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(args[0], BYTE)

    return types.uint8(CHOICES), build


@for_kernels
def any_of(typing_context: Any, choices: Any) -> Any:
    """Whether one lane at least is chosen."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.icmp_unsigned("!=", builder.bitcast(args[0], BYTE), BYTE(0))

    return types.boolean(CHOICES), build


def _halved(builder: Any, a: Any, b: Any, n_parts: int) -> Any:
    """Each of `n_parts` parts of the lanes folded in the middle and added up: those of `a` and `b` in turns."""
    length = N_LANES // n_parts
    near = [p * length + k + of for p in range(n_parts) for of in (0, N_LANES) for k in range(length // 2)]
    far = [place + length // 2 for place in near]
    return builder.fadd(_shuffled(builder, a, b, near), _shuffled(builder, a, b, far), flags=JOINED)


@for_kernels
def sums_of(typing_context: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any, g: Any, h: Any) -> Any:
    """Sums over the lanes of each of eight Lanes, in the lanes of one."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        # Lanes of a and b, and so on, come to lie next to each other in the last of three steps.
        row = [args[k] for k in (0, 4, 2, 6, 1, 5, 3, 7)]
        while len(row) > 1:
            pairs = zip(row[::2], row[1::2], strict=True)
            row = [_halved(builder, x, y, N_LANES // len(row)) for x, y in pairs]
        return row[0]

    return LANES(*[LANES] * N_LANES), build


@for_kernels
def sum_of(typing_context: Any, lanes: Any) -> Any:
    """Sum over the lanes."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        total, step = args[0], N_LANES // 2
        while step:
            others = _shuffled(builder, total, total, [(k + step) % N_LANES for k in range(N_LANES)])
            total, step = builder.fadd(total, others, flags=JOINED), step // 2
        return builder.extract_element(total, INTEGER(0))

    return types.float32(LANES), build


def _by_llvm(name: str, lanes: Any) -> Any:
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        kind = ir.FunctionType(FLOATS, [FLOATS])
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"{name}.v{N_LANES}f32"), args)

    return LANES(LANES), build


@for_kernels
def rounded(typing_context: Any, lanes: Any) -> Any:
    """To the nearest whole numbers."""
    return _by_llvm("llvm.rint", lanes)


@for_kernels
def root_of(typing_context: Any, lanes: Any) -> Any:
    """Square roots."""
    return _by_llvm("llvm.sqrt", lanes)


@for_kernels
def power_of_two(typing_context: Any, exponents: Any) -> Any:
    """2^n for whole n from -126 to 127: n put where float32 has its exponent."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        one, places = (ir.Constant(INTEGERS, [n] * N_LANES) for n in (EXPONENT_OF_ONE, MANTISSA_BITS))
        return builder.bitcast(builder.shl(builder.add(builder.fptosi(args[0], INTEGERS), one), places), FLOATS)

    return LANES(LANES), build
