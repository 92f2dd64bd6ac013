"""Renders what somebody wants to see of models and photos, in the process of models.

Models that were looked at last are kept. A photo is decoded as a training sees it: straight, without distortion.
"""

from __future__ import annotations

import colorsys
import time
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from groundstation.services.reconstruct.messages import Look, PhotoError, Probe, Probed, Seen, Subject, WatchErrors
from groundstation.services.reconstruct.shown_models import ShownModel, ShownModels, probed, shown_of, tinted
from planning.base.errors import GroundStationError
from planning.base.messages import say
from reconstruction.training.layers import PICTURE

if TYPE_CHECKING:
    from planning.base.effects import Decision
    from reconstruction.light.photo_set import PhotoSet
    from reconstruction.training.callbacks import Visit
    from reconstruction.training.model.photo_errors import PhotoErrors
    from reconstruction.training.model.saved import TrainedModel


# Layers of a model as pictures that somebody can look at.

LIGHT = frozenset({"picture", "diffuse", "reflection", "mirrored"})
"""sRGB already."""

SHARES = frozenset({"reflectivity", "fresnel", "alpha"})

GOLDEN_TURN = 0.618033988749895
"""Of the hue, from one panel to the next: neighbours differ as much as can be."""

NOTHING = 40
"""Grey of pixels where a layer has no value."""

OUTLIERS = 2.0
"""Per cent of depths at either end that have the colours of the ends."""

Picture = NDArray[np.uint8]


def coloured(layer: str, values: NDArray[np.float32]) -> tuple[Picture, tuple[float, float] | None]:
    """A layer as a picture, shape (h, w, 3), red, green, blue; and the values at the ends of its colours, if any.

    Parameters
    ----------
    values
        As `render_view` has them: shape (h, w) or (h, w, 3); infinite depths are nothing.
    """
    if layer in LIGHT:
        return _bytes(values), None
    if layer == "normals":
        picture = _bytes(0.5 * (values + 1.0))
        picture[np.abs(values).max(axis=2) == 0.0] = NOTHING
        return picture, None
    if layer == "panels":
        return _numbered(values.astype(np.int64)), None
    if layer in SHARES:
        return _mapped(values, 0.0, 1.0), (0.0, 1.0)
    known = values[np.isfinite(values)]
    if not len(known):
        return np.full((*values.shape, 3), NOTHING, np.uint8), None
    low, high = (float(each) for each in np.percentile(known, (OUTLIERS, 100.0 - OUTLIERS)))
    high = max(high, low + 1e-3)
    return _mapped(values, low, high), (low, high)


def _bytes(values: NDArray[np.float32]) -> Picture:
    return np.asarray(np.round(255.0 * np.nan_to_num(values).clip(0.0, 1.0)), np.uint8)


def _mapped(values: NDArray[np.float32], low: float, high: float) -> Picture:
    is_known = np.isfinite(values)
    share = np.where(is_known, (values - low) / (high - low), 0.0).astype(np.float32)
    mapped = np.asarray(cv2.applyColorMap(_bytes(share), cv2.COLORMAP_VIRIDIS), np.uint8)
    picture = np.ascontiguousarray(mapped[..., ::-1])
    picture[~is_known] = NOTHING
    return picture


def _numbered(numbers: NDArray[np.int64]) -> Picture:
    n_panels = int(numbers.max(initial=-1)) + 1
    hues = [colorsys.hsv_to_rgb((GOLDEN_TURN * number) % 1.0, 0.65, 0.9) for number in range(n_panels)]
    palette = np.array([*hues, (NOTHING / 255.0,) * 3])
    colours: Picture = np.round(255.0 * palette).astype(np.uint8)
    return colours[np.where(numbers >= 0, numbers, n_panels)]


MOST_PHOTOS = 8
"""Decoded ones that are kept."""

JUDGING_SHARE = 0.03
"""Of a training's time, for looking at photos one by one."""

NO_MODEL = say("there is no model yet: it is being prepared")


