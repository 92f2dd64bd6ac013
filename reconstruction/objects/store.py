"""A scene of objects on the disk: a folder with `gsscene.json`, and a file for each component and auxiliary part.

Files are named after their content and written first; `gsscene.json`, which names them with their checksums, is
replaced last, in one step. So a folder that had a scene has a whole one at every moment. A component can be read
without the others, and an element without the rest of its component.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from planning.base.errors import InputError
from planning.base.files import check_input_file, make_folder, open_input_file
from planning.base.json_file import expect_format, read_json, to_record, write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin, Vec3
from reconstruction.base.tensor_files import TENSORS_FILE
from reconstruction.objects.gs_scene import Array, GsAuxiliary, GsComponent, GsElement, GsGaussian, GsScene, Kind

# From where a building is seen at first: square before its largest facade.
#
# Far enough away to see all of it, there may be the house across the street; where photos were taken, there was not.


LEAST_M = 2.0
"""Before the facade's plane."""


def places_of(training: Mapping[str, Any]) -> Array:
    """Where a scene's photos were taken, ENU, shape (k, 3); of models that do not know it none."""
    return _vectors(training, "places_enu_m")


def usual_look(training: Mapping[str, Any]) -> tuple[Array, Array] | None:
    """Place and forward direction, ENU, of the photo taken in the midst of the others; None where that is not known."""
    places, forwards = places_of(training), _vectors(training, "forwards_enu")
    if not len(places) or places.shape != forwards.shape:
        return None
    number = int(np.argmin(np.linalg.norm(places - np.median(places, axis=0), axis=1)))
    length = float(np.linalg.norm(forwards[number]))
    return (places[number], forwards[number] / length) if length > 0.0 else None


def _vectors(training: Mapping[str, Any], name: str) -> Array:
    try:
        found = np.asarray(training.get(name, ()), np.float64).reshape(-1, 3)
    except (TypeError, ValueError):
        return np.zeros((0, 3))
    return found[np.isfinite(found).all(axis=1)]


def outward(corners_enu_m: Array) -> Array | None:
    """Mean unit normal of panels, shape (3,); None where they have no side in common.

    Parameters
    ----------
    corners_enu_m
        Shape (n, 4, 3), counter-clockwise as seen from outside.
    """
    normal = np.cross(corners_enu_m[:, 2] - corners_enu_m[:, 0], corners_enu_m[:, 3] - corners_enu_m[:, 1]).sum(axis=0)
    length = float(np.linalg.norm(normal))
    return normal / length if length > 1e-9 else None


def middle_of(corners_enu_m: Array) -> Array:
    """Of the box around panels, shape (3,)."""
    points = corners_enu_m.reshape(-1, 3)
    middle: Array = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return middle


def largest(facades: Sequence[Array]) -> int:
    """Which facade's panels have the largest area together; the first of several.

    Parameters
    ----------
    facades
        Corners of each one's panels, shape (n, 4, 3); at least one.
    """
    areas = [
        np.linalg.norm(np.cross(each[:, 2] - each[:, 0], each[:, 3] - each[:, 1]), axis=1).sum() for each in facades
    ]
    return int(np.argmax(areas))


def standoff_m(corners_enu_m: Array, places_enu_m: Array) -> float | None:
    """From how far photos of a facade were taken: the median over those before it; None where there are none.

    Nothing stood between them and the facade.

    Parameters
    ----------
    corners_enu_m
        Of the facade's panels, shape (n, 4, 3).
    places_enu_m
        Shape (k, 3).
    """
    normal = outward(corners_enu_m) if len(corners_enu_m) else None
    if normal is None:
        return None
    before = (places_enu_m - middle_of(corners_enu_m)) @ normal
    before = before[before >= LEAST_M]
    return float(np.median(before)) if len(before) else None


FORMAT = "reflight-gsscene/1"
DESCRIPTION = "gsscene.json"

PLACES = "places"
"""Beside what splats have, in a component's file."""

SUFFIX = ".safetensors"

LARGEST = 200_000_000
"""Gaussians of a component: more than any graphics card holds."""

