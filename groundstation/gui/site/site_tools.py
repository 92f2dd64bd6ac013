"""Tools that draw on the site: buttons that start them in the 3-D view, and what becomes of their results."""

from __future__ import annotations

from collections.abc import Callable
from datetime import date
from enum import Enum, auto
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QPushButton, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.shared_view import SharedView, SharedViewPage
from groundstation.gui.site.pages import Edit
from groundstation.gui.site.site_editor import SiteEditor
from groundstation.gui.widgets.questions import choose_file, choose_files
from groundstation.gui.widgets.scrolling import ButtonGrid
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.edits import (
    HeightReference,
    add_box,
    add_mesh_obstacle,
    add_rally_point,
    add_zone,
    ground_at,
    height_above_sea_m,
    move_home,
    set_airspace,
    set_origin,
)
from groundstation.services.site.zones import AddedZones, add_zones
from planning.base.findings import Severity
from planning.geo.mesh import MESH_SUFFIXES, TriangleMesh, read_mesh
from planning.site.records import SiteModel

if TYPE_CHECKING:
    from groundstation.gui.map.map_view import MapView
    from groundstation.gui.view3d.drawing_tools import DrawnBox, DrawnPolygon, PickedRectangle, RectangleTool
    from groundstation.gui.view3d.scene_view import SceneView
    from groundstation.gui.view3d.tools import PickedHome, Tool


class SiteTool(Enum):
    """What the user draws."""

    NO_FLY = auto()
    BOX = auto()
    HOME = auto()
    AIRSPACE = auto()
    RALLY = auto()
    ORIGIN = auto()
    GRID = auto()