class RenderQueue:
    """Answers looks, and judges photos.

    Parameters
    ----------
    tell
        Takes messages.
    """

    def __init__(self, tell: Callable[[Any], None]) -> None:
        self._tell = tell
        self._training: ShownModel | None = None
        self._models = ShownModels()
        self._photos: OrderedDict[tuple[Path, str], NDArray[np.uint8]] = OrderedDict()
        self._sources: dict[Path, PhotoSet] = {}
        self._errors: tuple[WatchErrors, object, PhotoErrors] | None = None
        self._n_left, self._judged_s, self._since_s = 0, 0.0, 0.0
        self._was_paused = False

    # Models

    def forget_training(self) -> None:
        """Another training begins."""
        self._training = None
        self._sources.clear()
        self._photos.clear()

    def keep_visit(self, visit: Visit) -> None:
        """The model in training, as it is now."""
        learned, moves = visit.record.get("learned", ()), visit.record.get("moves", ())
        gains = {name: visit.exposures(number) for number, name in enumerate(learned)}
        self._training = ShownModel(visit.model, gains, visit.settings, visit.model, tuple(learned), tuple(moves))

    def keep_trained(self, trained: TrainedModel) -> None:
        """The model that a training ended with."""
        self._training = shown_of(trained)

    def chosen(self, visit: Visit) -> tuple[str, tuple[Decision, ...]]:
        """The model of mirrored light of a training, and the decisions about it."""
        from planning.base.effects import Decision

        light = visit.record.get("light")
        decisions = tuple(Decision(**each) for each in visit.record.get("decisions", ()))
        return ("" if light is None else str(light["name"])), decisions

    def _subject(self, subject: Subject) -> ShownModel:
        if subject.kind == "training":
            if self._training is None:
                raise GroundStationError(NO_MODEL)
            return self._training
        assert subject.folder is not None
        return self._models.of(subject.folder)

    # Pictures

    def seen(self, look: Look) -> Seen:
        """Answer a look."""
        begun_s = time.perf_counter()
        try:
            if look.subject.kind == "photo":
                return Seen(look, self._photo(look), seconds=time.perf_counter() - begun_s)
            return self._rendered(look, self._subject(look.subject), begun_s)
        except GroundStationError as error:
            return Seen(look, None, problem=str(error))
        except (MemoryError, RuntimeError) as error:
            return Seen(
                look, None, problem=say("the picture could not be rendered ({}); make the window smaller", error)
            )

    def _rendered(self, look: Look, shown: ShownModel, begun_s: float) -> Seen:
        from reconstruction.splats.rasterising.views import View
        from reconstruction.training.model.render import render_view

        gain = shown.gains.get(look.exposed_as, 1.0)
        wanted = ("depth",) if look.layer == PICTURE else (*dict.fromkeys(("depth", look.layer)),)
        view = View.of(look.camera, shown.model.origin_enu_m)
        models = self._models
        model = models.quick(shown, look.section, view) if look.is_quick else models.cut(shown, look.section)
        found = render_view(model, view, wanted, gain, shown.settings)
        values = found.display if look.layer == PICTURE else found.layers[look.layer]
        picture, scale = coloured(look.layer, values)
        depth = found.layers["depth"]
        if look.tints and shown.quads is not None:
            picture = tinted(picture, shown.quads, look, depth)
        middle = float(depth[depth.shape[0] // 2, depth.shape[1] // 2])
        seconds = time.perf_counter() - begun_s
        return Seen(look, picture, scale, middle if np.isfinite(middle) and middle > 0.0 else None, seconds)

    def prepare(self) -> bool:
        """Something that later pictures come sooner by, when nobody waits; whether there was anything."""
        return self._models.prepare()

    def probed(self, probe: Probe) -> Probed:
        """Answer a probe."""
        try:
            shown = self._subject(probe.subject)
            return probed(probe, shown, self._models.cut(shown, probe.section))
        except GroundStationError as error:
            return Probed(probe, None, None, str(error))
        except (MemoryError, RuntimeError) as error:
            return Probed(probe, None, None, say("the place could not be looked at ({})", error))

    def _photo(self, look: Look) -> NDArray[np.uint8]:
        import cv2

        folder, name = look.subject.folder, look.subject.name
        assert folder is not None
        key = folder, name
        if key not in self._photos:
            self._photos[key] = _decoded(self._source(folder), name)
        self._photos.move_to_end(key)
        while len(self._photos) > MOST_PHOTOS:
            self._photos.popitem(last=False)
        lens = look.camera.intrinsics
        picture = self._photos[key]
        way = cv2.INTER_AREA if lens.width_px < picture.shape[1] else cv2.INTER_LINEAR
        return np.asarray(cv2.resize(picture, (lens.width_px, lens.height_px), interpolation=way), np.uint8)

    def _source(self, folder: Path) -> PhotoSet:
        from reconstruction.light.photo_set import read_photo_set

        if folder not in self._sources:
            self._sources[folder] = read_photo_set(folder)
        return self._sources[folder]

    # Photos, one by one

    def judge(self, wanted: WatchErrors | None, visit: Visit | None) -> bool:
        """Tell how well one photo is shown, where somebody wants to know; whether there is another one to tell of.

        Beside a training it takes a small share of the time, round and round; of a model that stays as it is, or whose
        training is paused, each photo is told once.
        """
        if wanted is None or wanted.subject is None:
            self._let_errors_go()
            return False
        try:
            shown = self._subject(wanted.subject)
            self._turn_to(wanted, shown)
        except (GroundStationError, OSError):
            self._let_errors_go()
            return False
        assert self._errors is not None
        errors, now = self._errors[2], time.monotonic()
        is_paused = visit is not None and visit.state == "paused"
        if is_paused and not self._was_paused:
            self._n_left = len(errors)
        self._was_paused = is_paused
        if visit is None or is_paused:
            if self._n_left == 0:
                return False
            if is_paused and not errors.is_ready:
                return True
            self._n_left -= 1
        elif not errors.is_ready or self._judged_s > JUDGING_SHARE * (now - self._since_s):
            return True
        found = errors.next_db(shown.model, shown.gains, shown.settings)
        self._judged_s += time.monotonic() - now
        if found is not None:
            self._tell(PhotoError(wanted.subject, *found))
        return True

    def _turn_to(self, wanted: WatchErrors, shown: ShownModel) -> None:
        from reconstruction.training.model.photo_errors import PhotoErrors

        if self._errors is not None and self._errors[0] == wanted and self._errors[1] is shown.version:
            return
        self._let_errors_go()
        photos = shown.photos(self._source(wanted.dataset))
        self._errors = wanted, shown.version, PhotoErrors(self._source(wanted.dataset), photos)
        self._n_left, self._judged_s, self._since_s = len(photos), 0.0, time.monotonic()
        self._was_paused = False

    def _let_errors_go(self) -> None:
        if self._errors is not None:
            self._errors[2].close()
            self._errors = None


def _decoded(source: PhotoSet, name: str) -> NDArray[np.uint8]:
    """A photo, straight, red, green, blue, shape (h, w, 3)."""
    from planning.base.errors import InputError
    from reconstruction.training.photos.decoded_photo import Decoding, decode_photo

    photos = source.named((name,))
    if not photos:
        raise InputError(say("has no photo '{}'", name, place=source.folder))
    return decode_photo(source, photos[0], Decoding(), 1).display