COLUMNS: dict[str, tuple[tuple[int, ...], ...]] = {
    "means": ((3,),),
    "quats": ((4,),),
    "log_scales": ((2,), (3,)),
    "opacity_logits": ((),),
    "sh": ((16, 3),),
    "reflectivity_logits": ((),),
    "f0_logits": ((3,),),
}
"""What every component has, and the shapes that one row may have."""

WIDEST = 4096
"""Numbers of one row of what a method's shading adds."""


@dataclass(frozen=True, slots=True)
class StoredPart:
    """A file.

    Parameters
    ----------
    n_bytes
        Its length.
    """

    name: str
    file: str
    sha256: str
    n_bytes: int

    def __post_init__(self) -> None:
        if Path(self.file).name != self.file or not self.file.endswith(SUFFIX):
            raise ValueError(f"file: expected the name of a {SUFFIX} file beside this one, got '{self.file[:80]}'")


@dataclass(frozen=True, slots=True)
class StoredComponent(StoredPart):
    """A component's file, and all of the component but its Gaussians.

    Parameters
    ----------
    min_enu_m, max_enu_m
        Of the means; None where it has none.
    """

    kind: Kind
    global_id: str
    n_gaussians: int
    min_enu_m: Vec3 | None
    max_enu_m: Vec3 | None
    elements: tuple[GsElement, ...]

    def __post_init__(self) -> None:
        # Zero-argument super() has no class to look at in a dataclass with slots.
        StoredPart.__post_init__(self)
        if not 0 <= self.n_gaussians <= LARGEST:
            raise ValueError(f"n_gaussians: expected 0 to {LARGEST}, got {self.n_gaussians}")


@dataclass(frozen=True, slots=True)
class _Scene:
    name: str
    global_id: str
    origin: Origin | None
    origin_enu_m: Vec3
    components: tuple[StoredComponent, ...]
    auxiliary: tuple[StoredPart, ...]
    training: dict[str, Any]

    def __post_init__(self) -> None:
        if not self.components:
            raise ValueError("components: expected at least one")
        if not all(map(math.isfinite, self.origin_enu_m)):
            raise ValueError("origin_enu_m: expected finite numbers")
        elements = [element for component in self.components for element in component.elements]
        for name, found in (
            ("components", [component.name for component in self.components]),
            ("auxiliary", [part.name for part in self.auxiliary]),
            ("elements", [element.global_id for element in elements]),
            ("elements", [element.panel for element in elements]),
        ):
            if len(set(found)) != len(found):
                raise ValueError(f"{name}: expected different ones, found one twice")


def write_scene(scene: GsScene, folder: Path, monitor: Monitor = QUIET) -> None:
    """Write a whole scene; one that was there stays whole until this one is. Records beside it are left alone.

    Raises
    ------
    ValueError
        Components are missing.
    InputError
        It cannot be written.
    """
    if not scene.is_whole:
        raise ValueError("scene: expected all of its components")
    make_folder(folder)
    before = {path.name for path in folder.glob(f"*{SUFFIX}")}
    try:
        named = _write_parts(scene, folder, monitor)
    except BaseException:
        _remove_parts(folder, before)
        raise
    _remove_parts(folder, named)


def _write_parts(scene: GsScene, folder: Path, monitor: Monitor) -> set[str]:
    """Write all files; returns those that the description names."""
    n_parts = len(scene.components) + len(scene.auxiliary)
    components: list[StoredComponent] = []
    for number, component in enumerate(scene.components):
        monitor.report(say("writing components"), number, n_parts)
        table = component.gaussians
        part = _written(folder, component.name, {**table.values, PLACES: table.places})
        lowest, highest = _bounds(scene, component)
        components.append(
            StoredComponent(
                **asdict(part),
                kind=component.kind,
                global_id=component.global_id,
                n_gaussians=len(table),
                min_enu_m=lowest,
                max_enu_m=highest,
                elements=component.elements,
            )
        )
    auxiliary = []
    for number, found in enumerate(scene.auxiliary, len(components)):
        monitor.report(say("writing components"), number, n_parts)
        auxiliary.append(_written(folder, found.name, found.tensors))
    record = _Scene(
        scene.name,
        scene.global_id,
        scene.origin,
        scene.origin_enu_m,
        tuple(components),
        tuple(auxiliary),
        dict(scene.training),
    )
    content = {"format": FORMAT, **asdict(record)}
    write_atomically(folder / DESCRIPTION, json.dumps(content, indent=1, allow_nan=False).encode())
    return {part.file for part in (*components, *auxiliary)}


