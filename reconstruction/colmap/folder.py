"""A COLMAP model as a folder: cameras, images and points in binary or text files.

COLMAP 3.12 added files about rigs and frames. The images' own poses stand in the images file as before, which is all
that is read here.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_lines, make_folder, read_input_file
from planning.base.json_file import encoded, plain_values, read_json, to_record, write_atomically
from planning.base.messages import say
from planning.geo.frames import Origin
from reconstruction.colmap.record import (
    N_PARAMETERS,
    NAMES,
    NO_POINT,
    NO_POINTS,
    NUMBERS,
    OTHERS,
    ColmapCamera,
    ColmapImage,
    ColmapModel,
    ColmapPoints,
    check_camera,
    unsupported_camera_model,
)

# COLMAP's binary files, little-endian (colmap.github.io, "Output Format").
#
# A count in a file is believed only as far as the file is long enough to hold that many of the smallest entries.

CAMERA_HEAD = struct.Struct("<IiQQ")
IMAGE_HEAD = struct.Struct("<I7dI")
POINT_HEAD = struct.Struct("<Q3d3BdQ")
COUNT = struct.Struct("<Q")

OBSERVATION = np.dtype([("px", "<f8", 2), ("point", "<i8")])
TRACK = np.dtype([("image", "<u4"), ("index", "<u4")])
POINT = np.dtype([("id", "<u8"), ("xyz", "<f8", 3), ("rgb", "u1", 3), ("error", "<f8"), ("length", "<u8")])
"""As `POINT_HEAD`."""

SMALLEST_IMAGE = IMAGE_HEAD.size + 1 + COUNT.size

MAX_NAME_BYTES = 4096


class _Reader:
    """The bytes of one file, read from front to back."""

    def __init__(self, content: bytes, place: str) -> None:
        self._content, self.at, self._place = content, 0, place

    def take(self, layout: struct.Struct) -> tuple[int | float, ...]:
        """The next values."""
        self._need(layout.size)
        values = layout.unpack_from(self._content, self.at)
        self.at += layout.size
        return values

    def count(self, smallest: int) -> int:
        """A number of entries of which each takes at least `smallest` bytes."""
        n = int(self.take(COUNT)[0])
        left = len(self._content) - self.at
        if n * smallest > left:
            raise InputError(
                say(
                    "byte {} says that {} entries follow, but the {} bytes left hold at most {}; the file is damaged "
                    "or cut off: write it again",
                    self.at - COUNT.size,
                    n,
                    left,
                    left // smallest,
                    place=self._place,
                )
            )
        return n

    def array(self, dtype: np.dtype[np.void], n: int) -> np.ndarray:
        """The next `n` entries."""
        self._need(n * dtype.itemsize)
        values = np.frombuffer(self._content, dtype, n, self.at)
        self.at += n * dtype.itemsize
        return values

    def skip(self, n: int) -> None:
        """Pass over bytes, which have to be there."""
        self._need(n)
        self.at += n

    def name(self) -> str:
        """Text up to a zero byte."""
        end = self._content.find(b"\0", self.at, self.at + MAX_NAME_BYTES)
        if end < 0:
            raise InputError(
                say("the image name at byte {} has no end; the file is damaged", self.at, place=self._place)
            )
        text = self._content[self.at : end].decode("utf-8", "surrogateescape")
        self.at = end + 1
        return text

    def _need(self, n: int) -> None:
        if self.at + n > len(self._content):
            raise InputError(
                say(
                    "ends at byte {} in the middle of an entry; write the file again",
                    len(self._content),
                    place=self._place,
                )
            )


def read_cameras_binary(content: bytes, place: str) -> list[ColmapCamera]:
    """Cameras of `cameras.bin`."""
    reader = _Reader(content, place)
    cameras = []
    for _ in range(reader.count(CAMERA_HEAD.size + 8 * min(N_PARAMETERS.values()))):
        camera_id, number, width, height = map(int, reader.take(CAMERA_HEAD))
        model = NAMES.get(number)
        if model is None:
            raise unsupported_camera_model(camera_id, OTHERS.get(number, say("number {}", number)), place)
        parameters = reader.take(struct.Struct(f"<{N_PARAMETERS[model]}d"))
        cameras.append(ColmapCamera(camera_id, model, width, height, parameters))
    return cameras


def read_images_binary(content: bytes, place: str) -> list[ColmapImage]:
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


def read_points_binary(content: bytes, place: str) -> ColmapPoints:
    """Points of `points3D.bin`."""
    reader = _Reader(content, place)
    n = reader.count(POINT_HEAD.size)
    if n == 0:
        return NO_POINTS
    # Entries differ in length, so where each begins is known from all before it; all else is taken out at once.
    starts, lengths = np.empty(n, np.int64), np.empty(n, np.int64)
    for i in range(n):
        starts[i] = reader.at
        *head, length = reader.take(POINT_HEAD)
        if length * TRACK.itemsize > len(content):
            raise InputError(
                say(
                    "point {} says that {} observations follow, more than the file holds; it is damaged or cut off: "
                    "write it again",
                    int(head[0]),
                    int(length),
                    place=place,
                )
            )
        lengths[i] = length
        reader.skip(int(length) * TRACK.itemsize)
    table, is_track = np.frombuffer(content, np.uint8)[: reader.at], np.ones(reader.at, bool)
    places = starts[:, None] + np.arange(POINT_HEAD.size)
    heads = table[places].view(POINT)[:, 0]
    is_track[places] = False
    is_track[: COUNT.size] = False
    every = table[is_track].view(TRACK)
    return ColmapPoints(
        heads["id"].astype(np.int64),
        heads["xyz"].astype(np.float64),
        heads["rgb"].copy(),
        heads["error"].astype(np.float64),
        np.concatenate([[0], np.cumsum(lengths)]),
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


# COLMAP's text files (colmap.github.io, "Output Format"). Numbers are written so that they come back bit for bit.

UNSIGNED_NO_POINT = str(2**64 - 1)
"""How some versions write that an observation is of no point."""

HEAD = {
    "cameras": "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n",
    "images": (
        "# Image list with two lines of data per image:\n"
        "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
        "#   POINTS2D[] as (X, Y, POINT3D_ID)\n"
    ),
    "points": (
        "# 3D point list with one line of data per point:\n"
        "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
    ),
}


def read_cameras_text(content: str, place: str) -> list[ColmapCamera]:
    """Cameras of `cameras.txt`."""
    cameras = []
    for number, line in _lines(content):
        parts = line.split()
        try:
            camera_id, model, width, height = int(parts[0]), parts[1], int(parts[2]), int(parts[3])
            cameras.append(ColmapCamera(camera_id, model, width, height, tuple(map(float, parts[4:]))))
        except (ValueError, IndexError) as error:
            raise _bad_line(place, number, "CAMERA_ID MODEL WIDTH HEIGHT PARAMS", line) from error
    return cameras


def read_images_text(content: str, place: str) -> list[ColmapImage]:
    """Images of `images.txt`: names run to the end of their line, and an image may have no observations."""
    images = []
    lines = _lines(content, keep_empty=True)
    for number, line in lines:
        if not line.strip():
            continue
        parts = line.split(maxsplit=9)
        try:
            image_id, camera_id, name = int(parts[0]), int(parts[8]), parts[9].rstrip("\r\n")
            w, x, y, z, *t = map(float, parts[1:8])
        except (ValueError, IndexError) as error:
            raise _bad_line(place, number, "IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME", line) from error
        number, line = next(lines, (number + 1, ""))
        parts = line.replace(UNSIGNED_NO_POINT, str(NO_POINT)).split()
        try:
            points_px = np.array([parts[0::3], parts[1::3]], np.float64).T.reshape(-1, 2)
            point_ids = np.array(parts[2::3], np.int64)
            if 3 * len(point_ids) != len(parts):
                raise ValueError("not three numbers each")
        except (ValueError, OverflowError) as error:
            if len(parts) > 9 and parts[0].isdigit() and parts[8].isdigit() and not parts[9].isdigit():
                raise InputError.say(
                    "expected the observations of '{}', or an empty line, found the next image; every image has two "
                    "lines",
                    name,
                    place=say("{}, line {}", place, number),
                ) from error
            raise _bad_line(place, number, "X Y POINT3D_ID ...", line) from error
        images.append(ColmapImage(image_id, (w, x, y, z), (t[0], t[1], t[2]), camera_id, name, points_px, point_ids))
    return images


def read_points_text(content: str, place: str) -> ColmapPoints:
    """Points of `points3D.txt`."""
    ids, rows, tracks = [], [], []
    for number, line in _lines(content):
        parts = line.split()
        try:
            ids.append(int(parts[0]))
            rows.append([*map(float, parts[1:4]), *map(int, parts[4:7]), float(parts[7])])
            tracks.append(np.array(parts[8:], np.int64).reshape(-1, 2))
            if not all(0 <= value <= 255 for value in rows[-1][3:6]):
                raise ValueError("a colour is outside 0 to 255")
        except (ValueError, IndexError, OverflowError) as error:
            raise _bad_line(place, number, "POINT3D_ID X Y Z R G B ERROR IMAGE_ID POINT2D_IDX ...", line) from error
    if not ids:
        return NO_POINTS
    table = np.array(rows, np.float64)
    return ColmapPoints(
        np.array(ids, np.int64),
        table[:, :3].copy(),
        table[:, 3:6].astype(np.uint8),
        table[:, 6].copy(),
        np.concatenate([[0], np.cumsum([len(track) for track in tracks])]).astype(np.int64),
        np.concatenate(tracks),
    )


def _lines(content: str, keep_empty: bool = False) -> Iterator[tuple[int, str]]:
    """Lines with their numbers from 1, without comments. Line breaks are those of files, not all that Unicode has."""
    for number, line in enumerate(content.split("\n"), 1):
        if not line.startswith("#") and (keep_empty or line.strip()):
            yield number, line


def _bad_line(place: str, number: int, columns: str, line: str) -> InputError:
    """The error about a line of a text file that lacks columns of COLMAP's format or has no numbers in them."""
    found = line if len(line) <= 80 else f"{line[:77]}..."
    return InputError.say(
        "expected the columns {}, found '{}'; export the model again with COLMAP",
        columns,
        found.strip(),
        place=say("{}, line {}", place, number),
    )


