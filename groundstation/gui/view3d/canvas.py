"""Draws drawables by name through a pinhole, by OpenGL. It knows nothing of sites.

A change only marks the canvas for repainting; Qt paints once per turn of its event loop, and not at all while the
canvas is hidden. Nothing here asks VTK to render.

A window with an OpenGL widget in it is put together by OpenGL, all of it, whatever changed. For a graphics card that
is nothing. Where the processor draws in its place, a frame took 33 to 45 ms and another figure in a label 20 ms; so
there the canvas shows pictures of an OpenGL widget that no window has: 22 and 0.4 ms.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from time import perf_counter

import numpy as np
import pyvista as pv

# PyVista would load these two when the first view is made: 40 ms of the window's thread.
import vtkmodules.vtkInteractionWidgets
import vtkmodules.vtkViewsContext2D  # noqa: F401
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QImage,
    QOffscreenSurface,
    QOpenGLContext,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QShowEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget
from pyvistaqt import QtInteractor
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
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

GL_RENDERER = 0x1F01


@cache
def is_drawn_by_processor() -> bool:
    """Whether OpenGL has no graphics card; asked once, in a context of its own."""
    context, surface = QOpenGLContext(), QOffscreenSurface()
    surface.create()
    if not (context.create() and context.makeCurrent(surface)):
        return False
    name = str(context.functions().glGetString(GL_RENDERER)).lower()
    context.doneCurrent()
    return any(each in name for each in SOFTWARE_RENDERERS)


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


class _Surface(QtInteractor):  # type: ignore[misc]  # pyvistaqt has no types
    """What VTK draws on.

    Parameters
    ----------
    begin
        Called once its context is there.
    paint
        Given the function that draws a frame.
    """

    def __init__(
        self, parent: QWidget | None, begin: Callable[[], None], paint: Callable[[Callable[[], None]], None]
    ) -> None:
        super().__init__(parent, auto_update=False, multi_samples=0)
        self._begin, self._paint = begin, paint
        # Files that are dropped belong to the window, not to VTK's readers; so do mouse and keyboard.
        self.setAcceptDrops(False)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.remove_all_lights()
        self.renderer.SetUseOIT(False)

    def close(self) -> None:
        """Free the context."""
        super().close()
        # A surface is no QObject: Qt does not tell PySide of its end, and a wrapper that is kept would be found again
        # for whatever lies at its address later, as an object of a wrong class.
        self._forget_context()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Paint with the window: Qt would paint here at once, and then once more."""
        is_on = self.updatesEnabled()
        self.setUpdatesEnabled(False)
        super().resizeEvent(event)
        self.setUpdatesEnabled(is_on)

    def initializeGL(self) -> None:  # noqa: N802
        """Begin to draw."""
        super().initializeGL()
        self._begin()

    def paintGL(self) -> None:  # noqa: N802
        """Draw a frame."""
        self._paint(super().paintGL)

    def draw(self) -> None:
        """Draw a frame that Qt shows nowhere."""
        self.ren_win.GetState().Reset()
        self.ren_win.Render()

    def pixels(self) -> QImage:
        """The frame, as VTK holds it: through Qt's own framebuffer it took a processor 8 ms more."""
        width, height = self.ren_win.GetSize()
        found = vtkUnsignedCharArray()
        self.ren_win.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, found)
        upwards: NDArray[np.uint8] = pv.convert_array(found)
        downwards = np.ascontiguousarray(upwards.reshape(height, width, 4)[::-1])
        # Converting makes a copy, and what is converted once is painted often.
        picture = QImage(downwards.data, width, height, 4 * width, QImage.Format.Format_RGBX8888)
        return picture.convertToFormat(QImage.Format.Format_RGB32)


class Canvas(QWidget):
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
        super().__init__(parent)
        # The wheel moves the view and leaves the focus where it is.
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self._is_software = is_drawn_by_processor()
        self._surface = _Surface(None if self._is_software else self, self._begin, self._paint_frame)
        self.destroyed.connect(self._surface.deleteLater)
        self.renderer = self._surface.renderer
        self._picture, self._is_stale = QImage(), True
        self._drawn: dict[Hashable, list[_Drawn]] = {}
        self._hidden: set[Hashable] = set()
        self._opacities: dict[Hashable, float] = {}
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

    def close(self) -> bool:
        """Free the OpenGL context. What comes after, such as the end of a job, is heard and draws nothing."""
        self.is_open = False
        self._drawn.clear()
        self._surface.close()
        return super().close()

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
        self._draw_anew()

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
        self._draw_anew()

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
            self._draw_anew()

    def set_smooth(self, is_smooth: bool) -> None:
        """Smooth edges where a processor draws: for a view at rest, for it takes most of a frame's time."""
        is_smooth = is_smooth and self.smooths_at_rest
        if self.is_open and self._is_software and bool(self.renderer.GetUseFXAA()) != is_smooth:
            self.renderer.SetUseFXAA(is_smooth)
            self._draw_anew()

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

    def sizeHint(self) -> QSize:  # noqa: N802
        """As large as there is room for."""
        return QSize(400, 400)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Fill the widget."""
        super().resizeEvent(event)
        if self._is_software:
            self._draw_anew()
        else:
            self._surface.setGeometry(self.rect())

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Show the picture, drawn anew where anything changed; a graphics card has a widget over this one."""
        if not self._is_software:
            super().paintEvent(event)
            return
        if self._is_stale and self.is_open:
            self._picture = self._taken()
        painter = QPainter(self)
        painter.drawImage(self.rect(), self._picture)
        painter.end()

    def _draw_anew(self) -> None:
        """Paint soon."""
        self._is_stale = True
        (self if self._is_software else self._surface).update()

    def _taken(self) -> QImage:
        """What is drawn, opaque."""
        self._is_stale = False
        if not self._is_software:
            picture: QImage = self._surface.grabFramebuffer()
            return picture.convertToFormat(QImage.Format.Format_RGB32)
        before = self._surface.size()
        if self._surface.context() is None or before != self.size():
            self._surface.resize(self.size())
            # Qt keeps it for when the widget is shown, which this one never is.
            QCoreApplication.sendEvent(self._surface, QResizeEvent(self.size(), before))
        if self._surface.context() is None:
            return self._picture  # there is no OpenGL, or no pixel to draw
        self._surface.makeCurrent()
        self._paint_frame(self._surface.draw)
        return self._surface.pixels()

    def warm_up(self) -> None:
        """Compile what every frame needs while none is wanted yet: 50 of the 70 ms of a first frame without a card."""
        if self.is_open and self.n_painted == 0 and not self.isVisible():
            self._taken()
            self._is_stale = True

    def _begin(self) -> None:
        """Smooth edges where a graphics card draws; a processor in its place takes 50 ms for that: see `set_smooth`."""
        self.renderer.SetUseFXAA(not self._is_software)
        self.set_background_colour(*self._background)
        self.started.emit(self._is_software)

    def _paint_frame(self, render: Callable[[], None]) -> None:
        """Draw, and count it."""
        self.n_painted += 1
        if self._is_detail_due and self.is_open:
            self._is_detail_due = False
            self._show_detail()
        is_whole = self._n_layers >= len(self._drawn)
        started_s = perf_counter()
        render()
        if self._frame_times_s is not None and is_whole and not self.renderer.GetUseFXAA():
            self._surface.ren_win.WaitForCompletion()
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
        return image_array(self._taken())

    def _detail_changed(self) -> None:
        """Paint soon; the detail is looked at once, however much has changed by then."""
        self._is_detail_due = True
        self._draw_anew()

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
