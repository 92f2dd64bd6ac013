"""A graphics card through WebGPU (wgpu: Vulkan, Metal or Direct3D 12): which there are, and running kernels on one.

Kernels are WGSL files of `data`. Each is compiled once for a set of constants. What they read and write are buffers and
textures from a pool: those that are given back are taken again, so a training step asks the driver for nothing new.
What is held of a card's memory is counted, idle pieces included; what the driver takes for itself nobody knows.
A binding of a buffer is limited, to 128 MiB on older cards; callers ask `most_bytes` and work in parts.
"""

from __future__ import annotations

import os
import re
import struct
import tempfile
import threading
import weakref
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import ReconstructionError
from planning.base.messages import say
from reconstruction.gpu.shaders import Constant, shader

Kind = Literal["discrete", "integrated", "virtual", "software", "unknown"]

KINDS: dict[str, Kind] = {
    "DiscreteGPU": "discrete", "IntegratedGPU": "integrated", "VirtualGPU": "virtual", "CPU": "software",
}  # fmt: skip

SOFTWARE = ("llvmpipe", "lavapipe", "swiftshader", "microsoft basic render driver", "warp")
"""Parts of names of adapters that are programs, whatever kind they say they are."""

ORDER: tuple[Kind, ...] = ("discrete", "integrated", "virtual", "unknown", "software")
NAME_VARIABLE = "WGPU_ADAPTER_NAME"
"""As other programs with wgpu have it."""

BACKENDS = ("Vulkan", "Metal", "D3D12")
INSTALL = "sudo apt-get install mesa-vulkan-drivers"

TEXELS_A_ROW = 8192
"""Width of textures that are tables: what every WebGPU device has."""
TEXEL_BYTES = 16
MOST_GROUPS = 65535
"""Workgroups along one axis."""
UNIFORM_STEP = 256
"""Of offsets into a buffer with uniforms."""
ARENA_BYTES = 1 << 16
LEAST_BYTES = 256
MAPPED_STEP = 8
"""Of the bytes that are read of a buffer."""
IDLE_BYTES = 1 << 30
"""Kept of what was given back, at most."""
ROOMY_BYTES = 4 << 30
"""Held of a card's memory, beyond which idle pieces make room for new ones: many cards have no more than 8 GB."""


LOST = "device is lost"
"""In the driver's errors after it was reset, pulled out or put to sleep."""


class DeviceFailed(ReconstructionError):  # noqa: N818  (the name says what happened)
    """The graphics card does not answer any more, or has too little memory; the processor can go on."""


@dataclass(frozen=True, slots=True)
class Adapter:
    """A graphics card, or a program in the place of one.

    Parameters
    ----------
    backend
        Of the system: one of `BACKENDS`.
    driver
        As the driver describes itself.
    """

    name: str
    kind: Kind
    backend: str
    driver: str

    @property
    def is_software(self) -> bool:
        """Whether the processor does the work."""
        return self.kind == "software"

    def __str__(self) -> str:
        return say("{} ({})", self.name, self.backend)


@cache
def _library() -> Any:
    """Wgpu, once; None where it is not installed or does not load."""
    if "XDG_RUNTIME_DIR" not in os.environ:
        # Without it Mesa complains on the terminal and goes on.
        os.environ["XDG_RUNTIME_DIR"] = tempfile.gettempdir()
    try:
        import wgpu
        from wgpu.backends.wgpu_native import extras
    except (ImportError, OSError, RuntimeError):
        return None
    extras.set_instance_extras(backends=["Vulkan", "Metal", "DX12"])
    return wgpu


@cache
def _found() -> tuple[tuple[Adapter, Any], ...]:
    library = _library()
    if library is None:
        return ()
    try:
        present = library.gpu.enumerate_adapters_sync()
    except (library.GPUError, RuntimeError):
        # A driver that does not start is as good as none.
        return ()
    found = []
    for raw in present:
        info = raw.info
        name = info["device"] or info["vendor"] or info["description"]
        kind = KINDS.get(info["adapter_type"], "unknown")
        if any(part in name.lower() for part in SOFTWARE):
            kind = "software"
        if info["backend_type"] in BACKENDS:
            found.append((Adapter(name, kind, info["backend_type"], info["description"]), raw))
    return tuple(found)


