"""Renders what somebody wants to see of models and photos, in the process of models.

Models that were looked at last are kept. A photo is decoded as a training sees it: straight, without distortion.
"""

from __future__ import annotations

import colorsys
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from groundstation.services.reconstruct.messages import (
    PhotoError,
    Probe,
    Probed,
    Section,
    Subject,
    ViewAnswer,
    ViewRequest,
    WatchErrors,
)
from planning.base.errors import GroundStationError, ReconstructionError
from planning.base.messages import say
from reconstruction.training.layers import PICTURE

if TYPE_CHECKING:
    from planning.base.effects import Decision
    from reconstruction.base.cameras import PosedPhoto
    from reconstruction.light.photo_set import PhotoSet
    from reconstruction.objects.picking import Quads
    from reconstruction.splats.merged_splats import SplatsOfDetail
    from reconstruction.splats.rasterising.raster_types import RasterSettings
    from reconstruction.splats.rasterising.views import View
    from reconstruction.splats.splats import Splats
    from reconstruction.training.callbacks import TrainingSnapshot
    from reconstruction.training.devices import Draw
    from reconstruction.training.model.card_pictures import CardPictures
    from reconstruction.training.model.joint_model import SceneModel
    from reconstruction.training.model.render import PhotoErrors, Rendered
    from reconstruction.training.model.saved import TrainedModel


# Models that are looked at: read, kept, cut by a plane, coloured by panel, and asked what is where.
#
# Only the process of models (`server`) uses this: it needs torch.

MOST_MODELS = 2
"""Finished ones that are kept: the two that are compared."""

LARGE = 150_000
"""Splats of a model whose quick pictures are of fewer: others come in time as they are."""

QUICK_PX = 1.0
"""Side of the cubes whose splats are drawn as one, in a quick picture."""

TINT_SHARE = 0.45
"""Of the colour that says something about a panel, in the picture."""


@dataclass(frozen=True, slots=True, eq=False)
class ShownModel:
    """A model, and what its pictures are made with.

    Parameters
    ----------
    quads
        Its panels; None while it is in training.
    """

    model: SceneModel
    gains: Mapping[str, Any]
    settings: RasterSettings
    version: object
    learned: tuple[str, ...]
    moves: tuple[Any, ...]
    quads: Quads | None = None

    def photos(self, source: PhotoSet) -> tuple[PosedPhoto, ...]:
        """All of a data set, those that were learned from where learning light found them to be."""
        from reconstruction.training.photos.poses import moved

        if not self.moves:
            return source.photos
        found = {photo.name: photo for photo in moved(source.named(self.learned), self.moves)}
        return tuple(found.get(photo.name, photo) for photo in source.photos)


class ShownModels:
    """Finished ones by folder, be they trained models or scenes of objects; those looked at last are kept."""

    def __init__(self) -> None:
        self._models: OrderedDict[tuple[Path, int], ShownModel] = OrderedDict()
        self._cuts: OrderedDict[SceneModel, tuple[Section, SceneModel]] = OrderedDict()
        self._of_detail: OrderedDict[SceneModel, SplatsOfDetail | None] = OrderedDict()

    def of(self, folder: Path) -> ShownModel:
        """Read, unless it is kept and its file has not changed.

        Raises
        ------
        InputError
            The folder holds no model, or a damaged one.
        """
        path = next((path for path in _descriptions(folder) if path.is_file()), None)
        key = folder, 0 if path is None else path.stat().st_mtime_ns
        if key not in self._models:
            self._models[key] = shown_of(_read(folder))
        self._models.move_to_end(key)
        while len(self._models) > MOST_MODELS:
            self._models.popitem(last=False)
        return self._models[key]

    def cut(self, shown: ShownModel, section: Section | None) -> SceneModel:
        """A model without what lies beyond a plane; the last one of each of two models is kept."""
        model = shown.model
        if section is None:
            return model
        known = self._cuts.get(model)
        if known is None or known[0] != section:
            self._cuts[model] = known = section, model.with_splats(_cut(model.splats, section, model.origin_enu_m))
        self._cuts.move_to_end(model)
        while len(self._cuts) > MOST_MODELS:
            self._cuts.popitem(last=False)
        return known[1]

    def quick(self, shown: ShownModel, section: Section | None, view: View) -> SceneModel:
        """A model for one picture: of a large finished one, splats finer than pixels as one, none out of sight."""
        model = shown.model
        detail = self._detail(model) if _is_large(shown) else None
        if detail is None:
            return self.cut(shown, section)
        splats = detail.for_view(view, QUICK_PX)
        return model.with_splats(splats if section is None else _cut(splats, section, model.origin_enu_m))

    def prepare(self) -> bool:
        """Make a large model ready for quick pictures, which takes seconds; whether there was one."""
        for shown in self._models.values():
            if _is_large(shown) and shown.model not in self._of_detail:
                self._detail(shown.model)
                return True
        return False

    def _detail(self, model: SceneModel) -> SplatsOfDetail | None:
        """None where there is no memory for it."""
        from reconstruction.base.out_of_memory import is_out_of_memory
        from reconstruction.splats.merged_splats import splats_of_detail

        if model not in self._of_detail:
            self._of_detail[model] = None
            try:
                self._of_detail[model] = splats_of_detail(model.splats)
            except (MemoryError, RuntimeError) as error:
                if not is_out_of_memory(error):
                    raise
        self._of_detail.move_to_end(model)
        while len(self._of_detail) > MOST_MODELS:
            self._of_detail.popitem(last=False)
        return self._of_detail[model]


