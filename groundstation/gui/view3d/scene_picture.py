"""A picture of a site and a plan in three dimensions, with values and coverage painted on it. It takes no input.

It draws what it gets and decides nothing. Setters only note what is to be drawn; Qt paints once per turn of its event
loop, and not while the picture is hidden.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QMargins, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from groundstation.gui.view3d.aircraft_shape import aircraft_drawables, shown_span_m
from groundstation.gui.view3d.canvas import Canvas, image_array
from groundstation.gui.view3d.drawables import (
    ON_TOP,
    Drawable,
    Label,
    Layer,
    Shape,
    box_edges,
    frusta,
    joined,
    outlines,
    polyline,
    shown_panels,
)
from groundstation.gui.view3d.hemispheres import CoveragePainter
from groundstation.gui.view3d.navigator import Navigator
from groundstation.gui.view3d.orbit import Orbit, Pinhole, facing, photo_pinhole
from groundstation.gui.view3d.overlay import Overlay, SceneTexts
from groundstation.gui.view3d.paint import ColourScale, flat, shaded, sky_colour
from groundstation.gui.view3d.picking import SEE_THROUGH, Hit, PickIndex, footprint, pick
from groundstation.gui.view3d.site_scene import (
    FRUSTUM_M,
    PlanScene,
    SiteScene,
    glass_colours,
    landing_pad,
    lifted,
    panels_drawable,
    plan_frusta,
    plan_scene,
    site_scene,
    sortie_colours,
    surface_drawables,
    views_that_cover,
)
from groundstation.gui.widgets.theme import colours
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.scenes.surfaces import Part, Surface
from groundstation.services.units import UnitSystem
from planning.coverage.sections import PanelFrames, SectionGrid
from planning.geo.frames import Angles, camera_axes
from planning.plan import Camera, Plan, ViewpointArrays
from planning.site.records import SiteModel

Array = NDArray[np.float64]


# The shape of one item: the lines that mark it, and what has to be in view to look at it.

MARK_LIFT_M = 0.03
"""Marks of panels lie this far in front of them, so that they are not half hidden."""

SURROUNDINGS_M = 6.0
"""Something smaller is shown with at least this much around it."""

NO_PANEL_M = 15.0
"""How far a viewpoint looks that has no panel in its picture: as far as most have theirs."""

PANEL_ASIDE_DEG, PLAN_ASIDE_DEG = 20.0, 50.0
"""How far beside their front things are looked at: glass nearly straight on, a viewpoint and what it sees apart."""


@dataclass(frozen=True, slots=True, eq=False)
class ItemShape:
    """Lines that mark an item; points, shape (n, 3), that show it; from where it is looked at.

    `normal` has shape (3,) and points to the side on which to stand, `aside_deg` to the right of it; zero where any
    side will do.
    """

    lines: Shape
    points_enu_m: Array
    normal: Array
    aside_deg: float = PANEL_ASIDE_DEG


def item_shape(item: Item, site: SiteScene | None, plan: PlanScene | None) -> ItemShape | None:
    """Shape of an item of a site or plan; None where there is none such."""
    if plan is not None and item.kind in (ItemKind.VIEWPOINT, ItemKind.SORTIE, ItemKind.LEG):
        return _of_plan(item, site, plan)
    if site is None:
        return None
    model = site.model
    match item.kind:
        case ItemKind.PANEL | ItemKind.FACADE:
            return _of_panels(item, site)
        case ItemKind.BUILDING:
            vertices = model.building.vertices_enu_m
            return _boxed(vertices) if len(vertices) else None
        case ItemKind.OBSTACLE:
            meshes = zip(model.site.obstacles, model.obstacles, strict=True)
            found = next((mesh for obstacle, mesh in meshes if obstacle.id == item.id), None)
            return None if found is None or len(found.vertices_enu_m) == 0 else _boxed(found.vertices_enu_m)
        case ItemKind.NO_FLY:
            zone = next((zone for zone in model.site.airspace.no_fly if zone.id == item.id), None)
            if zone is None:
                return None
            ring = np.array([*zone.polygon_enu_m, zone.polygon_enu_m[0]])
            low, high = (np.c_[ring, np.full(len(ring), z)] for z in (zone.floor_m, zone.ceiling_m))
            return _lines([low, high, *(np.stack(pair) for pair in zip(low[:-1], high[:-1], strict=True))])
        case ItemKind.ZONE:
            shape = next((zone.outline() for zone in site.zones if zone.item == item), None)
            return None if shape is None else ItemShape(shape, shape[0], np.zeros(3))
        case ItemKind.AIRSPACE:
            return _boxed(np.array([model.site.airspace.min_enu_m, model.site.airspace.max_enu_m]))
        case ItemKind.HOME:
            return _boxed(landing_pad(model.site.home_enu_m).vertices_enu_m)
        case ItemKind.RALLY:
            point = next((point for point in model.site.rally_points if point.id == item.id), None)
            return None if point is None else _boxed(landing_pad(point.position_enu_m).vertices_enu_m)
        case _:
            return None


def _of_plan(item: Item, site: SiteScene | None, plan: PlanScene) -> ItemShape | None:
    if item.kind is ItemKind.VIEWPOINT:
        index = plan.viewpoint_index.get(item.id)
        return None if index is None else _of_viewpoint(index, site, plan)
    number, _, leg = item.id.partition("/")
    if not (number.isdecimal() and 1 <= int(number) <= len(plan.paths)):
        return None
    path = plan.paths[int(number) - 1]
    if item.kind is ItemKind.LEG:
        if not (leg.isdecimal() and 1 <= int(leg) < len(path)):
            return None
        return _of_leg(path[int(leg) - 1 : int(leg) + 1], site)
    return ItemShape(polyline(path), path, np.zeros(3)) if len(path) > 1 else None


def _of_viewpoint(index: int, site: SiteScene | None, plan: PlanScene) -> ItemShape:
    """A viewpoint is looked at together with what its picture shows, from behind and beside it."""
    view = ViewpointArrays(*(part[index : index + 1] for part in plan.views))
    camera, eye = plan.plan.camera, view.positions_enu_m[0]
    heading, pitch = float(view.heading_rad[0]), float(view.pitch_rad[0])
    reach_m = NO_PANEL_M if site is None else _reach_m(photo_pinhole(eye, heading, pitch, camera, 1000.0), site.frames)
    lines = frusta(view, camera, 2.0 * FRUSTUM_M)
    # Level, so that a view that looks up is not looked at from below the ground.
    ahead, _, _ = camera_axes(heading, 0.0)
    return ItemShape(lines, frusta(view, camera, reach_m)[0], -ahead, PLAN_ASIDE_DEG)


def _reach_m(view: Pinhole, frames: PanelFrames) -> float:
    """Depth of the panel nearest to the middle of a picture, of those that turn their front to it."""
    pixels, depths = view.project(frames.centroids)
    away = frames.centroids - view.eye_enu_m
    middle = np.array([0.5 * view.width_px, 0.5 * view.height_px])
    is_in = (depths > 0.0) & (np.abs(pixels - middle) <= middle).all(axis=1)
    is_in &= np.einsum("ij,ij->i", away, frames.normals) < 0.0
    if not is_in.any():
        return NO_PANEL_M
    beside = np.linalg.norm(pixels - middle, axis=1)
    return float(depths[np.argmin(np.where(is_in, beside, np.inf))])


def _of_leg(ends_enu_m: Array, site: SiteScene | None) -> ItemShape:
    """A leg is looked at together with the panel nearest to its middle, from that panel's front."""
    lines = polyline(ends_enu_m)
    if site is None or len(site.frames) == 0:
        return ItemShape(lines, ends_enu_m, np.zeros(3))
    centroids = site.frames.centroids
    nearest = int(np.linalg.norm(centroids - ends_enu_m.mean(axis=0), axis=1).argmin())
    return ItemShape(lines, np.vstack([ends_enu_m, centroids[nearest]]), site.frames.normals[nearest], PLAN_ASIDE_DEG)


