"""COLMAP's binary files, little-endian (colmap.github.io, "Output Format").

A count in a file is believed only as far as the file is long enough to hold that many of the smallest entries.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

import numpy as np

from planning.base.errors import InputError
from reconstruction.colmap.camera_models import N_PARAMETERS, NAMES, NUMBERS, OTHERS, refuse
from reconstruction.colmap.record import NO_POINT, NO_POINTS, ColmapCamera, ColmapImage, ColmapPoints

CAMERA_HEAD = struct.Struct("<IiQQ")
IMAGE_HEAD = struct.Struct("<I7dI")
POINT_HEAD = struct.Struct("<Q3d3BdQ")
COUNT = struct.Struct("<Q")

OBSERVATION = np.dtype([("px", "<f8", 2), ("point", "<i8")])
TRACK = np.dtype([("image", "<u4"), ("index", "<u4")])

SMALLEST_IMAGE = IMAGE_HEAD.size + 1 + COUNT.size

MAX_NAME_BYTES = 4096


class _Reader:
    """The bytes of one file, read from front to back."""

    def __init__(self, content: bytes, place: str) -> None:
        self._content, self._at, self._place = content, 0, place

    def take(self, layout: struct.Struct) -> tuple[int | float, ...]:
        """The next values."""
        self._need(layout.size)
        values = layout.unpack_from(self._content, self._at)
        self._at += layout.size
        return values

    def count(self, smallest: int) -> int:
        """A number of entries of which each takes at least `smallest` bytes."""
        n = int(self.take(COUNT)[0])
        left = len(self._content) - self._at
        if n * smallest > left:
            raise InputError(
                f"{self._place}: byte {self._at - COUNT.size} says that {n} entries follow, but the {left} bytes left "
                f"hold at most {left // smallest}; the file is damaged or cut off: write it again"
            )
        return n

    def array(self, dtype: np.dtype[np.void], n: int) -> np.ndarray:
        """The next `n` entries."""
        self._need(n * dtype.itemsize)
        values = np.frombuffer(self._content, dtype, n, self._at)
        self._at += n * dtype.itemsize
        return values

    def name(self) -> str:
        """Text up to a zero byte."""
        end = self._content.find(b"\0", self._at, self._at + MAX_NAME_BYTES)
        if end < 0:
            raise InputError(f"{self._place}: the image name at byte {self._at} has no end; the file is damaged")
        text = self._content[self._at : end].decode("utf-8", "surrogateescape")
        self._at = end + 1
        return text

    def _need(self, n: int) -> None:
        if self._at + n > len(self._content):
            raise InputError(
                f"{self._place}: ends at byte {len(self._content)} in the middle of an entry; write the file again"
            )


def read_cameras(content: bytes, place: str) -> list[ColmapCamera]:
    """Cameras of `cameras.bin`."""
    reader = _Reader(content, place)
    cameras = []
    for _ in range(reader.count(CAMERA_HEAD.size + 8 * min(N_PARAMETERS.values()))):
        camera_id, number, width, height = map(int, reader.take(CAMERA_HEAD))
        model = NAMES.get(number)
        if model is None:
            raise refuse(camera_id, OTHERS.get(number, f"number {number}"), place)
        parameters = reader.take(struct.Struct(f"<{N_PARAMETERS[model]}d"))
        cameras.append(ColmapCamera(camera_id, model, width, height, parameters))
    return cameras


def read_images(content: bytes, place: str) -> list[ColmapImage]:
    """Images of `images.bin`."""
    reader = _Reader(content, place)
    images = []
    for _ in range(reader.count(SMALLEST_IMAGE)):
        image_id, w, x, y, z, *t, camera_id = reader.take(IMAGE_HEAD)
        name = reader.name()
        seen = reader.array(OBSERVATION, reader.count(OBSERVATION.itemsize))
        images.append(
            ColmapImage(
                int(image_id),
                (w, x, y, z),
                (t[0], t[1], t[2]),
                int(camera_id),
                name,
                seen["px"].astype(np.float64),
                seen["point"].astype(np.int64),
            )
        )
    return images


def read_points(content: bytes, place: str) -> ColmapPoints:
    """Points of `points3D.bin`."""
    reader = _Reader(content, place)
    n = reader.count(POINT_HEAD.size)
    if n == 0:
        return NO_POINTS
    heads, tracks = [], []
    for _ in range(n):
        *head, length = reader.take(POINT_HEAD)
        if int(length) * TRACK.itemsize > len(content):
            raise InputError(
                f"{place}: point {int(head[0])} says that {int(length)} observations follow, more than the file holds; "
                "it is damaged or cut off: write it again"
            )
        heads.append(head)
        tracks.append(reader.array(TRACK, int(length)))
    table = np.array([head[1:] for head in heads], np.float64)
    every = np.concatenate(tracks)
    return ColmapPoints(
        np.array([head[0] for head in heads], np.uint64).astype(np.int64),
        table[:, :3].copy(),
        table[:, 3:6].astype(np.uint8),
        table[:, 6].copy(),
        np.concatenate([[0], np.cumsum([len(track) for track in tracks])]).astype(np.int64),
        np.stack([every["image"], every["index"]], axis=1).astype(np.int64),
    )


def cameras_bytes(cameras: Sequence[ColmapCamera]) -> bytes:
    """Content of `cameras.bin`."""
    parts = [COUNT.pack(len(cameras))]
    for camera in cameras:
        parts.append(CAMERA_HEAD.pack(camera.id, NUMBERS[camera.model], camera.width_px, camera.height_px))
        parts.append(struct.pack(f"<{len(camera.parameters)}d", *camera.parameters))
    return b"".join(parts)


def images_bytes(images: Sequence[ColmapImage]) -> bytes:
    """Content of `images.bin`."""
    parts = [COUNT.pack(len(images))]
    for image in images:
        parts.append(IMAGE_HEAD.pack(image.id, *image.q_wxyz, *image.t, image.camera_id))
        parts.append(image.name.encode("utf-8", "surrogateescape") + b"\0")
        seen = np.zeros(len(image.point_ids), OBSERVATION)
        seen["px"], seen["point"] = image.points_px, np.where(image.point_ids < 0, NO_POINT, image.point_ids)
        parts += [COUNT.pack(len(seen)), seen.tobytes()]
    return b"".join(parts)


def points_bytes(points: ColmapPoints) -> bytes:
    """Content of `points3D.bin`."""
    tracks = np.zeros(len(points.tracks), TRACK)
    tracks["image"], tracks["index"] = points.tracks[:, 0], points.tracks[:, 1]
    return b"".join([COUNT.pack(len(points)), *_point_parts(points, tracks)])


def _point_parts(points: ColmapPoints, tracks: np.ndarray) -> Iterable[bytes]:
    for i in range(len(points)):
        start, stop = points.starts[i : i + 2].tolist()
        yield POINT_HEAD.pack(
            int(points.ids[i]), *points.xyz[i], *points.rgb[i].tolist(), float(points.errors_px[i]), stop - start
        )
        yield tracks[start:stop].tobytes()