def _is_large(shown: ShownModel) -> bool:
    """Whether its quick pictures are of fewer splats; one in training changes, and a graphics card needs none."""
    return (
        shown.quads is not None and len(shown.model.splats) >= LARGE and shown.model.splats.means.device.type == "cpu"
    )


def _cut(splats: Splats, section: Section, origin_enu_m: NDArray[np.float64]) -> Splats:
    """What a section leaves."""
    along = splats.means.detach()[:, section.axis] + float(origin_enu_m[section.axis])
    return splats.some((along <= section.at_m) if section.is_above else (along >= section.at_m))


def shown_of(trained: TrainedModel) -> ShownModel:
    """A finished model."""
    from reconstruction.objects.picking import Quads

    record = trained.record
    gains = {name: trained.exposures(number) for number, name in enumerate(record.learned)}
    settings = replace(record.config.raster, threads=0)
    quads = Quads.of(record.site.planes.corners_enu_m)
    return ShownModel(trained.model, gains, settings, trained, record.learned, record.moves, quads)


def tinted(
    picture: NDArray[np.uint8], quads: Quads, look: ViewRequest, depth_m: NDArray[np.float32]
) -> NDArray[np.uint8]:
    """A picture with panels in colours that say something about them.

    Parameters
    ----------
    depth_m
        Of the picture, by which what stands before a panel keeps its own colour.
    """
    from reconstruction.objects.picking import panel_map

    # The last row is that of no panel: -1.
    colours = np.zeros((len(quads.normals) + 1, 3), np.float32)
    shares = np.zeros((len(quads.normals) + 1, 1), np.float32)
    for panel, colour in look.tints:
        if 0 <= panel < len(quads.normals):
            colours[panel], shares[panel] = colour, TINT_SHARE
    panels = panel_map(quads, look.camera, depth_m)
    if look.section is not None:
        # What a section has taken away has left its panels empty.
        panels[~np.isfinite(depth_m)] = -1
    mixed = picture * (1.0 - shares[panels]) + colours[panels] * shares[panels]
    return np.asarray(np.round(mixed), np.uint8)


def probed(probe: Probe, shown: ShownModel, model: SceneModel) -> Probed:
    """What is at a place in a picture.

    Parameters
    ----------
    model
        Of `shown`, or what a section leaves of it.
    """
    from reconstruction.objects.picking import picked, rays_of
    from reconstruction.splats.rasterising.views import View
    from reconstruction.training.model.render import render_view

    camera, place = probe.camera, np.array([probe.at_px])
    lens, (x, y) = camera.intrinsics, probe.at_px
    column, row = int(min(max(x, 0), lens.width_px - 1)), int(min(max(y, 0), lens.height_px - 1))
    view = View.of(camera, model.origin_enu_m).cropped(column, row, 1, 1)
    depth_m = float(render_view(model, view, ("depth",), 1.0, shown.settings).layers["depth"][0, 0])
    ray, origin = rays_of(camera, place)[0], camera.pose.position_enu_m
    if shown.quads is not None:
        panel = int(picked(shown.quads, camera, place, np.array([depth_m]))[0])
        if panel >= 0 and (probe.section is None or np.isfinite(depth_m)):
            _, distances = shown.quads.first_hits(origin, ray[None])
            return Probed(probe, panel, _point(origin + distances[0] * ray))
    if not np.isfinite(depth_m) or depth_m <= 0.0:
        return Probed(probe, None, None)
    return Probed(probe, None, _point(origin + depth_m / float(ray @ camera.pose.forward_enu) * ray))


