"""The OpenGL widget: draws drawables by name through a pinhole, and reports the mouse. It knows nothing of sites.

A change only marks the widget for repainting; Qt paints once per turn of its event loop, and not at all while the
widget is hidden. Nothing here asks VTK to render.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
import pyvista as pv

# PyVista would load these two when the first view is made: 40 ms of the window's thread.
import vtkmodules.vtkInteractionWidgets
import vtkmodules.vtkViewsContext2D  # noqa: F401
from numpy.typing import NDArray
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QColor, QImage, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QWidget
from pyvistaqt import QtInteractor
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from groundstation.gui.application.gradual import TURN_MS
from groundstation.gui.view3d.drawables import Drawable
from groundstation.gui.view3d.orbit import Pinhole

COLOURS = "colours"

FAINTEST_EDGE_PX, FULL_EDGE_PX = 8.0, 40.0
"""Outlines of cells that are smaller on screen than the first are not drawn, for they would be all that is seen; up to
the second they grow from faint to opaque."""

VTK_POINT_SHIFT = -8.0
"""Steps by which VTK draws all dots nearer once anything in the program is shifted: through walls, tens of metres."""

DEPTH_RATIO = 1e-4
"""Nearest depth drawn as a part of the farthest: 24 bits of depth still part surfaces 2 cm apart 250 m away."""


SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "swrast", "swiftshader", "basic render driver")
"""Names that OpenGL gives itself where the processor draws: Mesa's, Google's and Microsoft's."""


@dataclass(slots=True)
class _Drawn:
    """A drawable in VTK's hands."""

    actor: vtkActor
    data: pv.PolyData
    drawable: Drawable
    edge_size_m: float
    bounds: tuple[float, ...]

    @classmethod
    def of(cls, drawable: Drawable) -> _Drawn:
        """A drawable with an actor of its own."""
        n_cells, size = drawable.cells.shape
        data = pv.PolyData()
        data.points = _points(drawable)
        cells = pv.CellArray.from_regular_cells(np.arange(n_cells * size).reshape(n_cells, size))
        (data.SetVerts if size == 1 else data.SetLines if size == 2 else data.SetPolys)(cells)
        data.point_data[COLOURS] = np.repeat(drawable.colours, size, axis=0)
        actor = _actor(data, drawable)
        if drawable.picture is not None:
            data.active_texture_coordinates = drawable.picture.uv.reshape(-1, 2)
            actor.SetTexture(_texture(drawable.picture.pixels))
        return cls(actor, data, drawable, _edge_size_m(drawable), data.GetBounds())

    @property
    def nearer(self) -> float:
        """See `Drawable`."""
        return self.drawable.nearer

    def take(self, drawable: Drawable) -> bool:
        """Draw another drawable of as many cells and the same style instead, where it is one; only what differs moves.

        After an edit by hand nearly all is where it was: made anew, a plan of 560 views took three times as long.
        """
        mine = self.drawable
        if drawable.cells.shape != mine.cells.shape or _style(drawable) != _style(mine):
            return False
        points = _points(drawable)
        if not np.array_equal(points, self.data.points):
            self.data.points = points
            self.edge_size_m, self.bounds = _edge_size_m(drawable), self.data.GetBounds()
        if not np.array_equal(drawable.colours, mine.colours):
            self.recolour(drawable.colours)
        self.drawable = drawable
        return True

    def recolour(self, colours: NDArray[np.uint8]) -> None:
        """Give the cells other colours, shape (k, 4)."""
        size = self.drawable.cells.shape[1]
        self.data.point_data[COLOURS] = np.repeat(colours, size, axis=0)
        self.data.Modified()
        self.drawable = replace(self.drawable, colours=colours)

    def stand_before(self, eye_enu_m: NDArray[np.float64]) -> None:
        """Scale about the eye, which changes depths but no pixel."""
        self.actor.SetScale(1.0 - self.nearer)
        self.actor.SetPosition(*(self.nearer * eye_enu_m))


N_TIMED = 5
"""Frames of a view that moves that are measured, behind the first."""