def _of_panels(item: Item, site: SiteScene) -> ItemShape | None:
    if item.kind is ItemKind.PANEL:
        index = site.panel_index.get(item.id)
        panels = np.zeros(0, np.int64) if index is None else np.array([index])
    else:
        numbers = [i for i, facade in enumerate(site.model.site.facades) if facade.id == item.id]
        panels = np.flatnonzero(np.isin(site.facade, numbers))
    if len(panels) == 0:
        return None
    corners = shown_panels(site.frames)[panels] + MARK_LIFT_M * site.frames.normals[panels, None]
    return ItemShape(outlines(corners), corners.reshape(-1, 3), site.frames.normals[panels].sum(axis=0))


def _boxed(points_enu_m: Array) -> ItemShape:
    shape = box_edges(points_enu_m.min(axis=0), points_enu_m.max(axis=0))
    return ItemShape(shape, shape[0], np.zeros(3))


def _lines(pieces: list[Array]) -> ItemShape:
    shape = joined([polyline(piece) for piece in pieces])
    return ItemShape(shape, shape[0], np.zeros(3))


def with_surroundings(points_enu_m: Array) -> Array:
    """Points, shape (n, 3), and corners of a box of at least `SURROUNDINGS_M` to each side of their middle."""
    low, high = points_enu_m.min(axis=0), points_enu_m.max(axis=0)
    centre = 0.5 * (low + high)
    half = np.maximum(0.5 * (high - low), SURROUNDINGS_M)
    return box_edges(centre - half, centre + half)[0]


SELECTED_PX, HOVERED_PX, FOOTPRINT_PX = 4.0, 3.0, 3.0

FADED = 0.16
"""How strongly is drawn what is not looked at while something is."""

FLOWN_FRUSTUM_M = 5.0
"""Length of the pyramid of the camera that flies the plan."""