def cameras_text(cameras: Sequence[ColmapCamera]) -> str:
    """Content of `cameras.txt`."""
    rows = (
        f"{c.id} {c.model} {c.width_px} {c.height_px} {' '.join(map(repr, map(float, c.parameters)))}\n"
        for c in cameras
    )
    return HEAD["cameras"] + f"# Number of cameras: {len(cameras)}\n" + "".join(rows)


def images_text(images: Sequence[ColmapImage]) -> str:
    """Content of `images.txt`."""
    mean = sum(len(image.point_ids) for image in images) / max(1, len(images))
    parts = [HEAD["images"], f"# Number of images: {len(images)}, mean observations per image: {mean!r}\n"]
    for image in images:
        pose = " ".join(map(repr, map(float, (*image.q_wxyz, *image.t))))
        seen = zip(image.points_px.tolist(), image.point_ids.tolist(), strict=True)
        parts.append(f"{image.id} {pose} {image.camera_id} {image.name}\n")
        parts.append(" ".join(f"{x!r} {y!r} {point}" for (x, y), point in seen) + "\n")
    return "".join(parts)


def points_text(points: ColmapPoints) -> str:
    """Content of `points3D.txt`."""
    mean = len(points.tracks) / max(1, len(points))
    parts = [HEAD["points"], f"# Number of points: {len(points)}, mean track length: {mean!r}\n"]
    for i in range(len(points)):
        start, stop = points.starts[i : i + 2].tolist()
        numbers = [int(points.ids[i]), *points.xyz[i].tolist(), *points.rgb[i].tolist(), float(points.errors_px[i])]
        numbers += points.tracks[start:stop].reshape(-1).tolist()
        parts.append(" ".join(map(repr, numbers)) + "\n")
    return "".join(parts)