def _remove_parts(folder: Path, kept: Collection[str]) -> None:
    """Remove files of parts but some."""
    for path in folder.glob(f"*{SUFFIX}"):
        if path.name not in kept and re.search(rf"-[0-9a-f]{{12}}\{SUFFIX}$", path.name):
            path.unlink(missing_ok=True)


class StoredScene:
    """A scene in a folder, of which parts are read as they are asked for.

    Raises
    ------
    InputError
        There is none, or its description is damaged. So do all methods where a file is.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self._path = folder, folder / DESCRIPTION
        if not self._path.is_file():
            raise InputError(say("holds no scene of objects ({}); make one with `organise`", DESCRIPTION, place=folder))
        self._scene = self._described()

    def _described(self) -> _Scene:
        content = read_json(self._path, names_files=True)
        expect_format(content, FORMAT, self._path)
        return to_record(content, _Scene, self._path)

    def _is_another(self) -> bool:
        """Whether the scene was written anew since it was looked at, so that files of before are gone."""
        before, self._scene = self._scene, self._described()
        return self._scene != before

    @property
    def component_names(self) -> tuple[str, ...]:
        """Facades first, the background last."""
        return tuple(component.name for component in self._scene.components)

    @property
    def name(self) -> str:
        """Of the site."""
        return self._scene.name

    @property
    def global_id(self) -> str:
        """Of the scene."""
        return self._scene.global_id

    @property
    def origin(self) -> Origin | None:
        """Of the site's ENU frame on Earth, where it is known."""
        return self._scene.origin

    @property
    def heads(self) -> tuple[StoredComponent, ...]:
        """Components with their elements, without a Gaussian being read."""
        return self._scene.components

    @property
    def training(self) -> Mapping[str, Any]:
        """How the model came about, as `GsScene` has it."""
        return self._scene.training

    @property
    def n_gaussians(self) -> int:
        """Of all components."""
        return sum(component.n_gaussians for component in self._scene.components)

    def read(self, components: Collection[str] | None = None, monitor: Monitor = QUIET) -> GsScene:
        """Read the scene, each file checked against its checksum.

        Parameters
        ----------
        components
            Names of those that are wanted; None for all.
        """
        while True:
            try:
                return self._read(components, monitor)
            except InputError:
                if not self._is_another():
                    raise

    def _read(self, components: Collection[str] | None, monitor: Monitor) -> GsScene:
        unknown = set(components or ()) - set(self.component_names)
        if unknown:
            known = ", ".join(self.component_names)
            raise InputError(say("has no component '{}'; it has {}", min(unknown), known, place=self._path))
        wanted = [each for each in self._scene.components if components is None or each.name in components]
        found = []
        for number, component in enumerate(wanted):
            monitor.report(say("reading components"), number, len(wanted))
            found.append(self._component(component))
        scene = self._scene
        return GsScene(
            scene.global_id,
            scene.name,
            scene.origin,
            scene.origin_enu_m,
            tuple(found),
            tuple(GsAuxiliary(part.name, self._checked(part)) for part in scene.auxiliary),
            scene.training,
            self.n_gaussians,
        )

    def components(self) -> Iterator[GsComponent]:
        """One after the other, so that only one need be in memory."""
        return (self._component(component) for component in self._scene.components)

    def element(self, global_id: str) -> tuple[GsElement, GsGaussian]:
        """An element with its Gaussians; nothing else of the file is read, so its checksum is not looked at."""
        while True:
            try:
                return self._element(global_id)
            except InputError:
                if not self._is_another():
                    raise

    def _element(self, global_id: str) -> tuple[GsElement, GsGaussian]:
        for component in self._scene.components:
            for element in component.elements:
                if element.global_id == global_id:
                    values = self._rows(component, element.start, element.stop)
                    return element, self._table(component, values, element.n_gaussians)
        raise InputError(say("has no element with the GlobalId '{}'", global_id[:40], place=self._path))

    def _component(self, component: StoredComponent) -> GsComponent:
        table = self._table(component, self._checked(component), component.n_gaussians)
        name, kind, global_id = component.name, component.kind, component.global_id
        try:
            return GsComponent(global_id, name, kind, component.elements, table)
        except ValueError as error:
            raise InputError(say("component '{}': {}", name, error, place=self._path)) from error

    def _table(self, component: StoredComponent, values: dict[str, Array], n: int) -> GsGaussian:
        path = self.folder / component.file
        places = values.pop(PLACES, None)
        if places is None or places.dtype != np.int32 or places.shape != (n,):
            raise InputError(
                say("expected {} of int32; it is damaged, or of another program", n, place=f"{path}: {PLACES}")
            )
        missing = COLUMNS.keys() - values.keys()
        if missing:
            raise InputError(
                say("has no '{}' of Gaussians; it is damaged, or of another program", min(missing), place=path)
            )
        for name, value in values.items():
            shapes = COLUMNS.get(name)
            is_known = value.shape[1:] in shapes if shapes is not None else math.prod(value.shape[1:]) <= WIDEST
            if value.dtype != np.float32 or len(value) != n or not is_known:
                raise InputError(
                    say(
                        "expected {} rows of float32, found {} of shape {}",
                        n,
                        value.dtype,
                        value.shape,
                        place=f"{path}: {name}",
                    )
                )
            if not np.isfinite(value).all():
                raise InputError(say("holds numbers that are not finite; train again", place=f"{path}: {name}"))
        return GsGaussian(values, places)

    def _checked(self, part: StoredPart) -> dict[str, Array]:
        """All that a file has, if it is the one that was written."""
        path = self.folder / part.file
        with open_input_file(path, TENSORS_FILE) as stream:
            # A file of another length is not read to its end: it may be a very long one.
            is_same = os.fstat(stream.fileno()).st_size == part.n_bytes
            is_same = is_same and hashlib.file_digest(stream, "sha256").hexdigest() == part.sha256
        if not is_same:
            raise InputError(
                say("is not the file that {} was written with; was it changed or cut off?", DESCRIPTION, place=path)
            )
        return self._opened(part, lambda file: {name: file.get_tensor(name) for name in file.keys()})  # noqa: SIM118

    def _rows(self, part: StoredPart, start: int, stop: int) -> dict[str, Array]:
        return self._opened(part, lambda file: {name: file.get_slice(name)[start:stop] for name in file.keys()})  # noqa: SIM118

    def _opened(self, part: StoredPart, read: Any) -> dict[str, Array]:
        path = self.folder / part.file
        check_input_file(path, TENSORS_FILE)
        try:
            with safe_open(path, framework="numpy") as file:
                found: dict[str, Array] = read(file)
        except (OSError, SafetensorError, KeyError, ValueError, TypeError, IndexError) as error:
            raise InputError(say("is no safetensors file, or damaged: {}", error, place=path)) from error
        return found


