"""The view of a scene with all around it: layers, another model beside it, sections, measuring, panels marked."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QCheckBox, QComboBox, QHBoxLayout, QLabel, QPushButton, QSlider, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.model.model_controller import ModelController
from groundstation.gui.model.picture_places import places_in
from groundstation.gui.reconstruct.model_view import USUAL_DISTANCE_M, GuidedCamera, Mark, ModelView
from groundstation.gui.reconstruct.view_pictures import View, ViewPictures, layer_names, leave_card, tell_device
from groundstation.gui.widgets.inputs import ChoiceBox, calm
from groundstation.gui.widgets.scrolling import WrappingRow, labelled
from groundstation.gui.widgets.theme import colours
from groundstation.services.model.scene_card import PanelRow, view_of
from groundstation.services.reconstruct.messages import Probe, Probed, Section, Subject, ViewAnswer
from groundstation.services.units import UnitSystem, length_unit
from planning.geo.frames import Vec3
from reconstruction.base.cameras import PosedPhoto
from reconstruction.objects.picking import picked
from reconstruction.training.layers import PICTURE

STEPS = 1000
"""Of the section's slider."""

AROUND_M = 2.0
"""Around the panels, that a section can be moved to."""

NUMBERS = itertools.count(1)

PICK, MEASURE = "pick", "measure"