FileKind = Literal["bin", "txt"]

FILE_NAMES = ("cameras", "images", "points3D", "rigs", "frames")

USUAL_PLACES = ("sparse/0", "sparse", "0", "colmap/sparse/0", "dense/sparse", "dense/0/sparse", "")
"""Of models, in folders of COLMAP, of nerfstudio and of data sets for splats."""

COLMAP_FILE, MAX_LINES = FileLimit("a file of a COLMAP model", 8192 * MIB), 5_000_000
"""A model of ten thousand 20-megapixel photos has about 3 GiB of observations."""

Content = TypeVar("Content")


def read_model(folder: Path) -> ColmapModel:
    """Model in a folder; binary files go before text, and a model may have no points.

    Raises
    ------
    InputError
        There is no model, a file is damaged, or a camera is of a model that is not understood.
    """
    kind = _kind(folder)
    cameras: list[ColmapCamera] = _read(folder, "cameras", kind, read_cameras_binary, read_cameras_text)
    images: list[ColmapImage] = _read(folder, "images", kind, read_images_binary, read_images_text)
    points: ColmapPoints = NO_POINTS
    if (folder / f"points3D.{kind}").exists():
        points = _read(folder, "points3D", kind, read_points_binary, read_points_text)
    model = ColmapModel({camera.id: camera for camera in cameras}, {image.id: image for image in images}, points)
    for what, n, n_ids in (
        ("cameras", len(cameras), len(model.cameras)),
        ("images", len(images), len(model.images)),
        ("images", len(images), len({image.name for image in images})),
    ):
        if n != n_ids:
            raise InputError(
                say("holds {} {} twice, by id or by name", n - n_ids, what, place=folder / f"{what}.{kind}")
            )
    check_model(model, str(folder))
    return model


def check_model(model: ColmapModel, place: str) -> None:
    """Raise `InputError` unless all numbers are finite, poses are poses, and every image has a known camera."""
    for camera in model.cameras.values():
        check_camera(camera, place)
    for image in model.images.values():
        if image.camera_id not in model.cameras:
            raise InputError(
                say("image '{}' has camera {}, which is not in the model", image.name, image.camera_id, place=place)
            )
        numbers = np.concatenate([image.q_wxyz, image.t, image.points_px.ravel()])
        if not np.isfinite(numbers).all() or not any(image.q_wxyz):
            raise InputError(
                say("image '{}' holds a number that is not finite, or no rotation", image.name, place=place)
            )
    if not np.isfinite(model.points.xyz).all():
        raise InputError(say("a 3-D point has a coordinate that is not finite", place=place))