def read_scene(folder: Path, components: Collection[str] | None = None, monitor: Monitor = QUIET) -> GsScene:
    """Read a scene, or some of its components by name.

    Raises
    ------
    InputError
        There is none, a file is missing or damaged, or a component is not known.
    """
    return StoredScene(folder).read(components, monitor)


def _written(folder: Path, name: str, tensors: Mapping[str, Array]) -> StoredPart:
    content = save({key: np.ascontiguousarray(value) for key, value in tensors.items()})
    digest = hashlib.sha256(content).hexdigest()
    # Names of facades are a user's own: of them only what every file system has goes into a file's name.
    plain = re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-")[:40] or "part"
    file = f"{plain}-{digest[:12]}{SUFFIX}"
    write_atomically(folder / file, content)
    return StoredPart(name, file, digest, len(content))


def _bounds(scene: GsScene, component: GsComponent) -> tuple[Vec3 | None, Vec3 | None]:
    """Of the means, ENU."""
    means = component.gaussians.values["means"]
    if not len(means):
        return None, None
    origin = np.array(scene.origin_enu_m)
    low_x, low_y, low_z = (float(value) for value in means.min(axis=0) + origin)
    high_x, high_y, high_z = (float(value) for value in means.max(axis=0) + origin)
    return (low_x, low_y, low_z), (high_x, high_y, high_z)