class SiteTools(QWidget):
    """One button for each tool; a tool that is in use has its button down, and pressing that puts it away.

    Signals
    -------
    gridPicked(Rectangle)
        The rectangle of a panel grid.
    gridRequested()
        The user wants to make a panel grid.
    """

    gridPicked = Signal(object)  # noqa: N815  (Qt's own way of naming)
    gridRequested = Signal()  # noqa: N815

    def __init__(
        self, context: ApplicationContext, shared_view: SharedView, editor: SiteEditor, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._context, self._shared_view, self._editor = context, shared_view, editor
        self._active: SiteTool | None = None
        self._scene: SceneView | None = None
        self._map: MapView | None = None
        self._grid_tool: RectangleTool | None = None
        self._buttons: dict[SiteTool, QPushButton] = {}
        layout = ButtonGrid(parent=self)
        for tool, text, tip in self._texts():
            button = QPushButton(text)
            button.setCheckable(True)
            button.setToolTip(tip)
            button.clicked.connect(lambda checked, tool=tool: self.use(tool) if checked else self.cancel_drawing())
            self._buttons[tool] = button
            layout.addWidget(button)
        mesh = QPushButton(self.tr("Obstacle mesh..."))
        mesh.setToolTip(self.tr("Add an obstacle from a mesh file in the site's coordinates (a crane, a tree)"))
        mesh.clicked.connect(self._choose_mesh)
        layout.addWidget(mesh)
        self.zones_action = QAction(self.tr("Add zones..."), self)
        self.zones_action.setToolTip(
            self.tr("Add geo-zones of your authority (ED-269, ED-318, GeoJSON, KML, AIXM, OpenAir)")
        )
        self.zones_action.triggered.connect(self._choose_zones)
        self.zones_button = QPushButton(self.zones_action.text())
        self.zones_button.setToolTip(self.zones_action.toolTip())
        self.zones_button.clicked.connect(self._choose_zones)
        layout.addWidget(self.zones_button)
        shared_view.with_scene(self._connect)

    def _texts(self) -> tuple[tuple[SiteTool, str, str], ...]:
        return (
            (SiteTool.GRID, self.tr("Facade grid"), self.tr("Equal panels in a rectangle on a wall")),
            (SiteTool.HOME, self.tr("Home"), self.tr("Click where the aircraft takes off and lands")),
            (
                SiteTool.RALLY,
                self.tr("Rally point"),
                self.tr("Click where the aircraft may land instead of home when it returns"),
            ),
            (SiteTool.NO_FLY, self.tr("No-fly zone"), self.tr("Draw a zone that must not be entered on the ground")),
            (SiteTool.BOX, self.tr("Obstacle box"), self.tr("Draw a box: two corners on the ground, then the height")),
            (SiteTool.ORIGIN, self.tr("Site origin"), self.tr("Click on the map where the site origin lies")),
            (SiteTool.AIRSPACE, self.tr("Airspace"), self.tr("Draw the box in which the aircraft must stay")),
        )

    def active(self) -> SiteTool | None:
        """The tool in use."""
        return self._active

    def button(self, tool: SiteTool) -> QPushButton:
        """The button of a tool."""
        return self._buttons[tool]

    def use(self, tool: SiteTool, n_rows: int = 1, n_columns: int = 1) -> None:
        """Start a tool: in the 3-D view, and on the map where that is shown and the tool marks a place on the ground.

        Rows and columns are those of a panel grid.
        """
        is_on_map = self._shared_view.page() is SharedViewPage.MAP and tool in (SiteTool.HOME, SiteTool.RALLY)
        if tool is SiteTool.ORIGIN or is_on_map:
            self._pick_on_map(tool)
            return
        if tool is SiteTool.GRID and self._active is not SiteTool.GRID:
            self.gridRequested.emit()
        self._shared_view.show_page(SharedViewPage.SCENE)

        def start(scene: SceneView) -> None:
            scene.start_tool(self._made(tool, n_rows, n_columns))
            self._set_active(tool)

        self._shared_view.with_scene(start)

    def cancel_drawing(self) -> None:
        """Put the tool in use away; nothing comes of it."""
        if self._scene is not None and self._active is not None:
            self._scene.cancel_tool()
        if self._map is not None and self._active is not None:
            self._map.cancel_pick()
        self._set_active(None)

    def set_grid(self, n_rows: int, n_columns: int) -> None:
        """Rows and columns that a panel grid is shown with while it is picked."""
        if self._grid_tool is not None:
            self._grid_tool.set_grid(n_rows, n_columns)

    def add_mesh(self, path: Path) -> None:
        """Add an obstacle from a mesh file."""

        def added(mesh: TriangleMesh) -> None:
            chosen = ""

            def edit(model: SiteModel) -> SiteModel:
                nonlocal chosen
                edited, chosen = add_mesh_obstacle(model, path.stem, mesh)
                return edited

            self._apply(self.tr("Add obstacle {0}").format(path.stem), edit)
            if chosen:
                self._context.jump_to(Item(ItemKind.OBSTACLE, chosen))

        self._context.start(self.tr("Read {0}").format(path.name), lambda _context: read_mesh(path), added)

    def add_zones(self, paths: tuple[Path, ...]) -> None:
        """Add files of geo-zones."""
        model = self._context.document.site
        if model is None or not paths:
            return
        label = self.tr("Add zones of {0}").format(", ".join(path.name for path in paths))

        def added(found: AddedZones) -> None:
            before = self._context.document.site
            if before is not model:  # the site was edited while files were read: they are known now, so this is quick
                found = add_zones(before, paths, date.today()) if before is not None else found
            self._apply(label, lambda _model: found.model)
            names = [source.file for source in found.model.site.zones if source.file.endswith(paths[-1].name)]
            if names:
                self._context.select(Item(ItemKind.ZONE_FILE, names[-1]))
            for note in found.notes:
                self._context.say(Severity.WARNING, self._context.localized(note))

        self._context.start(label, lambda context: add_zones(model, paths, date.today(), context), added)

    def _choose_zones(self) -> None:
        kinds = self.tr("Geo-zones (*.json *.geojson *.kml *.xml *.txt *.openair);;All files (*)")
        self.add_zones(choose_files(self, self.tr("Geo-zones"), kinds, Path.home()))

    def _connect(self, scene: SceneView) -> None:
        self._scene = scene
        scene.toolFinished.connect(self._finished)
        scene.toolEnded.connect(self._ended)

    def _pick_on_map(self, tool: SiteTool) -> None:
        self.cancel_drawing()
        self._shared_view.show_page(SharedViewPage.MAP)
        if self._map is None:
            self._map = self._shared_view.map_page()
            self._map.placePicked.connect(self._place_picked)
            self._map.pickEnded.connect(self._ended)
        hints = {
            SiteTool.HOME: self.tr("Click where the aircraft takes off and lands. Esc cancels."),
            SiteTool.RALLY: self.tr("Click where the aircraft may land when it returns. Esc cancels."),
            SiteTool.ORIGIN: self.tr("Click where the site origin lies: all of the site moves there. Esc cancels."),
        }
        self._map.start_pick(hints[tool])
        self._set_active(tool)

    def _place_picked(self, lat_deg: float, lon_deg: float) -> None:
        tool = self._active
        if tool is None:
            return
        self._set_active(None)
        if tool is SiteTool.ORIGIN:
            self._move_origin(lat_deg, lon_deg)
        elif tool is SiteTool.HOME:
            self._apply(
                self.tr("Move home"),
                lambda model: move_home(model, ground_at(model, lat_deg, lon_deg)),
                Item(ItemKind.HOME),
            )
        elif tool is SiteTool.RALLY:
            self._add(
                self.tr("Mark rally point"),
                lambda model: add_rally_point(model, ground_at(model, lat_deg, lon_deg)),
                ItemKind.RALLY,
            )

    def _move_origin(self, lat_deg: float, lon_deg: float) -> None:
        """Move the site origin; its height above sea level stays, for a map has none."""

        def edit(model: SiteModel) -> SiteModel:
            height_m = height_above_sea_m(model.site.origin)
            return set_origin(model, lat_deg, lon_deg, height_m, HeightReference.SEA_LEVEL)

        self._apply(self.tr("Set origin"), edit)

    def _made(self, tool: SiteTool, n_rows: int, n_columns: int) -> Tool:
        from groundstation.gui.view3d.drawing_tools import BoxTool, PolygonTool, RectangleTool
        from groundstation.gui.view3d.tools import HomeTool, RallyTool

        match tool:
            case SiteTool.NO_FLY:
                return PolygonTool()
            case SiteTool.BOX | SiteTool.AIRSPACE:
                return BoxTool()
            case SiteTool.HOME:
                return HomeTool()
            case SiteTool.RALLY:
                return RallyTool()
            case SiteTool.ORIGIN:
                raise ValueError("the origin is picked on the map")
            case SiteTool.GRID:
                self._grid_tool = RectangleTool(n_rows, n_columns)
                return self._grid_tool

    def _set_active(self, tool: SiteTool | None) -> None:
        self._active = tool
        if tool is not SiteTool.GRID:
            self._grid_tool = None
        for known, button in self._buttons.items():
            button.setChecked(known is tool)

    def _ended(self) -> None:
        # Other tabs use tools as well; theirs end without anything to do here.
        if self._active is not None:
            self._set_active(None)

    def _finished(self, result: object) -> None:
        tool = self._active
        if tool is None:
            return
        self._set_active(None)
        take: dict[SiteTool, Callable[[Any], None]] = {
            SiteTool.NO_FLY: self._add_zone,
            SiteTool.BOX: self._add_box,
            SiteTool.AIRSPACE: self._set_airspace,
            SiteTool.HOME: self._move_home,
            SiteTool.RALLY: self._add_rally_point,
            SiteTool.GRID: self._take_rectangle,
        }
        take[tool](result)

    def _add_zone(self, drawn: DrawnPolygon) -> None:
        self._add(self.tr("Draw no-fly zone"), lambda model: add_zone(model, drawn.corners_enu_m), ItemKind.NO_FLY)

    def _add_box(self, drawn: DrawnBox) -> None:
        low, high = drawn.min_enu_m, drawn.max_enu_m
        self._add(self.tr("Draw obstacle"), lambda model: add_box(model, low, high), ItemKind.OBSTACLE)

    def _set_airspace(self, drawn: DrawnBox) -> None:
        def edit(model: SiteModel) -> SiteModel:
            airspace = model.site.airspace
            (x0, y0, _), floor = drawn.min_enu_m, airspace.min_enu_m[2]
            return set_airspace(model, (x0, y0, floor), drawn.max_enu_m, airspace.ground_z_m)

        self._apply(self.tr("Draw airspace"), edit, Item(ItemKind.AIRSPACE))

    def _move_home(self, picked: PickedHome) -> None:
        self._apply(self.tr("Move home"), lambda model: move_home(model, picked.point_enu_m), Item(ItemKind.HOME))

    def _add_rally_point(self, picked: PickedHome) -> None:
        self._add(self.tr("Mark rally point"), lambda model: add_rally_point(model, picked.point_enu_m), ItemKind.RALLY)

    def _take_rectangle(self, picked: PickedRectangle) -> None:
        self.gridPicked.emit((picked.lower_left_enu_m, picked.lower_right_enu_m, picked.upper_left_enu_m))

    def _add(self, label: str, edit: Callable[[SiteModel], tuple[SiteModel, str]], kind: ItemKind) -> None:
        """An edit that also returns the name of what it added; that is selected."""
        names: list[str] = []

        def only_model(model: SiteModel) -> SiteModel:
            edited, name = edit(model)
            names.append(name)
            return edited

        self._apply(label, only_model)
        if names:
            self._context.select(Item(kind, names[-1]))

    def _apply(self, label: str, edit: Edit, select: Item | None = None) -> None:
        error = self._editor.apply(label, edit, select)
        if error:
            self._context.say(Severity.ERROR, f"{label}: {error}")

    def _choose_mesh(self) -> None:
        kinds = " ".join(f"*{suffix}" for suffix in MESH_SUFFIXES)
        path = choose_file(self, self.tr("Obstacle mesh"), self.tr("Meshes ({0})").format(kinds))
        if path is not None:
            self.add_mesh(path)
