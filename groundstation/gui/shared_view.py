"""The shared view in the middle of the window: the site in 3-D, on the map, or as a camera will see it.

The 3-D view takes about a second to import, so it is made after the window has been painted; whoever needs it asks
with `with_scene` and is called once it is there.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QMargins, QObject, QRect, QTimer, Signal
from PySide6.QtWidgets import QButtonGroup, QLabel, QPushButton, QStackedWidget, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import TURN_MS
from groundstation.gui.widgets.scrolling import WrappingRow
from groundstation.services.jobs.runner import Job
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.scenes.surfaces import Surface, site_surfaces
from groundstation.services.units import UnitSystem
from planning.base.findings import Severity
from planning.plan import Plan
from planning.site.records import SiteModel

if TYPE_CHECKING:
    from groundstation.gui.camera_preview.plan_player import PlanPlayer
    from groundstation.gui.camera_preview.preview import CameraPreview
    from groundstation.gui.map.map_view import MapView
    from groundstation.gui.view3d.scene_view import SceneView
    from groundstation.services.map.online import OnlineMap


class SharedViewPage(StrEnum):
    """What it shows."""

    SCENE = "scene"
    MAP = "map"
    CAMERA = "camera"


class SharedView(QWidget):
    """Shows the document's site and current plan, and the selection, in the way the user chose.

    Signals
    -------
    sceneReady(SceneView)
        Once, when the 3-D view is there.
    tilesChanged(str), overlaysChanged(tuple of Path), onlineChanged(OnlineMap)
        Another file with map tiles is shown; there are other overlays; the online map is set up otherwise.
    tabRequested(str)
        Another tab should come to the front.
    closing(QCloseEvent)
        The window is about to close; who ignores the event keeps it open.
    pageShown(SharedViewPage)
    aloneRequested(bool)
        The view wants the room of the lists beside and below it, or gives it back.
    resized()
    """

    sceneReady = Signal(object)  # noqa: N815  (Qt's own way of naming)
    tilesChanged = Signal(str)  # noqa: N815
    overlaysChanged = Signal(object)  # noqa: N815
    onlineChanged = Signal(object)  # noqa: N815
    tabRequested = Signal(str)  # noqa: N815
    closing = Signal(object)
    pageShown = Signal(object)  # noqa: N815
    aloneRequested = Signal(bool)  # noqa: N815
    resized = Signal()

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._insets = QMargins()
        self._scene: SceneView | None = None
        self._making: SceneView | None = None
        self._map: MapView | None = None
        self._tiles: Path | None = None
        self._overlays: tuple[Path, ...] = ()
        self._online: OnlineMap | None = None
        self._follows_camera = False
        self._camera_viewpoint = ""
        self._in_camera: tuple[SiteModel | None, Plan | None, str] = (None, None, "")
        self._camera: CameraPreview | None = None
        self._waiting: list[Callable[[SceneView], object]] = []
        self._has_shown_plan = False
        self._looking_around: Job[tuple[Surface, ...]] | None = None
        self._pages = QStackedWidget()
        self._loading = QLabel(self.tr("The 3-D view is being prepared ..."))
        self._loading.setProperty("role", "muted")
        self._pages.addWidget(self._loading)
        self._buttons = QButtonGroup(self)
        self._bar = WrappingRow()
        self._add_buttons()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addLayout(self._bar)
        layout.addWidget(self._pages, 1)
        self._player: PlanPlayer | None = None
        self._layout = layout
        self._pages.installEventFilter(self)
        context.documentChanged.connect(self._document_changed)
        context.selectionChanged.connect(self._show_selection)
        context.lookAtRequested.connect(self._look_at)
        context.unitsChanged.connect(self._units_changed)

    def _add_buttons(self) -> None:
        for page, text, tip in (
            (SharedViewPage.SCENE, self.tr("3-D"), self.tr("The site in three dimensions")),
            (SharedViewPage.MAP, self.tr("Map"), self.tr("The site from above, on the map")),
            (SharedViewPage.CAMERA, self.tr("Camera"), self.tr("What a viewpoint will see")),
        ):
            button = QPushButton(text)
            button.setCheckable(True)
            button.setToolTip(tip)
            button.setProperty("page", page.value)
            button.clicked.connect(lambda _checked=False, page=page: self.show_page(page))
            self._buttons.addButton(button)
            self._bar.addWidget(button)
        self._buttons.buttons()[0].setChecked(True)

    def page(self) -> SharedViewPage:
        """What is shown."""
        button = self._buttons.checkedButton()
        assert button is not None
        return SharedViewPage(button.property("page"))

    def show_page(self, page: SharedViewPage) -> None:
        """Show the site in another way."""
        for button in self._buttons.buttons():
            button.setChecked(button.property("page") == page.value)
        match page:
            case SharedViewPage.SCENE:
                self._pages.setCurrentWidget(self._loading if self._scene is None else self._scene)
            case SharedViewPage.MAP:
                self._pages.setCurrentWidget(self.map_page())
            case SharedViewPage.CAMERA:
                self._pages.setCurrentWidget(self.camera_page())
        self._update_pages()
        self._show_player()
        self.pageShown.emit(page)

    def room(self) -> QRect:
        """Where the pages are, for what a tab lays over them."""
        return self._pages.geometry()

    def set_insets(self, insets: QMargins) -> None:
        """Keep marks and buttons of the 3-D view and the map free of what lies over their edges."""
        self._insets = insets
        for view in (self._scene, self._map):
            if view is not None:
                view.set_insets(insets)
        self._show_player()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Tell of another size of the pages."""
        if watched is self._pages and event.type() in (QEvent.Type.Resize, QEvent.Type.Move):
            self.resized.emit()
        return super().eventFilter(watched, event)

    def scene(self) -> SceneView | None:
        """The 3-D view; None before it is ready."""
        return self._scene

    def with_scene(self, callback: Callable[[SceneView], object]) -> None:
        """Call with the 3-D view: now, or once it is ready."""
        if self._scene is not None:
            callback(self._scene)
        else:
            self._waiting.append(callback)

    def add_overlay_bar(self, widget: QWidget) -> None:
        """Put a widget of a tab beside the buttons that choose the page."""
        self._bar.addWidget(widget)

    def map_page(self) -> MapView:
        """The map; made when it is first wanted."""
        if self._map is None:
            from groundstation.gui.map.map_view import MapView

            self._map = MapView(self)
            self._map.set_units(self._context.units)
            self._map.set_insets(self._insets)
            self._map.picked.connect(self._context.select)
            self._map.refused.connect(lambda text: self._context.say(Severity.ERROR, text))
            if self._tiles is not None:
                self._map.open_map(self._tiles)
            if self._online is not None:
                self._map.set_online(self._online)
            for path in self._overlays:
                self._map.add_overlay(path)
            self._map.mapChanged.connect(lambda path: self.tilesChanged.emit(str(path)))
            self._map.overlaysChanged.connect(self.overlaysChanged)
            self._map.onlineChanged.connect(self.onlineChanged)
            self._pages.addWidget(self._map)
        return self._map

    def set_tiles(self, path: Path) -> None:
        """Show these tiles once the map is shown."""
        self._tiles = path

    def set_map(self, overlays: tuple[Path, ...], online: OnlineMap) -> None:
        """Show these overlays and this online map once the map is shown."""
        self._overlays, self._online = overlays, online

    def open_tiles(self, path: Path) -> None:
        """Show the map, with other tiles."""
        self.show_page(SharedViewPage.MAP)
        self.map_page().open_map(path)

    def camera_page(self) -> CameraPreview:
        """The camera preview; made when it is first wanted."""
        if self._camera is None:
            from groundstation.gui.camera_preview.photo_controller import PhotoController
            from groundstation.gui.camera_preview.preview import CameraPreview

            self._camera = CameraPreview(self)
            self.photo_controller = PhotoController(self._context, self._camera, self)
            self._camera.set_units(self._context.units)
            self._camera.viewpointShown.connect(self._follow_camera)
            self._pages.addWidget(self._camera)
        return self._camera

    def make_scene(self) -> None:
        """Make the 3-D view, in three turns; its module is best imported before, on another thread.

        With the first OpenGL widget of a window, as a graphics card has one, Qt paints all of it anew; what VTK
        compiles for its first frame takes as long again. In one turn it would be a quarter of a second.
        """
        if self._scene is not None or self._making is not None:
            return
        from groundstation.gui.view3d.scene_view import SceneView

        self._making = SceneView(self)
        QTimer.singleShot(TURN_MS, self._making, self._fill_scene)

    def _fill_scene(self) -> None:
        """Let the view that was made show what there is by now."""
        scene = self._scene = self._making
        if scene is None:
            return
        self._pages.addWidget(scene)
        scene.set_units(self._context.units)
        scene.set_insets(self._insets)
        scene.picked.connect(lambda item, _modifiers: self._context.select(item))
        document = self._context.document
        scene.set_site(document.site)
        scene.set_plan(_plan_of(document), _locked_in(document))
        scene.surroundingsWanted.connect(self._look_around)
        self._add_player(scene)
        self._show_selection(self._context.selection)
        if self.page() is SharedViewPage.SCENE:
            self._pages.setCurrentWidget(scene)
        self._bring_in_first_plan(scene, document)
        waiting, self._waiting = self._waiting, []
        for callback in waiting:
            callback(scene)
        self.sceneReady.emit(scene)
        QTimer.singleShot(TURN_MS, scene, scene.warm_up)

    def _look_around(self, model: SiteModel) -> None:
        """Have the virtual scene of a site made, and show it where the site is still that one."""

        def show(surfaces: tuple[Surface, ...]) -> None:
            if self._scene is not None and self._context.document.site is model:
                self._scene.set_surfaces(surfaces)

        if self._looking_around is not None and self._looking_around in self._context.jobs():
            self._context.cancel(self._looking_around, quietly=True)
        self._looking_around = self._context.start(
            self.tr("Simulated surroundings"), lambda job: job.run_in_process(site_surfaces, model), show
        )

    def player(self) -> PlanPlayer | None:
        """The bar that flies the plan; None before the 3-D view is ready."""
        return self._player

    def _add_player(self, scene: SceneView) -> None:
        from groundstation.gui.camera_preview.plan_player import PlanPlayer

        self._player = PlanPlayer()
        self._layout.addWidget(self._player)
        self._player.poseChanged.connect(scene.set_flown)
        self._player.set_plan(_plan_of(self._context.document))
        self._show_player()

    def _show_player(self) -> None:
        """The bar is there where the 3-D view shows a plan, and no flight lies over it."""
        if self._player is not None:
            is_wanted = self._player.duration_s > 0.0 and self._insets.isNull()
            self._player.setVisible(is_wanted and self.page() is SharedViewPage.SCENE)
            if not self._player.isVisibleTo(self):
                self._player.play.setChecked(False)

    def close_views(self) -> None:
        """Free what the views hold; call before the window goes away."""
        if self._making is not None:
            self._making.close_view()
            self._making = None
        if self._camera is not None:
            self._camera.close_view()
        if self._map is not None:
            self._map.close_view()

    def _document_changed(self, before: Document, after: Document) -> None:
        scene, plan = self._scene, _plan_of(after)
        if scene is not None:
            if before.site is not after.site:
                is_same_building = _is_same_building(before.site, after.site)
                scene.set_site(after.site, keep_camera=is_same_building)
                self._has_shown_plan = self._has_shown_plan and is_same_building
            if _plan_of(before) is not plan:
                scene.set_plan(plan, _locked_in(after))
                if self._player is not None:
                    self._player.set_plan(plan)
                    self._show_player()
            self._bring_in_first_plan(scene, after)
        self._update_pages()

    def _bring_in_first_plan(self, scene: SceneView, document: Document) -> None:
        """Let the first plan of a site be seen whole; afterwards the view is the user's."""
        if not self._has_shown_plan and _plan_of(document) is not None:
            self._has_shown_plan = True
            scene.bring_in_viewpoints()

    def _update_pages(self) -> None:
        """Bring the page that is shown up to date; the others wait until they are."""
        document, selection = self._context.document, self._context.selection
        if self._map is not None and self.page() is SharedViewPage.MAP:
            self._map.set_document(document)
            self._map.set_selection(selection)
        if self._camera is not None and self.page() is SharedViewPage.CAMERA and not self._follows_camera:
            if selection is not None and selection.kind is ItemKind.VIEWPOINT:
                self._camera_viewpoint = selection.id
            shown = document.site, _plan_of(document), self._camera_viewpoint
            # A flight that plays goes on when something else is selected.
            if shown != self._in_camera:
                self._in_camera = shown
                self._camera.set_view(*shown)

    def _follow_camera(self, viewpoint_id: str) -> None:
        """Select the viewpoint that a fly-through has come to, and let it fly on."""
        self._follows_camera = True
        self._context.select(Item(ItemKind.VIEWPOINT, viewpoint_id))
        self._follows_camera = False

    def _show_selection(self, item: Item | None) -> None:
        if self._scene is not None:
            self._scene.set_selection(() if item is None else (item,))
        self._update_pages()

    def _look_at(self, item: Item) -> None:
        if self.page() is SharedViewPage.CAMERA and item.kind is not ItemKind.VIEWPOINT:
            self.show_page(SharedViewPage.SCENE)
        if self._scene is not None:
            self._scene.look_at(item)
        if self._map is not None and self.page() is SharedViewPage.MAP:
            self._map.look_at(item)

    def _units_changed(self, units: UnitSystem) -> None:
        for view in (self._scene, self._map, self._camera):
            if view is not None:
                view.set_units(units)


def _is_same_building(before: SiteModel | None, after: SiteModel | None) -> bool:
    """Whether a site was edited or saved, rather than replaced by another."""
    if before is None or after is None:
        return False
    return before.building is after.building or before.site.name == after.site.name


def _plan_of(document: Document) -> Plan | None:
    return None if document.current is None else document.current.plan


def _locked_in(document: Document) -> frozenset[str]:
    plan = _plan_of(document)
    return frozenset() if plan is None else frozenset(view.id for view in plan.viewpoints if view.locked)