class Canvas(QtInteractor):  # type: ignore[misc]  # pyvistaqt has no types
    """Drawables by name, shown or hidden, seen through a pinhole.

    Multi-sampling, lamps and order-independent transparency are off: each costs a processor that draws in place of a
    graphics card more than the rest of the picture.

    Signals
    -------
    framesTimed()
        `moving_frame_s` is known; from within painting.
    started(bool)
        It can draw; whether a processor does it in place of a graphics card.
    """

    framesTimed = Signal()  # noqa: N815  (Qt's own way of naming)
    started = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent, auto_update=False, multi_samples=0)
        # Files that are dropped belong to the window, not to VTK's readers.
        self.setAcceptDrops(False)
        # The wheel moves the view and leaves the focus where it is.
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.remove_all_lights()
        self.renderer.SetUseOIT(False)
        self._drawn: dict[Hashable, list[_Drawn]] = {}
        self._hidden: set[Hashable] = set()
        self._opacities: dict[Hashable, float] = {}
        self._is_software = False
        self.smooths_at_rest = True
        self._background = ("#ffffff", "")
        self._pinhole: Pinhole | None = None
        self._is_detail_due = False
        # What is drawn for the first time is compiled for it, 70 ms in all: first frames have few layers.
        self._n_layers = 0
        self.n_painted = 0
        self._frame_times_s: list[float] | None = None
        self.moving_frame_s: float | None = None
        """How long a whole frame of a view that moves takes; None until that is measured (`time_frames`)."""
        self.is_open = True

    def time_frames(self, *, is_wanted: bool = True) -> None:
        """Measure anew how long frames of a moving view take, or no longer."""
        self.moving_frame_s, self._frame_times_s = None, [] if is_wanted else None

    def _note_frame(self, took_s: float) -> None:
        if self._frame_times_s is None:
            return
        self._frame_times_s.append(took_s)
        if len(self._frame_times_s) > N_TIMED:  # the first one compiles
            self.moving_frame_s, self._frame_times_s = float(np.median(self._frame_times_s[1:])), None
            self.framesTimed.emit()

    def close(self) -> None:
        """Free the OpenGL context. What comes after, such as the end of a job, is heard and draws nothing."""
        self.is_open = False
        self._drawn.clear()
        super().close()
        # A surface is no QObject: Qt does not tell PySide of its end, and a wrapper that is kept would be found again
        # for whatever lies at its address later, as an object of a wrong class.
        self._forget_context()

    def draw(self, name: Hashable, drawables: Sequence[Drawable]) -> None:
        """Draw these under a name, in place of what was drawn under it."""
        if not self.is_open:
            return
        wanted = [drawable for drawable in drawables if len(drawable.cells)]
        before, after = self._drawn.pop(name, []), []
        if not wanted and not before:
            return
        for drawable in wanted:
            if before and before[0].take(drawable):
                after.append(before.pop(0))
                continue
            new = _Drawn.of(drawable)
            self.renderer.AddActor(new.actor)
            if new.nearer and self._pinhole is not None:
                new.stand_before(self._pinhole.eye_enu_m)
            new.actor.GetProperty().SetOpacity(self._opacities.get(name, 1.0))
            after.append(new)
        for old in before:
            self.renderer.RemoveActor(old.actor)
        if after:
            self._drawn[name] = after
        self._detail_changed()

    def recolour(self, name: Hashable, colours: NDArray[np.uint8]) -> None:
        """Give the cells of what is drawn under a name, one drawable, other colours, shape (k, 4)."""
        if not self.is_open:
            return
        (drawn,) = self._drawn[name]
        drawn.recolour(colours)
        self.update()

    def set_shown(self, name: Hashable, is_shown: bool) -> None:
        """Show or hide what is, or will be, drawn under a name."""
        (self._hidden.discard if is_shown else self._hidden.add)(name)
        self._detail_changed()

    def set_opacity(self, name: Hashable, opacity: float) -> None:
        """Draw what is, or will be, drawn under a name so strongly, 0 to 1."""
        if opacity == self._opacities.get(name, 1.0):
            return
        self._opacities[name] = opacity
        for part in self._drawn.get(name, ()):
            part.actor.GetProperty().SetOpacity(opacity)
        self.update()

    def set_background_colour(self, colour: str, top: str = "") -> None:
        """Colour behind everything, `#rrggbb`; with `top`, a graphics card lets it go over into that one upwards.

        A processor in its place takes a fifth of a frame for that, and draws what lies between the two.
        """
        self._background = colour, top
        if self.is_open:
            low, high = np.array(_rgb(colour)), np.array(_rgb(top or colour))
            self.renderer.SetBackground(*(0.5 * (low + high) if self._is_software else low))
            self.renderer.SetBackground2(*high)
            self.renderer.SetGradientBackground(bool(top) and not self._is_software)
            self.update()

    def set_smooth(self, is_smooth: bool) -> None:
        """Smooth edges where a processor draws: for a view at rest, for it takes most of a frame's time."""
        is_smooth = is_smooth and self.smooths_at_rest
        if self.is_open and self._is_software and bool(self.renderer.GetUseFXAA()) != is_smooth:
            self.renderer.SetUseFXAA(is_smooth)
            self.update()

    def look_through(self, pinhole: Pinhole) -> None:
        """See the scene through a pinhole; its size counts only by its aspect ratio."""
        if not self.is_open:
            return
        self._pinhole = pinhole
        for drawn in self._drawn.values():
            for part in drawn:
                if part.nearer:
                    part.stand_before(pinhole.eye_enu_m)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(*pinhole.eye_enu_m)
        camera.SetFocalPoint(*(pinhole.eye_enu_m + pinhole.forward))
        camera.SetViewUp(*pinhole.up)
        camera.SetViewAngle(float(np.degrees(2.0 * np.arctan(pinhole.half_height))))
        camera.SetUseExplicitAspectRatio(True)
        camera.SetExplicitAspectRatio(pinhole.half_width / pinhole.half_height)
        self._detail_changed()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Paint in a turn of its own: in this one a whole tab is laid out and painted with it."""
        super().showEvent(event)
        self.setUpdatesEnabled(False)
        QTimer.singleShot(TURN_MS, self, lambda: self.setUpdatesEnabled(True))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Paint with the window: Qt would paint here at once, and then once more."""
        is_on = self.updatesEnabled()
        self.setUpdatesEnabled(False)
        super().resizeEvent(event)
        self.setUpdatesEnabled(is_on)

    def warm_up(self) -> None:
        """Compile what every frame needs while none is wanted yet: 50 of the 70 ms of a first frame without a card."""
        if self.is_open and self.n_painted == 0 and not self.isVisible():
            self.grabFramebuffer()

    def initializeGL(self) -> None:  # noqa: N802
        """Smooth edges where a graphics card draws; a processor in its place takes 50 ms for that: see `set_smooth`."""
        super().initializeGL()
        renderer = self.ren_win.ReportCapabilities().lower()
        self._is_software = any(name in renderer for name in SOFTWARE_RENDERERS)
        self.renderer.SetUseFXAA(not self._is_software)
        self.set_background_colour(*self._background)
        self.started.emit(self._is_software)

    def paintGL(self) -> None:  # noqa: N802
        """Draw, and count it."""
        self.n_painted += 1
        if self._is_detail_due and self.is_open:
            self._is_detail_due = False
            self._show_detail()
        is_whole = self._n_layers >= len(self._drawn)
        started_s = perf_counter()
        super().paintGL()
        if self._frame_times_s is not None and is_whole and not self.renderer.GetUseFXAA():
            self.ren_win.WaitForCompletion()
            self._note_frame(perf_counter() - started_s)
        if self._n_layers < len(self._drawn) and self.is_open:
            self._n_layers = 2 * self._n_layers + 1
            QTimer.singleShot(0, self, self._detail_changed)

    def show_all_layers(self) -> None:
        """Have the next frame be whole, whatever is compiled for it."""
        self._n_layers, self._is_detail_due = len(self._drawn), True

    def picture(self) -> NDArray[np.uint8]:
        """What is drawn, without what lies over the widget, shape (height, width, 3)."""
        self.show_all_layers()
        return image_array(self.grabFramebuffer())

    def _detail_changed(self) -> None:
        """Paint soon; the detail is looked at once, however much has changed by then."""
        self._is_detail_due = True
        self.update()

    def _show_detail(self) -> None:
        """Switch on what the layers and the distance call for; fit near and far to it."""
        depths = []
        for number, (name, drawn) in enumerate(self._drawn.items()):
            for part in drawn:
                is_shown = name not in self._hidden and number < self._n_layers
                part.actor.SetVisibility(is_shown)
                if is_shown and self._pinhole is not None:
                    nearest, farthest = _depths(part.bounds, self._pinhole)
                    depths.append((nearest, farthest))
                    if part.edge_size_m > 0.0:
                        middle = max(0.5 * (nearest + farthest), 1e-3)
                        size_px = part.edge_size_m / self._pinhole.metres_per_px(middle)
                        strength = (size_px - FAINTEST_EDGE_PX) / (FULL_EDGE_PX - FAINTEST_EDGE_PX)
                        part.actor.GetProperty().SetEdgeVisibility(strength > 0.0)
                        part.actor.GetProperty().SetEdgeOpacity(min(1.0, max(0.0, strength)))
        if depths:
            far = max(1.0, 1.05 * max(farthest for _, farthest in depths))
            near = max(DEPTH_RATIO * far, 0.95 * min(nearest for nearest, _ in depths))
            self.renderer.GetActiveCamera().SetClippingRange(min(near, 0.5 * far), far)


