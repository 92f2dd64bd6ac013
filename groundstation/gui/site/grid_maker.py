"""Makes a panel grid: picks its rectangle, checks it against the building while it is changed, shows it, adds it."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.shared_view import Stage
from groundstation.gui.site.grid_form import GridForm, GridRequest
from groundstation.gui.site.site_editor import SiteEditor
from groundstation.gui.site.site_tools import SiteTool, SiteTools
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.site.edits import AddedGrid, add_panel_grid
from planning.base.errors import InputError
from planning.site.bundled import Rectangle
from planning.site.importing.panel_grid import PanelGridError
from planning.site.records import SiteModel

CHECK_AFTER_MS = 200


def checked_grid(model: SiteModel, wish: GridRequest) -> AddedGrid | InputError:
    """The site with the grid that is wanted, or why it cannot be: an answer for the form, not a failure of a job."""
    if wish.rectangle_enu_m is None:
        raise ValueError("rectangle_enu_m: expected a rectangle that was picked")
    try:
        return add_panel_grid(model, wish.rectangle_enu_m, wish.n_rows, wish.n_columns, wish.gap_m, wish.tolerance_m)
    except InputError as error:
        return error


class GridMaker(QObject):
    """Connects the grid form with the rectangle tool, the checks and the document.

    Signals
    -------
    activeChanged(bool)
        A grid is being made, or no longer.
    """

    activeChanged = Signal(bool)  # noqa: N815  (Qt's own way of naming)

    def __init__(
        self, workspace: ApplicationContext, stage: Stage, editor: SiteEditor, tools: SiteTools, form: GridForm
    ) -> None:
        super().__init__(form)
        self._workspace, self._stage, self._editor = workspace, stage, editor
        self._tools, self._form = tools, form
        self._base: SiteModel | None = None
        self._added: AddedGrid | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(CHECK_AFTER_MS)
        self._timer.timeout.connect(self._check)
        tools.gridAsked.connect(self.begin)
        tools.gridPicked.connect(self._picked)
        form.valueChanged.connect(self._changed)
        form.pickAsked.connect(self._pick)
        form.accepted.connect(self._accept)
        form.cancelled.connect(self.end)
        workspace.documentChanged.connect(self._document_changed)
        form.hide()

    def begin(self) -> None:
        """Show the form."""
        if self._form.isHidden():
            self._form.setValue(GridRequest())
            self._form.show()
            self.activeChanged.emit(True)

    def end(self) -> None:
        """Give the grid up, and show the site as it is."""
        self._timer.stop()
        if self._tools.active() is SiteTool.GRID:
            self._tools.put_away()
        self._leave()
        self._show_site(self._workspace.document.site)

    def _leave(self) -> None:
        self._form.hide()
        self.activeChanged.emit(False)

    def _pick(self) -> None:
        wish = self._form.value()
        self._tools.use(SiteTool.GRID, wish.n_rows, wish.n_columns)

    def _picked(self, rectangle: Rectangle) -> None:
        self._form.set_rectangle(rectangle)

    def _changed(self, wish: GridRequest) -> None:
        self._tools.set_grid(wish.n_rows, wish.n_columns)
        if wish.rectangle_enu_m is not None:
            self._form.show_state(self.tr("Checking ..."), is_good=False)
            self._timer.start()

    def _check(self) -> None:
        model, wish = self._workspace.document.site, self._form.value()
        if model is None or wish.rectangle_enu_m is None or self._form.isHidden():
            return

        def checked(result: AddedGrid | InputError) -> None:
            if self._form.value() == wish and self._workspace.document.site is model and not self._form.isHidden():
                self._show_result(model, result)

        self._workspace.start(self.tr("Check the panel grid"), lambda _context: checked_grid(model, wish), checked)

    def _show_result(self, base: SiteModel, result: AddedGrid | InputError) -> None:
        if isinstance(result, InputError):
            self._added = None
            self._form.show_error(
                result.field if isinstance(result, PanelGridError) else None, self._workspace.words(str(result))
            )
            self._show_site(base)
            return
        self._base, self._added = base, result
        text = "\n".join(map(self._workspace.words, result.notes)) or self.tr(
            "The panels lie on the building and look outwards."
        )
        self._form.show_state(text, is_good=True)
        self._show_site(result.model)

    def _accept(self) -> None:
        added, base = self._added, self._base
        if added is None or base is None:
            return
        self._leave()
        self._editor.apply(
            self.tr("Add panel grid {0}").format(added.facade_id),
            lambda _model: added.model,
            Item(ItemKind.FACADE, added.facade_id),
        )

    def _show_site(self, model: SiteModel | None) -> None:
        scene = self._stage.scene()
        if scene is not None:
            scene.set_site(model, keep_camera=True)

    def _document_changed(self, before: Document, after: Document) -> None:
        # A grid that was checked fits the site of then; on another one it is checked anew.
        if after.site is not before.site and not self._form.isHidden():
            self._added = None
            self._changed(self._form.value())
