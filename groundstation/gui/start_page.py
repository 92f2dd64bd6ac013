"""The start page: a finished sample project, the projects that were open last, and the ways to begin a new one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, QSize, Signal, SignalInstance
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.shared_view import SharedView
from groundstation.gui.widgets.icons import set_icon
from groundstation.gui.widgets.scrolling import WrappingRow, scrolled
from groundstation.services.project.steps import Act

CARD_PX, CARD_ICON_PX = 56, 28
"""Height of the large buttons, and size of their icons."""

MOST_RECENT = 6
"""Projects that are offered; the menu has all."""


@dataclass(frozen=True, slots=True)
class _Way:
    """One large button, with what it leads to."""

    title: str
    says: str
    icon: str
    signal: SignalInstance
    is_primary: bool = False


class StartPage(QObject):
    """The tab.

    Signals
    -------
    sampleRequested(), bundledRequested(), buildingRequested(), photosRequested(), missionRequested()
        How the user wants to begin.
    projectRequested(), recentRequested(str)
        A project is to be chosen; the one in a folder.
    tourRequested(bool)
        The tour is wanted, or (False) it is not.
    manualRequested()
    """

    sampleRequested = Signal()  # noqa: N815  (Qt's own way of naming)
    bundledRequested = Signal()  # noqa: N815
    buildingRequested = Signal()  # noqa: N815
    photosRequested = Signal()  # noqa: N815
    missionRequested = Signal()  # noqa: N815
    projectRequested = Signal()  # noqa: N815
    recentRequested = Signal(str)  # noqa: N815
    tourRequested = Signal(bool)  # noqa: N815
    manualRequested = Signal()  # noqa: N815

    def __init__(self, _context: ApplicationContext, shared_view: SharedView) -> None:
        super().__init__(shared_view)
        self._tour = self._make_tour_offer()
        self._recent_title, self._recent = _heading(self.tr("Recent projects")), WrappingRow()
        self.left: QWidget = scrolled(self._make_page())
        self.right: QWidget | None = None
        self.bottom: QWidget | None = None

    # A tab

    def shown(self) -> None:
        """Everything is as it was."""

    def hidden(self) -> None:
        """Nothing of the shared view was taken."""

    def actions(self) -> tuple[QAction, ...]:
        """There are none."""
        return ()

    def take_step(self, act: Act) -> None:
        """All that leads on from here is on the page."""

    # What is shown

    def set_recent(self, folders: tuple[str, ...]) -> None:
        """Offer projects that were open before, the latest first."""
        while (item := self._recent.takeAt(0)) is not None:
            widget = item.widget()
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        shown = folders[:MOST_RECENT]
        of_name = Counter(Path(folder).name for folder in shown)
        for folder in shown:
            name, parent = Path(folder).name, Path(folder).parent.name
            text = name if of_name[name] == 1 else self.tr("{0} in {1}").format(name, parent)
            button = QPushButton(text.replace("&", "&&"))  # else it underlines what comes next
            button.setToolTip(folder)
            set_icon(button, "recent")
            button.clicked.connect(partial(self._ask_for, folder))
            self._recent.addWidget(button)
        self._recent_title.setVisible(bool(folders))

    def offer_tour(self, is_offered: bool) -> None:
        """Whether the tour is offered above everything else, as to somebody who is here for the first time."""
        self._tour.setVisible(is_offered)

    def _ask_for(self, folder: str, _checked: bool = False) -> None:
        self.recentRequested.emit(folder)

    # How it is put together

    def _make_page(self) -> QWidget:
        page = QWidget()
        layout = QVBoxLayout(page)
        layout.setContentsMargins(16, 10, 16, 10)
        layout.setSpacing(8)
        look = (
            _Way(
                self.tr("Sample project"),
                self.tr("A small glass facade with everything done, from the plan to the model"),
                "sample",
                self.sampleRequested,
                is_primary=True,
            ),
            _Way(
                self.tr("Bundled site"),
                self.tr("An office building with 280 panels, to plan and fly in simulation"),
                "site",
                self.bundledRequested,
            ),
            _Way(
                self.tr("Open a project ..."),
                self.tr("A folder that Reflight has saved, or a finished model"),
                "open",
                self.projectRequested,
            ),
        )
        ways = (
            _Way(
                self.tr("Building model ..."),
                self.tr("IFC, CityGML, CityJSON, OBJ, PLY, GLB or STL"),
                "building",
                self.buildingRequested,
            ),
            _Way(
                self.tr("Photos of a first flight ..."),
                self.tr("Walls, roofs and ground are made of the photos alone"),
                "photos",
                self.photosRequested,
            ),
            _Way(
                self.tr("Mission of another program ..."),
                self.tr("A KMZ, .plan, .waypoints, KML or CSV file"),
                "mission-file",
                self.missionRequested,
            ),
        )
        layout.addWidget(self._tour)
        for title, cards in ((self.tr("Look around"), look), (self.tr("Begin a project with"), ways)):
            layout.addWidget(_heading(title))
            layout.addLayout(_grid(cards))
        layout.addWidget(self._recent_title)
        layout.addLayout(self._recent)
        layout.addWidget(_heading(self.tr("Learn")))
        below = WrappingRow()
        for text, name, slot in (
            (self.tr("Manual"), "manual", self.manualRequested.emit),
            (self.tr("Tour of the window"), "tour", partial(self.tourRequested.emit, True)),
        ):
            button = QPushButton(text)
            set_icon(button, name)
            button.clicked.connect(partial(_call, slot))
            below.addWidget(button)
        layout.addLayout(below)
        layout.addStretch(1)
        return page

    def _make_tour_offer(self) -> QWidget:
        offer = QFrame()
        offer.setFrameShape(QFrame.Shape.StyledPanel)
        text = QLabel(self.tr("New here? The tour shows the window in a minute; it can be left at any time."))
        text.setWordWrap(True)
        take, leave = QPushButton(self.tr("Take the tour")), QPushButton(self.tr("Not now"))
        set_icon(take, "tour")
        layout = QHBoxLayout(offer)
        layout.addWidget(text, 1)
        layout.addWidget(take)
        layout.addWidget(leave)
        take.clicked.connect(partial(self._tour_answered, True))
        leave.clicked.connect(partial(self._tour_answered, False))
        return offer

    def _tour_answered(self, is_wanted: bool, _checked: bool = False) -> None:
        self.tourRequested.emit(is_wanted)


def _call(slot: Callable[[], object], _checked: bool = False) -> None:
    """Leave out what buttons tell of themselves."""
    slot()


def _grid(ways: tuple[_Way, ...]) -> QGridLayout:
    """Large buttons beside each other, each with what it leads to below it."""
    grid = QGridLayout()
    grid.setHorizontalSpacing(16)
    for column, way in enumerate(ways):
        button, says = QPushButton(way.title), QLabel(way.says)
        button.setStyleSheet(f"min-height: {CARD_PX}px; text-align: left; padding-left: 14px;")
        button.setProperty("primary", way.is_primary)
        set_icon(button, way.icon)
        button.setIconSize(QSize(CARD_ICON_PX, CARD_ICON_PX))
        button.setToolTip(way.says)
        button.clicked.connect(partial(_call, way.signal.emit))
        says.setWordWrap(True)
        says.setProperty("role", "muted")
        grid.addWidget(button, 0, column)
        grid.addWidget(says, 1, column)
        grid.setColumnStretch(column, 1)
    return grid


def _heading(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", "heading")
    return label