def image_array(image: QImage) -> NDArray[np.uint8]:
    """Pixels of an image, shape (height, width, 3)."""
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).copy()


def _rgb(colour: str) -> tuple[float, float, float]:
    shown = QColor(colour)
    return shown.redF(), shown.greenF(), shown.blueF()


def _points(drawable: Drawable) -> NDArray[np.float32]:
    """Corners of all cells, shape (k c, 3).

    Every cell has points of its own that carry its colour: fetching colours of cells costs more for every pixel.
    """
    return drawable.points_enu_m.astype(np.float32)[drawable.cells].reshape(-1, 3)


def _style(drawable: Drawable) -> tuple[float, str, float, float, int]:
    """What an actor is told once."""
    picture = 0 if drawable.picture is None else id(drawable.picture)
    return drawable.width_px, drawable.edge_colour, drawable.depth_shift, drawable.nearer, picture


def _texture(pixels: NDArray[np.uint8]) -> pv.Texture:
    """A picture that repeats; from far away it is averaged, or it would flicker as the view turns."""
    texture = pv.Texture(pixels)
    texture.repeat = texture.mipmap = texture.interpolate = True
    return texture


def _edge_size_m(drawable: Drawable) -> float:
    """Length of the edges whose outlines are drawn; 0 for none."""
    if not drawable.edge_colour:
        return 0.0
    first = drawable.points_enu_m[drawable.cells[:, :2]]
    return float(np.median(np.linalg.norm(first[:, 1] - first[:, 0], axis=1)))


def _actor(data: pv.PolyData, drawable: Drawable) -> vtkActor:
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(COLOURS)
    mapper.SetColorModeToDirectScalars()
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetLighting(False)
    look.SetLineWidth(drawable.width_px)
    look.SetPointSize(drawable.width_px)
    if drawable.edge_colour:
        look.SetEdgeColor(*_rgb(drawable.edge_colour))
    if drawable.depth_shift:
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, drawable.depth_shift)
    mapper.SetRelativeCoincidentTopologyPointOffsetParameter(drawable.depth_shift - VTK_POINT_SHIFT)
    return actor


def _depths(bounds: tuple[float, ...], pinhole: Pinhole) -> tuple[float, float]:
    """Nearest and farthest depth of a box."""
    low, high = np.array(bounds[::2]), np.array(bounds[1::2])
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    depth = float((centre - pinhole.eye_enu_m) @ pinhole.forward)
    reach = float(half @ np.abs(pinhole.forward))
    return depth - reach, depth + reach