TEXTURED = (Layer.SURROUNDINGS, Layer.PHOTOS)
"""Layers with pictures: a processor that draws needs 1.4 to 1.9 times as long for a frame with them."""

SMOOTH_FRAME_S = 1.0 / 30.0
"""Up to so long a frame turning is smooth: textured layers are then drawn in motion, else while the view rests."""

ASIDE_DEG, ABOVE_DEG = 28.0, 22.0
"""Standard view: from the right and from above, so that depth can be seen."""

WELL_SEEN = 0.5
"""Cosine to its front up to which a thing is looked at from where the view stands: turning takes bearings away."""


SITE_LAYERS = (
    Layer.GROUND,
    Layer.SHADOWS,
    Layer.BUILDING,
    Layer.OBSTACLES,
    Layer.NO_FLY,
    Layer.ZONES,
    Layer.AIRSPACE,
    Layer.HOME,
)


@dataclass(frozen=True, slots=True, eq=False)
class FlownPose:
    """Where the aircraft is, shape (3,), and its camera looks, while a sortie, counted from 0, is flown on screen."""

    sortie: int
    position_enu_m: Array
    heading_rad: float
    pitch_rad: float


class StandardView(Enum):
    """Views that a user asks for by name."""

    ALL = auto()
    FRONT = auto()
    TOP = auto()
    HOME = auto()