class ScenePane(QWidget):
    """Looks at the controller's scene.

    Signals
    -------
    saveRequested()
        The picture is to be kept.
    """

    saveRequested = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, context: ApplicationContext, controller: ModelController, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context, self._controller = context, controller
        self.view, self.layer, self.compare = ModelView(), ChoiceBox(), ChoiceBox()
        self.home, self.measure = QPushButton(self.tr("Facade")), QPushButton(self.tr("Measure"))
        self.front, self.save = QPushButton(self.tr("Panel")), QPushButton(self.tr("Save ..."))
        self.axis, self.cut, self.turn_over = ChoiceBox(), QSlider(Qt.Orientation.Horizontal), QCheckBox()
        calm(self.cut)
        self.cut_at = QLabel()
        self.pictures_in_view = ViewPictures(
            controller.request_view, self._size_px, self, lambda: context.models_drawn_by
        )
        self.guided = GuidedCamera(self.view, self)
        self._images: dict[str, QImage | None] = {"left": None, "right": None}
        self._problem = ""
        self._answer: ViewAnswer | None = None
        self._pointed = -1
        self._asked = {PICK: 0, MEASURE: 0}
        self._measured: list[Vec3] = []
        self._units = UnitSystem.METRIC
        self._make()
        self._connect()
        self.set_scene()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._say()

    def camera(self) -> PosedPhoto | None:
        """Where the view is from."""
        return self.guided.camera

    def picture(self) -> QImage:
        """What is shown now, with what is drawn over it."""
        return self.view.grab(self.view.room().toAlignedRect()).toImage()

    def set_scene(self) -> None:
        """Show the controller's scene."""
        card = self._controller.card
        self._measured, self._pointed = [], -1
        self.compare.clear()
        self.compare.addItem(self.tr("nothing"), "")
        for folder in self._controller.others:
            self.compare.addItem(folder.name, str(folder))
        self.axis.setCurrentIndex(0)
        self.guided.camera = None if card is None else card.first_view
        self.guided.distance_m = USUAL_DISTANCE_M
        for widget in (self.layer, self.compare, self.home, self.measure, self.axis, self.save):
            widget.setEnabled(card is not None)
        self.show_view()

    def show_view(self) -> None:
        """Show what is chosen, from where the camera is."""
        card = self._controller.card
        if self.guided.camera is None or card is None:
            self._images = {"left": None, "right": None}
            self.pictures_in_view.show(None)
            self._say()
            return
        left, right = self._subjects()
        if right is None:
            self._images["right"] = None
        layer = str(self.layer.currentData() or PICTURE)
        tints, right_tints = (
            (self._controller.tints, self._controller.comparison_tints) if layer == PICTURE else ((), ())
        )
        self.pictures_in_view.show(View(self.guided.camera, left, right, layer, "", tints, self.section(), right_tints))
        self._say()

    def section(self) -> Section | None:
        """The plane that cuts the model."""
        axis = self.axis.currentData()
        if axis is None or self._controller.card is None or not self._controller.card.panels:
            return None
        return Section(int(axis), self._cut_m(), not self.turn_over.isChecked())

    # How it is put together

    def _make(self) -> None:
        for name, text in layer_names().items():
            self.layer.addItem(text, name)
        for text, axis in (
            (self.tr("none"), None),
            (self.tr("height"), 2),
            (self.tr("east"), 0),
            (self.tr("north"), 1),
        ):
            self.axis.addItem(text, axis)
        self.cut.setRange(0, STEPS)
        self.cut.setValue(STEPS // 2)
        self.cut.setAccessibleName(self.tr("Where the section is"))
        self.turn_over.setText(self.tr("other side"))
        self.measure.setCheckable(True)
        self.measure.setToolTip(self.tr("Click two places: how far they are apart"))
        self.home.setToolTip(self.tr("See the largest facade from the front (0)"))
        self.save.setToolTip(self.tr("Save the picture as a file"))
        self.front.setToolTip(self.tr("See the chosen panel from the front"))
        layout, bar, below = QVBoxLayout(self), WrappingRow(), QHBoxLayout()
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        for title, box in ((self.tr("Layer"), self.layer), (self.tr("Beside it"), self.compare)):
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(7)
            bar.addWidget(labelled(title, box))
        for widget in (self.home, self.front, self.measure, self.save):
            bar.addWidget(widget)
        label = QLabel(self.tr("Section"))
        label.setBuddy(self.axis)
        below.addWidget(label)
        below.addWidget(self.axis)
        below.addWidget(self.cut, 1)
        below.addWidget(self.cut_at)
        below.addWidget(self.turn_over)
        below.setSpacing(8)
        layout.addLayout(bar)
        layout.addWidget(self.view, 1)
        layout.addLayout(below)

    def _connect(self) -> None:
        view, controller = self.view, self._controller
        self.layer.currentIndexChanged.connect(self.show_view)
        self.compare.currentIndexChanged.connect(self._set_beside)
        self.axis.currentIndexChanged.connect(self.show_view)
        self.cut.valueChanged.connect(self.show_view)
        self.turn_over.toggled.connect(self.show_view)
        self.measure.toggled.connect(self._measuring)
        self.home.clicked.connect(self.go_home)
        self.front.clicked.connect(self.face_panel)
        self.save.clicked.connect(self.saveRequested)
        self.guided.cameraMoved.connect(self._camera_moved)
        view.homeRequested.connect(self.go_home)
        view.resized.connect(self.show_view)
        self._context.drawnByChanged.connect(self.show_view)
        view.clicked.connect(self._clicked)
        view.pointed.connect(self._point_at)
        self.pictures_in_view.pictureCame.connect(self._show_picture)
        controller.viewAnswered.connect(self._take)
        controller.probed.connect(self._take_probe)
        controller.selectionChanged.connect(self._say)
        controller.coloursChanged.connect(self.show_view)

    # What the user does

    def go_home(self) -> None:
        """See the largest facade."""
        if self._controller.card is not None:
            self._look_from(self._controller.card.first_view)

    def face_panel(self) -> None:
        """See the chosen panel from the front."""
        panel = self._selected()
        if panel is not None:
            self._look_from(view_of((panel,)))

    def _look_from(self, camera: PosedPhoto) -> None:
        self.guided.camera = camera
        self.show_view()

    def _camera_moved(self) -> None:
        self.show_view()

    def _set_beside(self) -> None:
        other = str(self.compare.currentData() or "")
        self._controller.set_comparison_scene(Path(other) if other else None)
        self.show_view()

    def _clicked(self, x: float, y: float) -> None:
        """Ask which panel or place it is; the process of models answers, as it knows what stands before it."""
        left, _ = self._subjects()
        if self.guided.camera is None or left is None:
            return
        lens = self.guided.camera.intrinsics
        what = MEASURE if self.measure.isChecked() else PICK
        self._asked[what] = next(NUMBERS)
        at = (x * lens.width_px, y * lens.height_px)
        self._controller.probe(Probe(what, self._asked[what], left, self.guided.camera, at, self.section()))

    def _point_at(self, x: float, y: float) -> None:
        """Mark the panel under the mouse, as far as its edges tell."""
        card, camera = self._controller.card, self.guided.camera
        number = -1
        if card is not None and camera is not None and card.panels and 0.0 <= x <= 1.0 and 0.0 <= y <= 1.0:
            lens = camera.intrinsics
            number = int(picked(card.quads, camera, np.array([[x * lens.width_px, y * lens.height_px]]))[0])
        if number != self._pointed:
            self._pointed = number
            self._mark()

    def _measuring(self) -> None:
        self._measured = []
        self._say()

    # What is shown

    def _selected(self) -> PanelRow | None:
        card = self._controller.card
        return None if card is None else card.by_global_id.get(self._controller.selected)

    def _subjects(self) -> tuple[Subject | None, Subject | None]:
        card = self._controller.card
        if card is None:
            return None, None
        other = str(self.compare.currentData() or "")
        return Subject("model", card.folder), Subject("model", Path(other)) if other else None

    def _take(self, answer: ViewAnswer | None) -> None:
        if answer is None:
            self.pictures_in_view.forget()
            leave_card(self._context, self._answer)
        else:
            self.pictures_in_view.take(answer)

    def _take_probe(self, found: Probed) -> None:
        card, probe = self._controller.card, found.probe
        if card is None or probe.number != self._asked.get(probe.place):
            return
        if found.problem:
            self._problem = found.problem
        elif probe.place == PICK:
            panel = None if found.panel is None else card.by_number.get(found.panel)
            self._controller.select("" if panel is None else panel.global_id)
        elif found.point_enu_m is not None:
            self._measured = [*(self._measured if len(self._measured) < 2 else []), found.point_enu_m]
        self._say()

    def _show_picture(self, place: str, image: QImage | None, answer: ViewAnswer) -> None:
        left, right = self._subjects()
        if answer.look.subject != (left if place == "left" else right):
            return
        self._images[place], self._answer = image, answer
        tell_device(self._context, self.view, answer)
        self._problem = answer.problem
        if place == "left" and answer.depth_m is not None:
            self.guided.distance_m = answer.depth_m
        self._say()

    def _say(self) -> None:
        card, axis = self._controller.card, self.axis.currentData()
        for widget in (self.cut, self.turn_over, self.cut_at):
            widget.setEnabled(axis is not None and card is not None)
        self.cut_at.setText("" if self.section() is None else length_unit(self._units).text(self._cut_m()))
        self.front.setEnabled(self._selected() is not None)
        self.view.set_pictures(self._images["left"], self._images["right"])
        name = "" if card is None else card.folder.name
        self.view.set_words(name if self._images["right"] is not None else "", self.compare.currentText())
        self.view.set_note(self._note())
        self._mark()

    def _note(self) -> str:
        if self._controller.card is None:
            return self.tr("Open a model: the folder of a training that is finished.")
        if self._problem:
            return str(self._context.localized(self._problem))
        if not self.measure.isChecked():
            return ""
        return self._length_words() or self.tr("Click two places.")

    def _length_words(self) -> str:
        if len(self._measured) < 2:
            return ""
        first, second = np.array(self._measured)
        unit = length_unit(self._units)
        return self.tr("{0}; {1} along the ground, {2} in height").format(
            unit.text(float(np.linalg.norm(second - first))),
            unit.text(float(np.linalg.norm((second - first)[:2]))),
            unit.text(float(second[2] - first[2])),
        )

    def _mark(self) -> None:
        """Outline the chosen panel and the one under the mouse, and draw what is measured."""
        card, look = self._controller.card, colours()
        marks = []
        if card is not None:
            pointed = card.panels[self._pointed] if 0 <= self._pointed < len(card.panels) else None
            selected = self._selected()
            if pointed is not None and pointed is not selected:
                marks.append(self._outline(pointed, "#ffffff", pointed.name))
            if selected is not None:
                marks.append(self._outline(selected, look.open, ""))
            places = self._places(self._measured)
            if places is not None and self.measure.isChecked():
                text = ""
                if len(self._measured) == 2:
                    text = length_unit(self._units).text(math.dist(*self._measured))
                marks.append(Mark(places, "#ffe000", is_closed=False, text=text))
        self.view.set_marks(tuple(mark for mark in marks if mark is not None))

    def _outline(self, panel: PanelRow, colour: str, text: str) -> Mark | None:
        places = self._places(panel.element.corners_enu_m)
        return None if places is None else Mark(places, colour, text=text)

    def _places(self, points_enu_m: tuple[Vec3, ...] | list[Vec3]) -> tuple[tuple[float, float], ...] | None:
        """Where points are in the picture, in shares of it; None where one is beside or behind the camera."""
        found = None if self.guided.camera is None else places_in(self.guided.camera, points_enu_m)
        if self.guided.camera is None or found is None:
            return None
        lens = self.guided.camera.intrinsics
        return tuple((place.x() / lens.width_px, place.y() / lens.height_px) for place in found)

    def _cut_m(self) -> float:
        card, axis = self._controller.card, self.axis.currentData()
        if card is None or axis is None or not card.panels:
            return 0.0
        along = card.quads.corners_enu_m[..., int(axis)]
        low, high = float(along.min()) - AROUND_M, float(along.max()) + AROUND_M
        return low + (high - low) * self.cut.value() / STEPS

    def _size_px(self) -> tuple[int, int]:
        return max(16, self.view.width()), max(12, self.view.height())
