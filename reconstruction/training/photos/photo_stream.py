"""Photos of a data set folder as a training looks at them: read from the disk ahead of time, within a memory limit.

Which photos come up next is known (`PhotoOrder`): they are decoded in a thread while the training works, and what has
to go is the photo that is needed last, which no other rule beats (L. A. Belady, 1966). What comes out depends on the
generator alone, and not on how fast the disk is.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from types import TracebackType

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.light.photo_set import PhotoSet
from reconstruction.splats.rasterising.views import View
from reconstruction.training.photos.decoded_photo import (
    DECODING_BYTES_PER_PX,
    FACADE,
    SHOWN,
    DecodedPhoto,
    Decoding,
    decode_photo,
    decoded_bytes,
    normal_step_of,
)

# In which order photos are looked at, known some time ahead, so that they can be read before they are needed.
#
# Where all photos fit into memory, each comes up once before any comes up again. Where they do not, some are at hand:
# each sample is of a random one of them, and one that has been looked at a number of times makes room for the next
# one
# of a round through all photos. So every photo is read once a round, one at a time and not all at once, and all are
# looked at equally often.

State = dict[str, list[int]]


class PhotoOrder:
    """A random order that goes on for ever.

    Parameters
    ----------
    sizes
        Bytes of each photo in memory.
    room
        Bytes for those at hand; one is at hand always.
    uses
        Of a photo while it is at hand, where not all fit.
    """

    def __init__(self, sizes: Sequence[int], room: int, uses: int) -> None:
        self._sizes = tuple(sizes)
        self.all_fit = sum(sizes) <= room
        self._room = room
        self._uses = 1 if self.all_fit else uses
        self._left: list[int] = []
        self._at_hand: dict[int, int] = {}
        self.upcoming: list[int] = []

    def look_ahead(self, n: int, generator: torch.Generator) -> None:
        """Draw until `n` samples are known in advance."""
        while len(self.upcoming) < n:
            self._fill(generator)
            drawn = int(torch.randint(len(self._at_hand), (), generator=generator))
            number = [*self._at_hand][drawn]
            self.upcoming.append(number)
            self._at_hand[number] -= 1
            if not self._at_hand[number]:
                del self._at_hand[number]

    def needed(self) -> list[int]:
        """Photos that come up again for certain, the soonest first."""
        return [*dict.fromkeys([*self.upcoming, *self._at_hand])]

    def _fill(self, generator: torch.Generator) -> None:
        """Take photos to hand while there is room; where all fit, a new round waits for the end of the last one."""
        if self.all_fit and self._at_hand:
            return
        while True:
            if not self._left:
                self._left = torch.randperm(len(self._sizes), generator=generator).tolist()
            number = self._left[0]
            if self._at_hand and not self.all_fit:
                at_hand = {*self._at_hand, number}
                if sum(self._sizes[each] for each in at_hand) > self._room:
                    return
            self._at_hand[number] = self._at_hand.get(number, 0) + self._uses
            del self._left[0]
            if self.all_fit and not self._left:
                return

    def state_dict(self) -> State:
        """What goes into a checkpoint."""
        return {
            "upcoming": [*self.upcoming],
            "left": [*self._left],
            "at_hand": [*self._at_hand],
            "uses_left": [*self._at_hand.values()],
        }

    def load_state_dict(self, state: State) -> None:
        """Go on from a checkpoint.

        Raises
        ------
        ValueError
            It is of other photos.
        """
        if not {*state["upcoming"], *state["left"], *state["at_hand"]} <= {*range(len(self._sizes))}:
            raise ValueError(f"state: expected photos 0 to {len(self._sizes) - 1}; it is of other photos")
        self.upcoming, self._left = [*state["upcoming"]], [*state["left"]]
        self._at_hand = dict(zip(state["at_hand"], state["uses_left"], strict=True))


DEFAULT_BYTES = 1 << 30

AHEAD = 2
"""Samples that are known before they are needed, and photos that are on their way at a time."""


@dataclass(frozen=True, slots=True)
class StreamSettings:
    """How photos are held.

    Parameters
    ----------
    memory_bytes
        For decoded photos, those being decoded included.
    window_px
        Pixels of a sample at most: a random window of larger photos, with their ratio of width to height.
    reduce
        See `Decoding`.
    with_normals
        Whether samples have normals.
    uses
        Samples of each photo while it is at hand, where not all photos fit. With 1 every sample reads a photo, 0.7
        seconds of work for one of 20 megapixels; the more, the longer a training sees the same few views.
    """

    memory_bytes: int = DEFAULT_BYTES
    window_px: int | None = None
    reduce: int = 1
    with_normals: bool = False
    uses: int = 4

    def __post_init__(self) -> None:
        for name in ("memory_bytes", "reduce", "uses"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name}: expected 1 or more, got {getattr(self, name)}")
        if self.window_px is not None and self.window_px < 1:
            raise ValueError(f"window_px: expected 1 or more, got {self.window_px}")


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A photo, or a window of it.

    Parameters
    ----------
    number
        Of the photo in `PhotoStream.photos`.
    view
        The window's own camera.
    display
        sRGB, shape (h, w, 3), uint8.
    facade
        Panels and the frames between them, shape (h, w), bool.
    panels
        Which panel a pixel shows, from 0, shape (h, w), int32; -1 for none.
    normals
        Unit normals turned to the camera, shape (h, w, 3), float32, 0 where there is none; None where not asked for.
    shown
        What the photo shows, shape (h, w), bool: masks, and corners of straightened photos, are black. None: all of it.
    x_px, y_px
        Of the window's first pixel in the photo.
    """

    number: int
    view: View
    display: Tensor
    facade: Tensor
    panels: Tensor
    normals: Tensor | None
    shown: Tensor | None
    x_px: int
    y_px: int

    def scored_pixels(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_] | None]:
        """Of the facade, and of all that the photo shows (None for all of it): what pictures of it are scored on."""
        facade = self.facade.numpy()
        shown = None if self.shown is None else self.shown.numpy()
        return facade if shown is None else facade & shown, shown