class ScenePicture(QWidget):
    """Shows a site and a plan, and is looked at from where its owner wants.

    Signals
    -------
    orbitChanged(Orbit)
        It is looked at from elsewhere, but not by `set_orbit`.
    surroundingsWanted(SiteModel)
        What the virtual scene of this site looks like is to be given to `set_surfaces`.
    photosWanted()
        What the photos show of the panels is to be given to `set_panel_photos`.
    """

    orbitChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    surroundingsWanted = Signal(object)  # noqa: N815
    photosWanted = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._site: SiteScene | None = None
        self._plan: PlanScene | None = None
        self._index: Future[PickIndex] | None = None
        self._indexer = ThreadPoolExecutor(1, "pick-index")
        self._locked: frozenset[str] = frozenset()
        self._route_values: tuple[ColourScale, tuple[Array, ...]] | None = None
        self._panel_values: tuple[ColourScale, Array] | None = None
        self._selection: tuple[Item, ...] = ()
        self._hover: Item | None = None
        self._hidden: frozenset[Layer] = frozenset({Layer.FRUSTA, Layer.SURROUNDINGS})
        self._is_moving, self._is_watched, self._is_software = False, False, False
        self._live_labels: tuple[Label, ...] = ()
        self._surfaces: tuple[Surface, ...] = ()
        self._has_photos = False
        self._opacities: dict[Layer, float] = {}
        self._sorties: dict[int, tuple[bool, float]] = {}
        self._n_sorties = 0
        self._flown: FlownPose | None = None
        self._units = UnitSystem.METRIC
        self._canvas = Canvas(self)
        self._coverage = CoveragePainter(self._canvas)
        self._overlay = Overlay(self)
        self._navigator = Navigator(self._canvas)
        self._texts = SceneTexts(self)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._canvas)
        self.setFocusProxy(self._canvas)
        self.setMinimumSize(200, 150)
        self._navigator.changed.connect(self._follow_orbit)
        self._navigator.moved.connect(self.orbitChanged)
        self._navigator.rested.connect(self._come_to_rest)
        self._canvas.started.connect(self._begin)
        self._canvas.framesTimed.connect(self._show_textured, Qt.ConnectionType.QueuedConnection)
        self._dress()

    def warm_up(self) -> None:
        """Get ready to draw the first frame soon; see `Canvas`."""
        self._canvas.warm_up()

    # What is shown

    def set_site(self, model: SiteModel | None, *, keep_camera: bool = False) -> None:
        """Draw a site, or none; the plan stays. Values and coverage of other panels go."""
        had, self._site = self._site, None if model is None else site_scene(model, colours())
        self._index, self._surfaces = None, ()
        is_same = had is not None and self._site is not None and had.panel_index == self._site.panel_index
        if not is_same:
            self._panel_values = None
            self._coverage.set_states(None, None)
        self._coverage.set_frames(None if self._site is None else self._site.frames)
        self._draw_site()
        self._navigator.wait_for_rest()
        if not keep_camera:
            self.look_at_all()
        self._want_surroundings()

    def set_surfaces(self, surfaces: Sequence[Surface]) -> None:
        """Draw walls and surroundings of the site as its virtual scene has them, while that layer is shown."""
        self._surfaces = tuple(surfaces)
        self._draw_surroundings()
        self._time_anew()

    def offer_photos(self, is_there: bool) -> None:
        """There are photos of the site, or none any more: their layer can be shown, and asks for them."""
        self._has_photos = is_there
        self._canvas.draw(Layer.PHOTOS, ())
        self._want_photos()

    def set_panel_photos(self, surfaces: Sequence[Surface]) -> None:
        """Draw panels and walls as photos show them, while that layer is shown; panels stay before walls."""
        self._canvas.draw(
            Layer.PHOTOS,
            tuple(
                lifted(drawn, 0.5 if surface.part is Part.WALLS else 2.0)
                for surface, drawn in zip(surfaces, surface_drawables(surfaces), strict=True)
            ),
        )
        self._time_anew()

    def _want_photos(self) -> None:
        if self._has_photos and self.is_layer_visible(Layer.PHOTOS):
            self.photosWanted.emit()

    def _begin(self, is_software: bool) -> None:
        """Show surroundings at once where a graphics card draws; a processor's first frame with them takes 0.4 s."""
        self._is_software = is_software
        if not is_software:
            self.set_layer_visible(Layer.SURROUNDINGS, True)
        self._time_anew()

    def _time_anew(self) -> None:
        self._canvas.time_frames(is_wanted=self._is_software)
        self._show_textured()

    def is_painted(self) -> bool:
        """Whether panels show values or coverage, which photos would hide."""
        return self._panel_values is not None or self._coverage.is_on

    def _set_moving(self, is_moving: bool) -> None:
        self._is_moving = is_moving
        self._show_textured()

    def set_watched(self, is_watched: bool) -> None:
        """Whether a flight moves in the view: it is at rest for no moment then, so edges are not smoothed."""
        if is_watched != self._is_watched:
            self._is_watched = is_watched
            self._show_textured()
            self._stir()

    def _show_textured(self) -> None:
        """Textured layers that keep the view from turning smoothly, or may in a flight, are drawn while it rests."""
        frame_s, unknown = self._canvas.moving_frame_s, self._is_software and self._is_watched
        is_slow = unknown if frame_s is None else frame_s > SMOOTH_FRAME_S
        is_late = is_slow and (self._is_moving or self._is_watched)
        for layer in TEXTURED:
            is_hidden = layer in self._hidden or (layer is Layer.PHOTOS and self.is_painted())
            self._canvas.set_shown(layer, not is_hidden and not is_late)

    def _want_surroundings(self) -> None:
        """Ask for what the site's virtual scene looks like, where it is to be shown and nobody has said yet."""
        is_wanted = self.is_layer_visible(Layer.SURROUNDINGS) and not self._surfaces
        if is_wanted and self._site is not None and len(self._site.frames):
            self.surroundingsWanted.emit(self._site.model)

    def set_plan(self, plan: Plan | None, locked: frozenset[str] = frozenset()) -> None:
        """Draw a plan, or none; `locked` names the viewpoints that are kept as they are. Values of its routes go."""
        self._locked, self._route_values = locked, None
        self._plan = None if plan is None else plan_scene(plan, colours(), locked)
        self._sorties, self._flown = {}, None
        self._draw_plan()

    def set_route_values(self, scale: ColourScale | None, values: Sequence[Array] = ()) -> None:
        """Colour the routes by a value per vertex of each sortie's path, NaN where it is not known; None by sortie."""
        if self._plan is None or (scale is None and self._route_values is None):
            return
        self._route_values = None if scale is None else (scale, tuple(values))
        self._plan = plan_scene(self._plan.plan, colours(), self._locked, self._route_values)
        self._draw_plan()

    def set_panel_values(self, scale: ColourScale | None, values: Array | None = None) -> None:
        """Colour the panels by a value each, shape (m,), NaN where it is not known; None by facade."""
        if scale is None or values is None:
            self._panel_values = None
        elif self._site is None or values.shape != (len(self._site.frames),):
            n = 0 if self._site is None else len(self._site.frames)
            raise ValueError(f"values: expected one for each of {n} panels, got shape {values.shape}")
        else:
            self._panel_values = (scale, values)
        self._paint_panels()

    def paint_hemispheres(self, grid: SectionGrid | None, states: NDArray[np.int64] | None = None) -> None:
        """Paint coverage on the hemispheres, or no more.

        Parameters
        ----------
        states
            Shape (m, n_sections): the number of views that cover a section where there are any, else 0 open,
            -1 unreachable, -2 undecided (`hemispheres.OPEN` and so on).
        """
        self._coverage.set_states(grid, states)
        self._paint_panels()
        self._paint_domes()

    def set_selection(self, items: Iterable[Item]) -> None:
        """Mark what is selected."""
        self._selection = tuple(items)
        self._draw_marks()
        self._paint_domes()
        self._focus()

    def set_hover(self, item: Item | None) -> None:
        """Mark what is pointed at, here or elsewhere."""
        if item != self._hover:
            self._hover = item
            self._canvas.draw("hover", self._marks((item,) if item is not None else (), HOVERED_PX))
            self._focus()

    def views_of_panel(self, panel_id: str) -> NDArray[np.int64]:
        """Numbers of the plan's viewpoints that cover a section of a panel, whatever stands between."""
        if self._site is None or self._plan is None or panel_id not in self._site.panel_index:
            return np.zeros(0, np.int64)
        return views_that_cover(self._plan, self._site.frames, self._site.panel_index[panel_id])

    def set_sortie(self, number: int, is_visible: bool, opacity: float = 1.0) -> None:
        """Show or hide a sortie, counted from 1, with its viewpoints, or draw it fainter."""
        self._sorties[number - 1] = is_visible, opacity
        self._show_plan_layers()
        self._focus()

    def sortie_state(self, number: int) -> tuple[bool, float]:
        """Whether a sortie, counted from 1, is shown, and how strongly."""
        return self._sorties.get(number - 1, (True, 1.0))

    def set_layer_opacity(self, layer: Layer, opacity: float) -> None:
        """Draw a layer so strongly, 0 to 1; routes and viewpoints beside what their sorties say."""
        self._opacities[layer] = opacity
        self._canvas.set_opacity(layer, opacity)
        if layer in (Layer.ROUTES, Layer.VIEWPOINTS):
            self._focus()

    def layer_opacity(self, layer: Layer) -> float:
        """How strongly a layer is drawn."""
        return self._opacities.get(layer, 1.0)

    def set_flown(self, pose: FlownPose | None) -> None:
        """Show the aircraft and its camera as they fly a sortie of the plan; None for nowhere."""
        self._stir()
        had, self._flown = self._flown, pose
        self._set_moving(True)
        self._canvas.draw("flown", self._flown_drawables())
        if (None if had is None else had.sortie) != (None if pose is None else pose.sortie):
            self._focus()

    def set_layer_visible(self, layer: Layer, is_visible: bool) -> None:
        """Show or hide a layer; what is hidden cannot be picked."""
        self._hidden = self._hidden - {layer} if is_visible else self._hidden | {layer}
        if layer in TEXTURED:
            self._time_anew()
        else:
            self._canvas.set_shown(layer, is_visible)
        if layer in (Layer.VIEWPOINTS, Layer.ROUTES):
            self._show_plan_layers()
        elif layer is Layer.FRUSTA:
            self._focus()
        elif layer is Layer.SURROUNDINGS:
            self._draw_surroundings()
            self._want_surroundings()
        elif layer is Layer.PHOTOS:
            self._want_photos()
        self._show_labels()

    def is_layer_visible(self, layer: Layer) -> bool:
        """Whether a layer is shown."""
        return layer not in self._hidden

    def set_units(self, units: UnitSystem) -> None:
        """Units of lengths on screen."""
        self._units = units
        self._overlay.set_units(units)

    def set_insets(self, insets: QMargins) -> None:
        """Keep north, scale and legends away from the edges, where something else lies over them."""
        self._overlay.set_insets(insets)

    # Where it is looked at from

    def orbit(self) -> Orbit:
        """Where the view is looked at from."""
        return self._navigator.orbit

    def metres_per_px(self, point_enu_m: Array) -> float:
        """How large a pixel is at a point, shape (3,); behind the eye, as at the focus."""
        view = self._navigator.pinhole()
        depth_m = float((point_enu_m - view.eye_enu_m) @ view.forward)
        return view.metres_per_px(depth_m if depth_m > 0.0 else self._navigator.orbit.distance_m)

    def set_orbit(self, orbit: Orbit) -> None:
        """Look from elsewhere, without a signal: for views that follow one another."""
        self._navigator.follow(orbit)

    def look_at(self, item: Item) -> None:
        """Bring an item into view: panels from their front, viewpoints with what they look at.

        All else, and what is seen from its front side already, is looked at from where the view stands.
        """
        shape = self._shape(item)
        if shape is None:
            return
        points, aspect = with_surroundings(shape.points_enu_m), self._navigator.aspect
        orbit = self._navigator.orbit
        if np.linalg.norm(shape.normal) > 1e-6 and not _is_in_front(orbit, shape.normal):
            orbit = facing(shape.normal, points, aspect, shape.aside_deg, 12.0)
        else:
            orbit = orbit.fitted(points, aspect)
        self._navigator.go(self._in_sight(orbit, shape))

    def look_at_all(self) -> None:
        """Show the whole site and plan from the standard direction."""
        self.look_from(StandardView.ALL)

    def bring_in_viewpoints(self) -> None:
        """Show the whole site and plan from where the view stands, unless all viewpoints are in the picture already."""
        points = self._extent()
        if points is None or self._plan is None:
            return
        view = self._navigator.pinhole()
        pixels, _ = view.project(self._plan.views.positions_enu_m)
        # NaN, behind the eye, is in no picture either.
        if not ((pixels >= 0.0) & (pixels <= (view.width_px, view.height_px))).all():
            self._navigator.go(self._navigator.orbit.fitted(points, self._navigator.aspect))

    def look_from(self, view: StandardView) -> None:
        """Take a standard view."""
        points, normal = self._extent(), self._front()
        if points is None:
            return
        aspect = self._navigator.aspect
        match view:
            case StandardView.ALL:
                self._navigator.go(facing(normal, points, aspect, ASIDE_DEG, ABOVE_DEG))
            case StandardView.FRONT:
                self._navigator.go(facing(normal, points, aspect))
            case StandardView.TOP:
                self._navigator.go(Orbit(pitch_deg=-90.0).fitted(points, aspect))
            case StandardView.HOME:
                if self._site is not None:
                    home = np.array(self._site.model.site.home_enu_m)
                    towards = points.mean(axis=0) - home
                    self._navigator.go(
                        facing(np.array([*-towards[:2], 0.0]), np.vstack([points, home]), aspect, 0.0, 12.0)
                    )

    # Pictures and the end

    def screenshot(self) -> NDArray[np.uint8]:
        """What is on screen, with labels, shape (height, width, 3)."""
        return image_array(self.grab().toImage())

    def close_view(self) -> None:
        """Free the OpenGL context; call before the widget goes away."""
        self._navigator.stop()
        self._indexer.shutdown(wait=False, cancel_futures=True)
        self._canvas.close()

    def canvas(self) -> Canvas:
        """What it is drawn on, for what measures it."""
        return self._canvas

    def pick_at(self, x_px: float, y_px: float, see_through: frozenset[Layer] = frozenset()) -> Hit | None:
        """What lies under a pixel of the view, through layers that are hidden or seen through."""
        without = frozenset(number for number, (is_shown, _) in self._sorties.items() if not is_shown)
        return pick(
            self._pick_index(), self._plan, self._navigator.pinhole(), x_px, y_px, self._hidden | see_through, without
        )

    def photo_border(self, views: ViewpointArrays, number: int, camera: Camera) -> list[Array]:
        """Where the border of a photo falls on the site, polylines of shape (k, 3).

        Nothing while the site is still being indexed, which is not waited for.
        """
        self._make_index()
        if self._index is None or not self._index.done():
            return []
        heading, pitch = float(views.heading_rad[number]), float(views.pitch_rad[number])
        view = photo_pinhole(views.positions_enu_m[number], heading, pitch, camera, 1000.0)
        pieces: list[Array] = footprint(self._index.result(), view)
        return pieces

    # Qt

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Keep the overlay over the whole picture."""
        super().resizeEvent(event)
        self._overlay.setGeometry(self._canvas.geometry())
        self._overlay.raise_()
        self._follow_orbit()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_texts"):
            self._dress()

    def _dress(self) -> None:
        """Take over the theme's colours."""
        look = colours()
        self._canvas.set_background_colour(look.scene, sky_colour(look.scene, look.is_dark))
        if self._site is not None:
            self._site = site_scene(self._site.model, colours())
            self._draw_site()
        if self._plan is not None:
            self._plan = plan_scene(self._plan.plan, colours(), self._locked, self._route_values)
            self._draw_plan()
        self._show_legend()
        self._overlay.update()

    # Drawing

    def _draw_site(self) -> None:
        site = self._site
        for layer in SITE_LAYERS:
            self._canvas.draw(layer, () if site is None else site.drawables[layer])
        self._canvas.draw(
            Layer.PANELS, () if site is None else [panels_drawable(site.frames, self._panel_colours(site))]
        )
        self._draw_surroundings()
        self._paint_domes()
        self._draw_marks()
        self._show_labels()
        self._show_legend()

    def _draw_surroundings(self) -> None:
        """The virtual scene's street and neighbours; its walls take the place of the building's own."""
        is_shown = self.is_layer_visible(Layer.SURROUNDINGS)
        parts = {part: [each for each in self._surfaces if each.part is part] for part in Part if is_shown}
        self._canvas.draw(Layer.SURROUNDINGS, surface_drawables(parts.get(Part.SURROUNDINGS, ())))
        if self._site is not None:
            walls = surface_drawables(parts.get(Part.WALLS, ()))
            self._canvas.draw(Layer.BUILDING, walls or self._site.drawables[Layer.BUILDING])

    def _draw_plan(self) -> None:
        plan = self._plan
        n_sorties = 0 if plan is None else len(plan.paths)
        for number in range(-1, max(n_sorties, self._n_sorties)):
            routes = plan.routes[number] if plan is not None and 0 <= number < n_sorties else ()
            self._canvas.draw((Layer.ROUTES, number), routes)
            self._canvas.draw((Layer.VIEWPOINTS, number), () if plan is None else plan.marks.get(number, ()))
        self._n_sorties = n_sorties
        self._canvas.draw("flown", self._flown_drawables())
        self._show_plan_layers()
        self._focus()
        self._draw_marks()
        self._show_labels()
        self._show_legend()

    def _panel_colours(self, site: SiteScene) -> NDArray[np.uint8]:
        if self._panel_values is not None:
            scale, values = self._panel_values
            return scale.colours(values)
        covered = self._coverage.panel_colours(colours())
        return glass_colours(site.frames, site.facade) if covered is None else covered

    def _paint_panels(self) -> None:
        if self._site is not None and len(self._site.frames):
            self._canvas.recolour(Layer.PANELS, shaded(self._panel_colours(self._site), self._site.frames.normals))
        self._show_legend()

    def _paint_domes(self) -> None:
        chosen = next((item.id for item in self._selection if item.kind is ItemKind.PANEL), None)
        selected = None if self._site is None or chosen is None else self._site.panel_index.get(chosen)
        self._coverage.paint(self._navigator.pinhole(), selected, colours())

    def _shape(self, item: Item) -> ItemShape | None:
        return item_shape(item, self._site, self._plan)

    def _marks(self, items: Sequence[Item], width_px: float) -> tuple[Drawable, ...]:
        shapes = [shape for shape in map(self._shape, items) if shape is not None]
        if not shapes:
            return ()
        points, cells = joined([shape.lines for shape in shapes])
        return (Drawable(points, cells, flat(colours().text, len(cells)), width_px=width_px),)

    def _footprint(self) -> tuple[Drawable, ...]:
        """What the selected viewpoint's picture covers, on whatever it meets."""
        chosen = next((item.id for item in self._selection if item.kind is ItemKind.VIEWPOINT), None)
        plan = self._plan
        number = None if plan is None or chosen is None else plan.viewpoint_index.get(chosen)
        if plan is None or number is None:
            return ()
        # A selection is drawn once: it waits for the index.
        self._pick_index()
        pieces = self.photo_border(plan.views, number, plan.plan.camera)
        if not pieces:
            return ()
        points, cells = joined([polyline(piece) for piece in pieces])
        return (Drawable(points, cells, flat(colours().accent, len(cells)), width_px=FOOTPRINT_PX),)

    def _sortie_opacity(self, layer: Layer, number: int) -> float:
        """How strongly a sortie's share of a layer of the plan is drawn."""
        return self._sorties.get(number, (True, 1.0))[1] * self.layer_opacity(layer)

    def _show_plan_layers(self) -> None:
        """Show and hide sorties as their own state and that of their layers say."""
        for number in range(-1, self._n_sorties):
            is_shown, _ = self._sorties.get(number, (True, 1.0))
            for layer in (Layer.ROUTES, Layer.VIEWPOINTS):
                self._canvas.set_shown((layer, number), is_shown and layer not in self._hidden)

    def _stir(self) -> None:
        """Draw fast until nothing has changed for a while."""
        self._canvas.set_smooth(False)
        self._navigator.wait_for_rest()

    def _focus(self) -> None:
        """Draw what is looked at in full, with its pyramids, and the rest of the plan faintly."""
        self._stir()
        plan = self._plan
        if plan is None:
            self._canvas.draw(Layer.FRUSTA, ())
            return
        sorties, views = self._in_focus(plan)
        for number in range(-1, self._n_sorties):
            strength = 1.0 if sorties is None or number in sorties else FADED
            for layer in (Layer.ROUTES, Layer.VIEWPOINTS):
                self._canvas.set_opacity((layer, number), strength * self._sortie_opacity(layer, number))
        if Layer.FRUSTA not in self._hidden:
            views = np.arange(len(plan.sortie))
        shown = [number for number in range(-1, self._n_sorties) if self._sorties.get(number, (True, 1.0))[0]]
        views = views[np.isin(plan.sortie[views], shown)] if Layer.VIEWPOINTS not in self._hidden else views[:0]
        self._canvas.draw(Layer.FRUSTA, plan_frusta(plan, views, colours()))
        # Pyramids of what is looked at are there also where those of all are not asked for.
        self._canvas.set_shown(Layer.FRUSTA, True)

    def _in_focus(self, plan: PlanScene) -> tuple[set[int] | None, NDArray[np.int64]]:
        """Sorties that are drawn in full, None for all, and viewpoints with pyramids."""
        nothing = np.zeros(0, np.int64)
        for item in (*((self._hover,) if self._hover is not None else ()), *self._selection):
            if item.kind is ItemKind.PANEL:
                return set(), self.views_of_panel(item.id)
            if item.kind is ItemKind.SORTIE and item.id.isdecimal():
                number = int(item.id) - 1
                return {number}, np.flatnonzero(plan.sortie == number)
        if self._flown is not None:
            return {self._flown.sortie}, nothing
        for item in self._selection:
            if item.kind is ItemKind.LEG:
                of_leg = item.id.partition("/")[0]
                return ({int(of_leg) - 1} if of_leg.isdecimal() else None), nothing
            if item.kind is ItemKind.VIEWPOINT and item.id in plan.viewpoint_index:
                return {int(plan.sortie[plan.viewpoint_index[item.id]])}, nothing
        return None, nothing

    def _flown_drawables(self) -> tuple[Drawable, ...]:
        """The aircraft that flies the plan, turned as it flies, and its camera's pyramid in the sortie's colour."""
        plan, pose = self._plan, self._flown
        if plan is None or pose is None:
            return ()
        view = ViewpointArrays(pose.position_enu_m[None], np.array([pose.heading_rad]), np.array([pose.pitch_rad]))
        colour = sortie_colours(np.array([pose.sortie]), colours())
        span_m = shown_span_m(self.metres_per_px(pose.position_enu_m))
        points, cells = frusta(view, plan.plan.camera, max(FLOWN_FRUSTUM_M, span_m))
        # Plans turn aircraft with their cameras.
        flown, camera = Angles(pose.heading_rad, 0.0, 0.0), Angles(pose.heading_rad, pose.pitch_rad, 0.0)
        return (
            Drawable(points, cells, np.tile(colour, (len(cells), 1)), width_px=3.0, depth_shift=ON_TOP),
            *aircraft_drawables(pose.position_enu_m, flown, camera, span_m, colours()),
        )

    def _draw_marks(self) -> None:
        # A sortie is told by the others, which are faint: a mark would hide its colour.
        is_alone = self._plan is None or len(self._plan.paths) < 2
        marked = [item for item in self._selection if is_alone or item.kind is not ItemKind.SORTIE]
        self._canvas.draw("selection", self._marks(marked, SELECTED_PX))
        self._canvas.draw("footprint", self._footprint())
        self._canvas.draw("hover", self._marks((self._hover,) if self._hover is not None else (), HOVERED_PX))

    def set_live_labels(self, labels: Sequence[Label]) -> None:
        """Texts at what moves, before all others; none: take them away."""
        if tuple(labels) != self._live_labels:
            self._live_labels = tuple(labels)
            self._show_labels()

    def _show_labels(self) -> None:
        self._overlay.set_labels([*self._live_labels, *self._texts.labels(self._site, self._plan, self._hidden)])

    def _show_legend(self) -> None:
        self._show_textured()
        painted = (self._panel_values, self._route_values)
        self._overlay.set_scales([values[0] for values in painted if values is not None])
        self._overlay.set_legend(self._texts.coverage_legend() if self._coverage.is_on else ())

    # Moving

    def _extent(self) -> Array | None:
        parts = [] if self._site is None else [self._site.extent()]
        if self._plan is not None and len(self._plan.views.positions_enu_m):
            parts.append(self._plan.views.positions_enu_m)
        return np.concatenate(parts) if parts else None

    def _front(self) -> Array:
        """Outward direction of the facade with most panels; south where there is none."""
        if self._site is None or len(self._site.frames) == 0:
            return np.array([0.0, -1.0, 0.0])
        largest = np.bincount(self._site.facade).argmax()
        normal = self._site.frames.normals[self._site.facade == largest].sum(axis=0)
        return np.asarray(normal)

    def _in_sight(self, orbit: Orbit, shape: ItemShape) -> Orbit:
        """Nearer, where something stands between the eye and what is looked at."""
        index = self._pick_index()
        if index is None:
            return orbit
        size_m = 0.5 * float(np.linalg.norm(np.ptp(shape.points_enu_m, axis=0)))
        back = orbit.eye_enu_m - np.array(orbit.focus_enu_m)
        back /= orbit.distance_m
        # From in front of the item, or the item itself would be what stands there.
        start_m = size_m + 1.0
        hit = index.surface(np.array(orbit.focus_enu_m) + start_m * back, back, self._hidden | SEE_THROUGH)
        if hit is None or start_m + hit.depth_m >= orbit.distance_m:
            return orbit
        return orbit.zoomed(orbit.distance_m / (start_m + 0.9 * hit.depth_m))

    def _follow_orbit(self) -> None:
        self._canvas.set_smooth(False)
        self._set_moving(True)
        view = self._navigator.pinhole()
        self._canvas.look_through(view)
        if self._flown is not None:
            self._canvas.draw("flown", self._flown_drawables())
        self._overlay.set_view(view, self._navigator.orbit.distance_m)

    def _come_to_rest(self) -> None:
        self._set_moving(False)
        self._canvas.set_smooth(not self._is_watched)
        self._paint_domes()
        self._make_index()

    # Picking

    def _pick_index(self) -> PickIndex | None:
        self._make_index()
        return None if self._index is None else self._index.result()

    def _make_index(self) -> None:
        """Start to index the site: on another thread, for a mesh of a million triangles takes most of a second."""
        if self._index is None and self._site is not None and self._canvas.is_open:
            self._index = self._indexer.submit(PickIndex, self._site)


def _is_in_front(orbit: Orbit, normal: Array) -> bool:
    """Whether a surface is seen well from where the view stands, so that it need not be turned."""
    back = (orbit.eye_enu_m - np.array(orbit.focus_enu_m)) / orbit.distance_m
    return bool(orbit.pitch_deg <= 0.0 and back @ normal >= WELL_SEEN * np.linalg.norm(normal))