def write_model(folder: Path, model: ColmapModel, kind: FileKind = "bin") -> None:
    """Write a model into a folder that holds none yet.

    Raises
    ------
    InputError
        The folder holds files of another model, cannot be written, or a name cannot stand in a text file.
    """
    there = [f"{name}.{end}" for name in FILE_NAMES for end in ("bin", "txt") if (folder / f"{name}.{end}").exists()]
    if there:
        raise InputError(say("holds a COLMAP model already ({}); name an empty folder", ", ".join(there), place=folder))
    cameras, images = list(model.cameras.values()), list(model.images.values())
    if kind == "txt":
        _check_names(images)
    contents = {
        "cameras": cameras_bytes(cameras) if kind == "bin" else _encoded(cameras_text(cameras)),
        "images": images_bytes(images) if kind == "bin" else _encoded(images_text(images)),
        "points3D": points_bytes(model.points) if kind == "bin" else _encoded(points_text(model.points)),
    }
    make_folder(folder)
    for name, content in contents.items():
        write_atomically(folder / f"{name}.{kind}", content)


def _check_names(images: Sequence[ColmapImage]) -> None:
    for image in images:
        if image.name != image.name.strip() or not image.name.isprintable():
            raise InputError(
                say(
                    "image '{}': a name with spaces at its ends or control characters cannot stand in COLMAP's text "
                    "files; write the binary ones",
                    image.name,
                )
            )


def _kind(folder: Path) -> FileKind:
    kind = _kind_in(folder)
    if kind is not None:
        return kind
    within = model_within(folder)
    if within is not None:
        raise InputError(
            say(
                "expected a COLMAP model (cameras and images as .bin or .txt); this folder has one in {}: name that",
                within,
                place=folder,
            )
        )
    if folder.is_file():
        raise InputError(
            say(
                "expected the folder of a COLMAP model (cameras and images as .bin or .txt), found a file; "
                "Metashape writes one by Export Cameras as Colmap, and nerfstudio's ns-process-data leaves one in "
                "colmap/sparse/0",
                place=folder,
            )
        )
    found = say("a folder without them") if folder.is_dir() else say("no folder")
    raise InputError(
        say(
            "expected a COLMAP model (cameras and images as .bin or .txt), found {}; models are often in sparse/0",
            found,
            place=folder,
        )
    )


def _kind_in(folder: Path) -> FileKind | None:
    kinds: tuple[FileKind, ...] = ("bin", "txt")
    for kind in kinds:
        if (folder / f"cameras.{kind}").is_file() and (folder / f"images.{kind}").is_file():
            return kind
    return None


def model_within(folder: Path) -> Path | None:
    """The COLMAP model in a folder, where programs leave it; None where there is none."""
    return next((folder / place for place in USUAL_PLACES if _kind_in(folder / place) is not None), None)


def _read(
    folder: Path,
    name: str,
    kind: FileKind,
    of_bytes: Callable[[bytes, str], Content],
    of_text: Callable[[str, str], Any],
) -> Content:
    path = folder / f"{name}.{kind}"
    content = read_input_file(path, COLMAP_FILE)
    if kind == "bin":
        return of_bytes(content, str(path))
    check_lines(content, MAX_LINES, path)
    found: Content = of_text(content.decode("utf-8", "surrogateescape"), str(path))
    return found


def _encoded(content: str) -> bytes:
    return content.encode("utf-8", "surrogateescape")


# What stands beside a model that is in the frame of a site already.

FRAME_FILE, FRAME_FORMAT = "frame.json", "reflight-frame/1"


@dataclass(frozen=True, slots=True)
class Frame:
    """That a model's world is the local ENU frame, and how well its poses are known.

    Parameters
    ----------
    origin
        Of the frame; None where it is not said.
    """

    position_sigma_m: float
    angle_sigma_deg: float
    origin: Origin | None = None
    format: str = FRAME_FORMAT

    def __post_init__(self) -> None:
        for name in ("position_sigma_m", "angle_sigma_deg"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(say("expected more than 0, got {}", value, place=name))


def read_frame(folder: Path) -> Frame | None:
    """The frame of the model in a folder; None where nothing says it.

    Raises
    ------
    InputError
        The file that says it is damaged.
    """
    path = folder / FRAME_FILE
    return to_record(read_json(path), Frame, path) if path.is_file() else None


def write_frame(folder: Path, frame: Frame) -> None:
    """Write it beside a model."""
    write_atomically(folder / FRAME_FILE, encoded(plain_values(frame)))