class PhotoStream:
    """Random photos of a folder, or random windows of them; to be closed, or used in a `with` block.

    Parameters
    ----------
    names
        Of the photos to use; None for all.
    origin_enu_m
        Of the model's frame, shape (3,).

    Raises
    ------
    InputError
        There are no such photos, or the memory limit is too small for one of them.
    """

    def __init__(
        self,
        source: PhotoSet,
        names: Collection[str] | None,
        origin_enu_m: NDArray[np.float64],
        settings: StreamSettings | None = None,
    ) -> None:
        self.settings = settings or StreamSettings()
        self.photos = source.photos if names is None else source.named(names)
        if not self.photos:
            raise InputError(say("has none of the photos to be used; name a folder that has them", place=source.folder))
        self.window_px = self.settings.window_px
        self.n_read = 0
        self._source, self._origin_enu_m = source, np.asarray(origin_enu_m, float)
        self._decoding = Decoding(self.settings.reduce, self.settings.with_normals)
        self._normal_step = normal_step_of(source.folder) if self.settings.with_normals else 1
        self._sizes = [decoded_bytes(photo.intrinsics, self._decoding, self._normal_step) for photo in self.photos]
        self._room = self._room_for_photos()
        # Where not all fit, those that come up last before they go are held beside those at hand.
        at_hand = self._room if sum(self._sizes) <= self._room else self._room - AHEAD * max(self._sizes)
        self._order = PhotoOrder(self._sizes, at_hand, self.settings.uses)
        self._held: dict[int, DecodedPhoto] = {}
        self._pending: dict[int, Future[DecodedPhoto]] = {}
        self._reader = ThreadPoolExecutor(1, "photo-reader")

    def _room_for_photos(self) -> int:
        """Bytes for photos that are held: the limit less what one takes while it is decoded."""
        pixels = max(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in self.photos)
        needed = DECODING_BYTES_PER_PX * pixels + max(self._sizes)
        if needed > self.settings.memory_bytes:
            raise InputError(
                say(
                    "its photos take {:.0f} MiB each while they are read, more than the limit of {:.0f} MiB; allow "
                    "more memory, or take smaller photos",
                    needed / 2**20,
                    self.settings.memory_bytes / 2**20,
                    place=self._source.folder,
                )
            )
        return self.settings.memory_bytes - DECODING_BYTES_PER_PX * pixels

    def __enter__(self) -> PhotoStream:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Wait for the photo that is being read, and give all memory back."""
        self._reader.shutdown(wait=True, cancel_futures=True)
        self.forget()

    def forget(self) -> None:
        """Give the memory of all photos back; they are read again when they come up."""
        for future in self._pending.values():
            future.cancel()
        self._pending.clear()
        self._held.clear()

    @property
    def all_fit(self) -> bool:
        """Whether each photo is read once, and held from then on."""
        return self._order.all_fit

    @property
    def held_bytes(self) -> int:
        """Of photos in memory and of those on their way; at most the limit less what decoding takes."""
        return sum(self._sizes[number] for number in {*self._held, *self._pending})

    def sample(self, generator: torch.Generator) -> Sample:
        """The next photo, or a random window of it.

        Raises
        ------
        InputError
            A file is missing or damaged; the message names it.
        """
        self._order.look_ahead(1 + AHEAD, generator)
        number = self._order.upcoming.pop(0)
        photo = self._photo(number)
        height, width = photo.flags.shape
        window_width, window_height = self._window(width, height)
        x = int(torch.randint(width - window_width + 1, (), generator=generator))
        y = int(torch.randint(height - window_height + 1, (), generator=generator))
        cut = self._cut(number, photo, x, y, window_width, window_height)
        self._read_ahead()
        return cut

    def frame(self, number: int) -> Sample:
        """A whole photo; it is held only if it was.

        Raises
        ------
        InputError
            As for `sample`.
        """
        photo = self._held.get(number) or self._submitted(number).result()
        height, width = photo.flags.shape
        return self._cut(number, photo, 0, 0, width, height)

    def state_dict(self) -> State:
        """What a checkpoint needs, besides the generator's state, to go on with the same samples."""
        return self._order.state_dict()

    def load_state_dict(self, state: State) -> None:
        """Go on from a checkpoint of a stream of the same photos and settings.

        Raises
        ------
        ValueError
            It is of other photos.
        """
        self._order.load_state_dict(state)

    def _window(self, width: int, height: int) -> tuple[int, int]:
        """Width and height of windows."""
        if self.window_px is None or self.window_px >= width * height:
            return width, height
        scale = math.sqrt(self.window_px / (width * height))
        return max(1, int(width * scale)), max(1, int(height * scale))

    def _photo(self, number: int) -> DecodedPhoto:
        if number not in self._held:
            future = self._pending.pop(number, None)
            if future is None:
                self._make_room(number, [])
                future = self._submitted(number)
            self._held[number] = future.result()
        return self._held[number]

    def _read_ahead(self) -> None:
        needed = self._order.needed()
        for place, number in enumerate(needed):
            if len(self._pending) == AHEAD:
                return
            if number not in self._held and number not in self._pending:
                if not self._make_room(number, needed[:place]):
                    return
                self._pending[number] = self._submitted(number)

    def _make_room(self, number: int, sooner: Sequence[int]) -> bool:
        """Drop photos, those first that are needed last, until one more fits; those needed `sooner` stay."""
        if self.held_bytes + self._sizes[number] <= self._room:
            return True
        place = {each: k for k, each in enumerate(self._order.needed())}
        for last in sorted({*self._held} - {*sooner}, key=lambda held: place.get(held, len(place)), reverse=True):
            del self._held[last]
            if self.held_bytes + self._sizes[number] <= self._room:
                return True
        return False

    def _submitted(self, number: int) -> Future[DecodedPhoto]:
        self.n_read += 1
        return self._reader.submit(decode_photo, self._source, self.photos[number], self._decoding, self._normal_step)

    def _cut(self, number: int, photo: DecodedPhoto, x: int, y: int, width: int, height: int) -> Sample:
        rows, columns = slice(y, y + height), slice(x, x + width)
        flags = photo.flags[rows, columns]
        normals = photo.normals_enu(x, y, width, height)
        is_shown = flags & SHOWN > 0
        return Sample(
            number,
            View.of(photo.photo, self._origin_enu_m).cropped(x, y, width, height),
            torch.from_numpy(photo.display[rows, columns].copy()),
            torch.from_numpy(flags & FACADE > 0),
            torch.from_numpy(photo.panels[rows, columns].astype(np.int32) - 1),
            None if normals is None else torch.from_numpy(np.ascontiguousarray(normals)),
            None if is_shown.all() else torch.from_numpy(is_shown),
            x,
            y,
        )