def adapters() -> tuple[Adapter, ...]:
    """All there are, the fastest kind first; programs that stand in for a card come last.

    Those whose name has a part that the environment's `NAME_VARIABLE` asks for come before all others.
    """
    wanted = os.environ.get(NAME_VARIABLE, "").lower()
    return tuple(
        sorted(
            (adapter for adapter, _ in _found()),
            key=lambda each: (wanted not in each.name.lower(), ORDER.index(each.kind)),
        )
    )


def why_no_gpu() -> str:
    """What keeps kernels from running here, with what to type; empty where nothing does."""
    if _library() is None:
        return say("wgpu is not installed (pip install wgpu)")
    if not _found():
        return say("no Vulkan, Metal or Direct3D 12 driver answers (on Debian or Ubuntu: {})", INSTALL)
    return ""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Piece:
    """A buffer or texture that goes back to the pool when nobody has it any more; `size` is bytes or texels."""

    raw: Any
    size: int
    view: Any = None


@dataclass(frozen=True, slots=True, eq=False)
class _Kernel:
    raw: Any
    layout: Any
    bindings: tuple[int, ...]


Binding = Piece | bytes
"""What a kernel's binding is given: a piece of the device's memory, or the bytes of a uniform."""


@dataclass(eq=False)
class Device:
    """An opened card.

    Parameters
    ----------
    most_bytes
        Of one buffer.
    group
        Lanes that work together, 8 or 32.
    has_subgroups
        Whether they can do so without shared memory.
    held_bytes, peak_bytes
        Of all buffers and textures that there are, in use, idle or for reading, and the most there were.
    """

    adapter: Adapter
    raw: Any
    most_bytes: int
    group: int
    has_subgroups: bool
    held_bytes: int = 0
    peak_bytes: int = 0
    _kernels: dict[tuple[str, tuple[tuple[str, Constant], ...]], _Kernel] = field(default_factory=dict)
    _idle: dict[tuple[str, int], list[tuple[Any, Any]]] = field(default_factory=dict)
    _idle_bytes: int = 0
    _lock: Any = field(default_factory=threading.RLock)
    _arena: Any = None

    @property
    def most_texels(self) -> int:
        """Of one table."""
        return TEXELS_A_ROW * TEXELS_A_ROW

    @contextmanager
    def errors_said(self) -> Iterator[None]:
        """Turn what the driver raises within a block, but for wrong calls, into `DeviceFailed`."""
        library = _library()
        try:
            yield
        except library.GPUError as error:
            is_lost = LOST in str(error)
            if isinstance(error, library.GPUValidationError) and not is_lost:
                raise
            forget(self)
            reason: str = str(error).strip().splitlines()[-1].strip()
            if isinstance(error, library.GPUOutOfMemoryError):
                reason = say("it has no memory left")
            elif is_lost:
                reason = say("it does not answer any more")
            raise DeviceFailed(
                say("the graphics card {} failed: {}; compute on the processor instead", self.adapter.name, reason)
            ) from error

    def check(self) -> None:
        """Raise the driver's error where the card is lost: handing it commands would end the program."""
        use = _library().BufferUsage
        self.raw.create_buffer(size=LEAST_BYTES, usage=use.COPY_DST).destroy()

    def buffer(self, n_bytes: int, *, stays: bool = False) -> Piece:
        """A buffer of as many bytes or somewhat more, filled with anything.

        Parameters
        ----------
        stays
            It is used for long: it is no larger than it must be, and never of the pool.

        Raises
        ------
        ValueError
            It is larger than `most_bytes`.
        """
        if n_bytes > self.most_bytes:
            raise ValueError(f"a buffer of {n_bytes} bytes: the device has {self.most_bytes} at most")
        if stays:
            size = rounded_up(max(n_bytes, LEAST_BYTES), MAPPED_STEP) * MAPPED_STEP
            return self._taken("buffer that stays", size, size)
        size = self.buffer_bytes(n_bytes)
        return self._taken("buffer", size, size)

    def buffer_bytes(self, n_bytes: int) -> int:
        """What a buffer of so many bytes takes."""
        return min(_rounded(max(n_bytes, LEAST_BYTES)), self.most_bytes // 4 * 4)

    def forget_peak(self) -> None:
        """Begin to count `peak_bytes` anew."""
        with self._lock:
            self.peak_bytes = self.held_bytes

    def _hold(self, n_bytes: int) -> None:
        """Count bytes that were taken from the driver, or given back to it."""
        with self._lock:
            self.held_bytes += n_bytes
            self.peak_bytes = max(self.peak_bytes, self.held_bytes)

    def table(self, texels: int, kind: Literal["rgba32float", "rgba32uint"] = "rgba32float") -> Piece:
        """A texture of as many texels or more, row by row, filled with anything."""
        n_bytes = self.table_bytes(texels)
        rows = n_bytes // (TEXELS_A_ROW * TEXEL_BYTES)
        if texels > rows * TEXELS_A_ROW:
            raise ValueError(f"a table of {texels} texels: the device has {self.most_texels} at most")
        return self._taken(kind, rows, n_bytes)

    def table_bytes(self, texels: int) -> int:
        """What a table of so many texels takes."""
        rows = rounded_up(max(texels, 1), TEXELS_A_ROW)
        # Programs compile a kernel anew for each mix of heights that are powers of 2 and those that are none.
        rows = 1 << (rows - 1).bit_length() if self.adapter.is_software else _rounded(rows, 1)
        return min(rows, TEXELS_A_ROW) * TEXELS_A_ROW * TEXEL_BYTES

    def picture(self, levels: Sequence[NDArray[Any]]) -> Piece:
        """A texture that is no table, to be read between its texels; of the caller, and never of the pool.

        Parameters
        ----------
        levels
            Shape (h, w, 4) or (d, h, w, 4), float16, each half as large as the one before; or one of (d, h, w), uint8.
        """
        library = _library()
        is_bytes = levels[0].dtype == np.uint8
        sizes = [level.shape if is_bytes else level.shape[:-1] for level in levels]
        extents = [(*size[::-1], 1)[:3] for size in sizes]
        use = library.TextureUsage
        raw = self.raw.create_texture(
            size=extents[0],
            format="r8uint" if is_bytes else "rgba16float",
            usage=use.TEXTURE_BINDING | use.COPY_DST,
            dimension=f"{len(sizes[0])}d",
            mip_level_count=len(levels),
        )
        for number, (level, extent) in enumerate(zip(levels, extents, strict=True)):
            layout = {"bytes_per_row": level.nbytes // (extent[1] * extent[2]), "rows_per_image": extent[1]}
            place = {"texture": raw, "mip_level": number}
            self.raw.queue.write_texture(place, np.ascontiguousarray(level), layout, extent)
        piece, n_bytes = Piece(raw, levels[0].nbytes, raw.create_view()), sum(level.nbytes for level in levels)
        self._hold(n_bytes)
        weakref.finalize(piece, self._hold, -n_bytes).atexit = False
        return piece

    def sampler(self, *, is_round: bool) -> Piece:
        """Reads pictures, linear between texels; at their ends it goes on at the other side, or stays."""
        across = "repeat" if is_round else "clamp-to-edge"
        raw = self.raw.create_sampler(
            address_mode_u=across,
            address_mode_v="clamp-to-edge",
            address_mode_w="clamp-to-edge",
            mag_filter="linear",
            min_filter="linear",
        )
        return Piece(raw, 0, raw)

    def _taken(self, kind: str, size: int, n_bytes: int) -> Piece:
        library, is_buffer = _library(), kind.startswith("buffer")
        with self._lock:
            idle = self._idle.get((kind, size))
            if not idle and self.held_bytes + n_bytes > ROOMY_BYTES:
                self.forget_idle()
            if idle:
                raw, view = idle.pop()
                self._idle_bytes -= n_bytes
            elif is_buffer:
                use = library.BufferUsage
                usage = use.STORAGE | use.COPY_SRC | use.COPY_DST
                raw, view = self.raw.create_buffer(size=size, usage=usage), None
                self._hold(n_bytes)
            else:
                use = library.TextureUsage
                usage = use.TEXTURE_BINDING | use.STORAGE_BINDING | use.COPY_DST
                raw = self.raw.create_texture(size=(TEXELS_A_ROW, size, 1), format=kind, usage=usage)
                view = raw.create_view()
                self._hold(n_bytes)
        piece = Piece(raw, size if is_buffer else size * TEXELS_A_ROW, view)
        weakref.finalize(piece, self._given_back, kind, size, n_bytes, raw, view).atexit = False
        return piece

    def _given_back(self, kind: str, size: int, n_bytes: int, raw: Any, view: Any) -> None:
        with self._lock:
            if kind == "buffer that stays" or self._idle_bytes + n_bytes > IDLE_BYTES:
                raw.destroy()
                self._hold(-n_bytes)
                return
            self._idle.setdefault((kind, size), []).append((raw, view))
            self._idle_bytes += n_bytes

    def forget_idle(self) -> None:
        """Give idle pieces back to the driver: what comes next is of other sizes."""
        with self._lock:
            for (kind, size), idle in self._idle.items():
                for raw, _ in idle:
                    raw.destroy()
                    self._hold(-size if kind == "buffer" else -size * TEXELS_A_ROW * TEXEL_BYTES)
            self._idle.clear()
            self._idle_bytes = 0

    def write(self, piece: Piece, values: NDArray[Any]) -> None:
        """Fill the beginning of a buffer."""
        if values.nbytes:
            self.raw.queue.write_buffer(piece.raw, 0, np.ascontiguousarray(values))

    def write_table(self, piece: Piece, values: NDArray[np.float32]) -> None:
        """Fill the beginning of a table from texels, shape (n, 4); float32 or uint32."""
        whole = len(values) // TEXELS_A_ROW
        for start, n_rows, n_columns in ((0, whole, TEXELS_A_ROW), (whole, 1, len(values) - whole * TEXELS_A_ROW)):
            if n_rows == 0 or n_columns == 0:
                continue
            part = values[start * TEXELS_A_ROW : start * TEXELS_A_ROW + n_rows * n_columns]
            self.raw.queue.write_texture(
                {"texture": piece.raw, "origin": (0, start, 0)},
                np.ascontiguousarray(part),
                {"bytes_per_row": n_columns * TEXEL_BYTES, "rows_per_image": n_rows},
                (n_columns, n_rows, 1),
            )

    def commands(self) -> Commands:
        """An empty list of things to do."""
        return Commands(self)

    def read(self, *wanted: tuple[Piece, int]) -> list[NDArray[np.uint8]]:
        """The first bytes of buffers, once all that was asked for is done."""
        return self.commands().read(*wanted)

    def _kernel(self, name: str, constants: Mapping[str, Constant]) -> _Kernel:
        key = name, tuple(constants.items())
        with self._lock:
            found = self._kernels.get(key)
            if found is None:
                found = self._kernels[key] = self._compiled(shader(name, constants))
        return found

    def _compiled(self, text: str) -> _Kernel:
        library = _library()
        entries = []
        # Tables are read texel by texel; kernels with a sampler have pictures.
        of_floats = "float" if ": sampler;" in text else "unfilterable-float"
        for number, space, what in BINDING.findall(text):
            entry: dict[str, Any] = {"binding": int(number), "visibility": library.ShaderStage.COMPUTE}
            if what.startswith("texture_storage_2d"):
                texel, access = what[len("texture_storage_2d<") :].rstrip(">").split(", ")
                entry["storage_texture"] = {"format": texel, "access": f"{access}-only", "view_dimension": "2d"}
            elif what.startswith(("texture_2d", "texture_3d")):
                kind = "uint" if "u32" in what else of_floats
                entry["texture"] = {"sample_type": kind, "view_dimension": what[len("texture_") :][:2]}
            elif what == "sampler":
                entry["sampler"] = {"type": "filtering"}
            else:
                kinds = {"uniform": "uniform", "storage, read": "read-only-storage", "storage, read_write": "storage"}
                entry["buffer"] = {"type": kinds[space]}
            entries.append(entry)
        layout = self.raw.create_bind_group_layout(entries=entries)
        pipeline = self.raw.create_compute_pipeline(
            layout=self.raw.create_pipeline_layout(bind_group_layouts=[layout]),
            compute={"module": self.raw.create_shader_module(code=text), "entry_point": "main"},
        )
        return _Kernel(pipeline, layout, tuple(entry["binding"] for entry in entries))

    def uniforms(self) -> Any:
        """The buffer that all uniforms of one list of commands lie in."""
        if self._arena is None:
            use = _library().BufferUsage
            self._arena = self.raw.create_buffer(size=ARENA_BYTES, usage=use.UNIFORM | use.COPY_DST)
        return self._arena


BINDING = re.compile(r"@group\(0\) @binding\((\d+)\) var(?:<([^>]*)>)? \w+: ([^;]+);")


class Commands:
    """Kernels to run one after the other, each after what it reads is written."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._encoder = device.raw.create_command_encoder()
        self._pass: Any = None
        self._uniforms = bytearray()
        self._held: list[Any] = []

    def run(self, name: str, constants: Mapping[str, Constant], groups: int, *given: Binding) -> None:
        """Run so many workgroups of a kernel, which count them by x and then y.

        Parameters
        ----------
        given
            What its bindings are given, in their order.
        """
        if groups <= 0:
            return
        kernel = self._device._kernel(name, constants)
        if len(given) != len(kernel.bindings):
            raise ValueError(f"{name}: expected {len(kernel.bindings)} bindings, got {len(given)}")
        if len(self._uniforms) + UNIFORM_STEP * len(given) > ARENA_BYTES:
            self.submit()
        entries = [
            {"binding": number, "resource": self._resource(each)}
            for number, each in zip(kernel.bindings, given, strict=True)
        ]
        bound = self._device.raw.create_bind_group(layout=kernel.layout, entries=entries)
        if self._pass is None:
            self._pass = self._encoder.begin_compute_pass()
        self._pass.set_pipeline(kernel.raw)
        self._pass.set_bind_group(0, bound)
        across = min(groups, MOST_GROUPS)
        self._pass.dispatch_workgroups(across, -(-groups // across), 1)
        self._held.extend(given)

    def _resource(self, given: Binding) -> Any:
        if isinstance(given, Piece):
            return given.view if given.view is not None else {"buffer": given.raw}
        start = len(self._uniforms)
        self._uniforms += given
        self._uniforms += bytes(-len(self._uniforms) % UNIFORM_STEP)
        return {"buffer": self._device.uniforms(), "offset": start, "size": -(-len(given) // 16) * 16}

    def clear(self, piece: Piece, n_bytes: int) -> None:
        """Fill the beginning of a buffer with zeros."""
        self._end_pass()
        self._held.append(piece)
        if n_bytes:
            self._encoder.clear_buffer(piece.raw, 0, -(-n_bytes // 4) * 4)

    def copy_to_table(self, piece: Piece, table: Piece, texels: int) -> None:
        """Bring the beginning of a buffer, texel by texel, into a table."""
        self._end_pass()
        self._held += [piece, table]
        whole, rest = divmod(texels, TEXELS_A_ROW)
        row_bytes = TEXELS_A_ROW * TEXEL_BYTES
        for start, n_rows, n_columns in ((0, whole, TEXELS_A_ROW), (whole, 1, rest)):
            if n_rows and n_columns:
                self._encoder.copy_buffer_to_texture(
                    {"buffer": piece.raw, "offset": start * row_bytes, "bytes_per_row": row_bytes},
                    {"texture": table.raw, "origin": (0, start, 0)},
                    (n_columns, n_rows, 1),
                )

    def _end_pass(self) -> None:
        if self._pass is not None:
            self._pass.end()
            self._pass = None

    def submit(self) -> None:
        """Hand it all to the device, without waiting; the list is empty again."""
        self._end_pass()
        self._device.check()
        queue = self._device.raw.queue
        if self._uniforms:
            queue.write_buffer(self._device.uniforms(), 0, bytes(self._uniforms))
        queue.submit([self._encoder.finish()])
        self.__init__(self._device)  # type: ignore[misc]

    def read(self, *wanted: tuple[Piece, int]) -> list[NDArray[np.uint8]]:
        """Hand it all to the device, wait once, and read the first bytes of some buffers."""
        self._end_pass()
        use = _library().BufferUsage
        sizes = [rounded_up(max(n_bytes, 1), MAPPED_STEP) * MAPPED_STEP for _, n_bytes in wanted]
        if len(wanted) > 1 and sum(sizes) > self._device.most_bytes:
            return [self.read(each)[0] for each in wanted]
        copy = self._device.raw.create_buffer(size=sum(sizes), usage=use.COPY_DST | use.MAP_READ)
        self._device._hold(sum(sizes))
        start = 0
        for (piece, _), size in zip(wanted, sizes, strict=True):
            self._encoder.copy_buffer_to_buffer(piece.raw, 0, copy, start, size)
            start += size
        self.submit()
        copy.map_sync("READ")
        raw = np.frombuffer(copy.read_mapped(), np.uint8)
        copy.unmap()
        copy.destroy()
        self._device._hold(-sum(sizes))
        starts = np.cumsum([0, *sizes])
        return [raw[start : start + n_bytes] for start, (_, n_bytes) in zip(starts, wanted, strict=False)]


def uniform(*values: int | float) -> bytes:
    """Numbers as a kernel's uniform has them: u32 and f32, padded to 16 bytes."""
    packed = b"".join(struct.pack("<I" if isinstance(value, int) else "<f", value) for value in values)
    return packed + bytes(-len(packed) % 16)


def _rounded(size: int, step: int = 256) -> int:
    """A size of few: the next quarter of a power of two, and a multiple of the step."""
    quarter = max(1 << max((size - 1).bit_length() - 3, 0), step)
    return -(-size // quarter) * quarter


_OPEN: dict[tuple[Adapter, int | None, bool], Device] = {}


def open_device(adapter: Adapter | None = None, most_bytes: int | None = None, subgroups: bool = True) -> Device:
    """The device of an adapter, by default the first one; opened once.

    Parameters
    ----------
    most_bytes
        Of one buffer, where that is less than the adapter has.
    subgroups
        Whether lanes may use subgroup operations where the adapter has them.

    Raises
    ------
    ReconstructionError
        There is none, or it does not open.
    """
    if reason := why_no_gpu():
        raise ReconstructionError(say("no graphics card can be used: {}; or compute on the processor", reason))
    raw_of = dict(_found())
    chosen = adapter or adapters()[0]
    key = chosen, most_bytes, subgroups
    if key not in _OPEN:
        library = _library()
        try:
            _OPEN[key] = _opened(chosen, raw_of[chosen], most_bytes, subgroups)
        except (library.GPUError, RuntimeError) as error:
            # What wgpu raises where there is no device for an adapter is a RuntimeError.
            raise ReconstructionError(
                say("the graphics card {} does not open ({}); compute on the processor instead", chosen.name, error)
            ) from error
    return _OPEN[key]


def forget(device: Device) -> None:
    """Open the adapter anew the next time."""
    for key, each in tuple(_OPEN.items()):
        if each is device:
            del _OPEN[key]


LEAST_BINDING = 128 << 20
"""That every WebGPU device has."""
LARGEST_BINDING = (1 << 31) - 4
PROBE_LANES = 8


def _opened(adapter: Adapter, raw: Any, most_bytes: int | None, subgroups: bool) -> Device:
    limits = raw.limits
    bytes_there = min(limits["max-storage-buffer-binding-size"], limits["max-buffer-size"], LARGEST_BINDING)
    features = ["subgroup"] if subgroups and "subgroup" in raw.features else []
    wanted = {"max-storage-buffer-binding-size": bytes_there, "max-buffer-size": bytes_there}
    opened = raw.request_device_sync(required_features=features, required_limits=wanted)
    device = Device(adapter, opened, min(bytes_there, most_bytes or bytes_there), 32, False)
    if features:
        # Where the driver may choose among sizes, nothing is known of a kernel but the least of them.
        least = raw.info.get("stackgroup_min_size", raw.info.get("subgroup_min_size", 0))
        lanes = 32 if least >= 32 else PROBE_LANES
        if least < PROBE_LANES:
            lanes = PROBE_LANES if _lanes_of(device) >= PROBE_LANES else 0
        if lanes:
            device.group, device.has_subgroups = lanes, True
    return device


def _lanes_of(device: Device) -> int:
    """Of subgroups, as a small kernel finds them."""
    found = device.buffer(4)
    commands = device.commands()
    commands.run("probe", {"LANES": PROBE_LANES}, 1, found)
    return int(commands.read((found, 4))[0].view(np.uint32)[0])


def rounded_up(number: int, step: int) -> int:
    """Parts of `step` that hold so many."""
    return -(-number // step)