def _descriptions(folder: Path) -> tuple[Path, ...]:
    """Files that tell of a model in a folder, as objects or as it was trained."""
    from reconstruction.objects.store import DESCRIPTION as SCENE
    from reconstruction.training.parameters import MODEL

    return folder / SCENE, folder / MODEL


def _read(folder: Path) -> TrainedModel:
    """The model of a folder of either kind."""
    from reconstruction.objects.organise import put_together
    from reconstruction.objects.store import read_scene
    from reconstruction.training.model.saved import read_model

    scene = _descriptions(folder)[0]
    return put_together(read_scene(folder), scene) if scene.is_file() else read_model(folder)


def _point(at: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in at)
    return x, y, z


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


class PictureDevices:
    """What draws pictures of models: the graphics card where that is faster, else the processor; see `devices`.

    A model is decided about when nobody waits for a picture. Once the card has failed, the processor draws until
    the user chooses anew.
    """

    def __init__(self) -> None:
        self._decided: OrderedDict[object, Decision] = OrderedDict()
        self._undecided: tuple[object, Draw, int] | None = None
        self._on_card: OrderedDict[SceneModel, CardPictures] = OrderedDict()
        self._lost: tuple[str, str] | None = None

    def by_card(self, shown: ShownModel, wanted: str) -> tuple[bool, str]:
        """Whether the card draws a model, and why; "" where that is not decided yet.

        Parameters
        ----------
        wanted
            As `ViewRequest` has it.
        """
        from reconstruction.gpu.device import adapters, why_no_gpu
        from reconstruction.training.devices import why_no_card

        if wanted == "cpu":
            return False, say("the processor, as you asked")
        if self._lost is not None and self._lost[0] == wanted:
            return False, self._lost[1]
        if shown.quads is None:
            return shown.settings.on_gpu, say("as its training")
        if wanted == "gpu":
            reason = why_no_gpu()
            return not reason, say("no graphics card: {}", reason) if reason else say("{}, as you asked", adapters()[0])
        found = self._decided.get(shown.version)
        return (False, why_no_card()) if found is None else (found.on, found.reason)

    def ask(self, shown: ShownModel, draw: Draw) -> None:
        """Decide about a model later, by pictures such as this one."""
        if shown.quads is not None and shown.version not in self._decided:
            self._undecided = shown.version, draw, len(shown.model.splats)

    def decide(self) -> bool:
        """Try the card with what was asked last; whether there was anything."""
        from reconstruction.training.devices import shown_by_card

        if self._undecided is None:
            return False
        (version, draw, n_splats), self._undecided = self._undecided, None
        self._decided[version] = shown_by_card(draw, n_splats, "auto")
        if not any(decision.on for decision in self._decided.values()):
            self._on_card.clear()
        while len(self._decided) > MOST_MODELS:
            self._decided.popitem(last=False)
        return True

    def on_card(self, model: SceneModel) -> CardPictures | None:
        """A finished model, or what a section leaves of it, that stays on the card; None where it cannot."""
        from reconstruction.gpu.device import open_device
        from reconstruction.training.model.card_pictures import CardPictures, can_stay

        if model not in self._on_card:
            if not can_stay(model):
                return None
            self._on_card[model] = CardPictures(model, open_device())
        self._on_card.move_to_end(model)
        while len(self._on_card) > MOST_MODELS:
            self._on_card.popitem(last=False)
        return self._on_card[model]

    def leave(self, wanted: str, reason: str) -> str:
        """Draw by the processor from now on, as the card has failed; what to tell the user."""
        self._on_card.clear()
        self._lost = wanted, say("the processor goes on: {}", reason)
        return self._lost[1]


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
        self._models, self._devices = ShownModels(), PictureDevices()
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

    def keep_placed(self, model: SceneModel, settings: RasterSettings) -> None:
        """The model that a training begins with."""
        self._training = ShownModel(model, {}, settings, model, (), ())

    def keep_snapshot(self, visit: TrainingSnapshot) -> None:
        """The model in training, as it is now."""
        learned, moves = visit.record.get("learned", ()), visit.record.get("moves", ())
        gains = {name: visit.exposures(number) for number, name in enumerate(learned)}
        self._training = ShownModel(visit.model, gains, visit.settings, visit.model, tuple(learned), tuple(moves))

    def keep_trained(self, trained: TrainedModel) -> None:
        """The model that a training ended with."""
        self._training = shown_of(trained)

    def chosen(self, visit: TrainingSnapshot) -> tuple[str, tuple[Decision, ...]]:
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

    def answer(self, look: ViewRequest) -> ViewAnswer:
        """Answer a look."""
        begun_s = time.perf_counter()
        try:
            if look.subject.kind == "photo":
                return ViewAnswer(look, self._photo(look), seconds=time.perf_counter() - begun_s)
            return self._rendered(look, self._subject(look.subject), begun_s)
        except GroundStationError as error:
            return ViewAnswer(look, None, problem=str(error))
        except (MemoryError, RuntimeError) as error:
            return ViewAnswer(
                look, None, problem=say("the picture could not be rendered ({}); make the window smaller", error)
            )

    def _rendered(self, look: ViewRequest, shown: ShownModel, begun_s: float) -> ViewAnswer:
        from reconstruction.splats.rasterising.views import View

        gain = shown.gains.get(look.exposed_as, 1.0)
        wanted = ("depth",) if look.layer == PICTURE else (*dict.fromkeys(("depth", look.layer)),)
        view = View.of(look.camera, shown.model.origin_enu_m)

        def draw(on_card: bool) -> Rendered:
            return self._drawn(look, shown, view, wanted, gain, on_card)

        (by_card, why), lost = self._devices.by_card(shown, look.drawn_by), ""
        try:
            found = draw(by_card)
        except ReconstructionError as error:
            if not by_card:
                raise
            lost = why = self._devices.leave(look.drawn_by, str(error))
            by_card, found = False, draw(False)
        if look.drawn_by == "auto" and not why and not look.is_quick:
            self._devices.ask(shown, lambda on_card: draw(on_card).display)
        values = found.display if look.layer == PICTURE else found.layers[look.layer]
        picture, scale = coloured(look.layer, values)
        depth = found.layers["depth"]
        if look.tints and shown.quads is not None:
            picture = tinted(picture, shown.quads, look, depth)
        middle = float(depth[depth.shape[0] // 2, depth.shape[1] // 2])
        depth_m = middle if np.isfinite(middle) and middle > 0.0 else None
        seconds = time.perf_counter() - begun_s
        return ViewAnswer(look, picture, scale, depth_m, seconds, by_card=by_card, drawn_by=why, lost=lost)

    def _drawn(
        self,
        look: ViewRequest,
        shown: ShownModel,
        view: View,
        layers: tuple[str, ...],
        gain: Any,
        on_card: bool,
    ) -> Rendered:
        """A picture of a model; a card draws large ones whole, as quickly as others."""
        from reconstruction.training.model.render import render_view

        models, is_quick = self._models, look.is_quick and not on_card
        model = models.quick(shown, look.section, view) if is_quick else models.cut(shown, look.section)
        if on_card and shown.quads is not None and look.layer == PICTURE:
            staying = self._devices.on_card(model)
            if staying is not None:
                return staying.picture(view, gain, shown.settings)
        return render_view(model, view, layers, gain, replace(shown.settings, on_gpu=on_card))

    def prepare(self) -> bool:
        """Something that later pictures come sooner by, when nobody waits; whether there was anything."""
        return self._devices.decide() or self._models.prepare()

    def probed(self, probe: Probe) -> Probed:
        """Answer a probe."""
        try:
            shown = self._subject(probe.subject)
            return probed(probe, shown, self._models.cut(shown, probe.section))
        except GroundStationError as error:
            return Probed(probe, None, None, str(error))
        except (MemoryError, RuntimeError) as error:
            return Probed(probe, None, None, say("the place could not be looked at ({})", error))

    def _photo(self, look: ViewRequest) -> NDArray[np.uint8]:
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

    def judge(self, request: WatchErrors | None, visit: TrainingSnapshot | None) -> bool:
        """Tell how well one photo is shown, where somebody wants to know; whether there is another one to tell of.

        Beside a training it takes a small share of the time, round and round; of a model that stays as it is, or whose
        training is paused, each photo is told once.
        """
        if request is None or request.subject is None:
            self._let_errors_go()
            return False
        try:
            shown = self._subject(request.subject)
            self._turn_to(request, shown)
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
            self._tell(PhotoError(request.subject, *found))
        return True

    def _turn_to(self, request: WatchErrors, shown: ShownModel) -> None:
        from reconstruction.training.model.render import PhotoErrors

        if self._errors is not None and self._errors[0] == request and self._errors[1] is shown.version:
            return
        self._let_errors_go()
        photos = shown.photos(self._source(request.dataset))
        self._errors = request, shown.version, PhotoErrors(self._source(request.dataset), photos)
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
