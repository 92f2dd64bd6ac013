"""The view of a model with everything around it: what is shown, the line between two pictures, and the photos below."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QModelIndex, QRect, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QSlider, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.reconstruct.model_view import GuidedCamera, ModelView
from groundstation.gui.reconstruct.reconstruct_controller import TRAINING, Phase, ReconstructController
from groundstation.gui.reconstruct.view_pictures import View, ViewPictures, layer_names, leave_card, tell_device
from groundstation.gui.widgets.inputs import ChoiceBox, calm
from groundstation.gui.widgets.photo_strip import PhotoStrip, Thumbnails
from groundstation.gui.widgets.scrolling import WrappingRow, labelled
from groundstation.gui.widgets.theme import Colours, colours
from groundstation.services.reconstruct.folders import ModelCard
from groundstation.services.reconstruct.guided_camera import sized
from groundstation.services.reconstruct.messages import Subject, ViewAnswer
from groundstation.services.units import UnitSystem, length_unit
from reconstruction.base.cameras import PosedPhoto
from reconstruction.training.layers import PICTURE
from reconstruction.training.method_registry import training_methods

# All photos of a data set beside each other, with how well the model shows each: a bar and decibels.

CELL = QSize(112, 104)
FOOT_PX, BAR_PX = 18, 7

UNSEEN = "\u25c7"
"""A photo that is not learned from."""

LEAST_SPREAD_DB = 3.0
"""Between the worst and the best photo, for the colours of bars: less is no difference to speak of."""


class ErrorStrip(PhotoStrip[PosedPhoto]):
    """Shows photos beside each other, in the order of their names or the worst first.

    Signals
    -------
    chosen(str)
        Name of a photo that the user chose.
    """

    chosen = Signal(str)

    def __init__(self, pictures: Thumbnails, parent: QWidget | None = None) -> None:
        super().__init__(CELL, BAR_PX + FOOT_PX, lambda photo: photo.path, parent)
        self._pictures = pictures
        self._all: tuple[PosedPhoto, ...] = ()
        self._unseen: frozenset[str] = frozenset()
        self._psnr_db: dict[str, float] = {}
        self._range_db = (0.0, 1.0)
        self._worst_first, self._is_filling = False, False
        self.setAccessibleName(self.tr("Photos of the data set, and how well the model shows them"))
        self.selectionModel().currentChanged.connect(self._current_changed)
        pictures.ready.connect(self.repaint_path)

    def set_photos(self, photos: tuple[PosedPhoto, ...], unseen: frozenset[str]) -> None:
        """Show other photos; `unseen` are not learned from."""
        self._all, self._unseen = photos, unseen
        self._psnr_db = {}
        self._arrange()

    def set_errors(self, psnr_db: dict[str, float]) -> None:
        """Show other errors; the order stays until `set_worst_first`, or until more photos are known."""
        knows_more = bool(set(psnr_db) - set(self._psnr_db))
        self._psnr_db = dict(psnr_db)
        if psnr_db:
            low, high = min(psnr_db.values()), max(psnr_db.values())
            self._range_db = low - 0.1 * LEAST_SPREAD_DB, max(high, low + LEAST_SPREAD_DB)
        if self._worst_first and knows_more:
            self._arrange()
        self.viewport().update()

    def errors(self) -> dict[str, float]:
        """Those that are shown, PSNR in dB."""
        return self._psnr_db

    def set_worst_first(self, is_on: bool) -> None:
        """Sort by what is known now, or by names."""
        self._worst_first = is_on
        self._arrange()
        if is_on:
            self.horizontalScrollBar().setValue(0)

    def choose(self, name: str) -> None:
        """Mark a photo, and bring it into sight."""
        row = self._row_of(name)
        if row is not None:
            self.choose_row(row)

    def current(self) -> str:
        """Name of the photo that is marked; "" for none."""
        row = self.currentIndex().row()
        return self.photos()[row].name if 0 <= row < len(self.photos()) else ""

    def names(self) -> tuple[str, ...]:
        """As they are shown."""
        return tuple(photo.name for photo in self.photos())

    def picture(self, photo: PosedPhoto) -> QImage | None:
        """Its picture; None where it is still being read."""
        lens = photo.intrinsics
        return self._pictures.picture(photo.path, max(lens.width_px, lens.height_px))

    def paint_foot(self, painter: QPainter, foot: QRect, _row: int, photo: PosedPhoto) -> None:
        """Bar, sign, name and decibels."""
        look, found = colours(), self._psnr_db.get(photo.name)
        if found is not None:
            low, high = self._range_db
            share = min(1.0, max(0.0, (found - low) / (high - low)))
            bar = QRect(foot.left() + 2, foot.top(), foot.width() - 4, BAR_PX - 1)
            painter.fillRect(bar, QColor(look.handle))
            bar.setWidth(max(3, round(share * bar.width())))
            painter.fillRect(bar, _colour(share, look))
        line = foot.adjusted(3, BAR_PX - 1, -3, -1)
        sign = f"{UNSEEN} " if photo.name in self._unseen else ""
        left, right = Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight
        middle = Qt.AlignmentFlag.AlignVCenter
        metrics = painter.fontMetrics()
        room_px = line.width() - (36 if found is not None else 0) - metrics.horizontalAdvance(sign)
        name = metrics.elidedText(Path(photo.name).stem, Qt.TextElideMode.ElideLeft, room_px)
        painter.drawText(line, left | middle, sign + name)
        if found is not None:
            painter.drawText(line, right | middle, f"{found:.1f}")

    def words(self, photo: PosedPhoto) -> str:
        """What is known of a photo."""
        found = self._psnr_db.get(photo.name)
        lines = [photo.name]
        if found is not None:
            lines.append(self.tr("{0:.2f} dB on the facades, as the model is now").format(found))
        if photo.name in self._unseen:
            lines.append(self.tr("{0} not learned from: kept for scoring").format(UNSEEN))
        return "\n".join(lines)

    def _row_of(self, name: str) -> int | None:
        return next((row for row, photo in enumerate(self.photos()) if photo.name == name), None)

    def _arrange(self) -> None:
        chosen, errors = self.current(), self._psnr_db
        place = self.horizontalScrollBar().value()
        order = sorted(self._all, key=lambda photo: photo.name)
        if self._worst_first:
            order = sorted(order, key=lambda photo: errors.get(photo.name, float("inf")))
        self._is_filling = True
        self.show_photos(tuple(order))
        row = self._row_of(chosen)
        if row is not None:
            self.setCurrentIndex(self.model().index(row, 0))
        self.horizontalScrollBar().setValue(place)
        self._is_filling = False

    def _current_changed(self, now: QModelIndex, _before: QModelIndex) -> None:
        if now.isValid() and not self._is_filling:
            self.chosen.emit(self.photos()[now.row()].name)


def _colour(share: float, look: Colours) -> QColor:
    """From the worst to the best, by way of orange."""
    worst, middle, best = QColor(look.error), QColor(look.open), QColor(look.ok)
    one, other, part = (worst, middle, 2.0 * share) if share < 0.5 else (middle, best, 2.0 * share - 1.0)
    pairs = ((one.redF(), other.redF()), (one.greenF(), other.greenF()), (one.blueF(), other.blueF()))
    return QColor.fromRgbF(*(a + part * (b - a) for a, b in pairs))


# Above the picture: the layer that is shown, what it is compared with, and the way back to the photo.

NOTHING, PHOTO = "", "photo"
"""What is compared with, besides folders of models."""


class ViewBar(QWidget):
    """Edits layer, model and comparison.

    Signals
    -------
    valueChanged()
        Another layer, model or comparison was chosen.
    homeRequested()
    """

    valueChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    homeRequested = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model, self.layer, self.compare = ChoiceBox(), ChoiceBox(), ChoiceBox()
        self.home = QPushButton(self.tr("To the photo"))
        for name, text in layer_names().items():
            self.layer.addItem(text, name)
        self.home.setToolTip(self.tr("Show the view from where the photo was taken (0)"))
        self.layer.setToolTip(self.tr("What the picture is made of"))
        layout = WrappingRow(self)
        layout.setContentsMargins(6, 0, 6, 0)
        for title, box, least in (
            (self.tr("Model"), self.model, 8),
            (self.tr("Layer"), self.layer, 7),
            (self.tr("Beside it"), self.compare, 8),
        ):
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(least)
            layout.addWidget(labelled(title, box))
        layout.addWidget(self.home)
        self.set_models((), "")
        for box in (self.model, self.layer, self.compare):
            box.currentIndexChanged.connect(self._changed)
        self.home.clicked.connect(self._home)

    def value(self) -> tuple[str, str, str]:
        """Model ("" for the one in training, else a folder), layer, and what is beside it (see `NOTHING`, `PHOTO`)."""
        return (
            str(self.model.currentData() or ""),
            str(self.layer.currentData() or PICTURE),
            str(self.compare.currentData() or NOTHING),
        )

    def setValue(self, model: str, layer: str, compare: str) -> None:  # noqa: N802
        """Choose others, where they are there."""
        for box, name in ((self.model, model), (self.layer, layer), (self.compare, compare)):
            with QSignalBlocker(box):
                box.setCurrentIndex(max(0, box.findData(name)))
        self._changed()

    def title(self, model: str) -> str:
        """What a model is called."""
        return self.model.itemText(self.model.findData(model))

    def set_models(self, models: tuple[ModelCard, ...], own: str) -> None:
        """Offer finished models, and one without a folder that is called `own`; "" where there is none."""
        before = self.value()
        with QSignalBlocker(self.model), QSignalBlocker(self.compare):
            self.model.clear()
            self.compare.clear()
            if own or not models:
                self.model.addItem(own or self.tr("none yet"), "")
            self.compare.addItem(self.tr("nothing"), NOTHING)
            self.compare.addItem(self.tr("the photo"), PHOTO)
            for card in models:
                for box in (self.model, self.compare):
                    box.addItem(_title(card), str(card.folder))
            for box, name in ((self.model, before[0]), (self.compare, before[2])):
                box.setCurrentIndex(max(0, box.findData(name)))
        if self.value() != before:
            self._changed()

    def _changed(self) -> None:
        self.valueChanged.emit()

    def _home(self) -> None:
        self.homeRequested.emit()


def _title(card: ModelCard) -> str:
    """Of a finished model: its folder, and its method."""
    known = training_methods()
    method = known[card.method].title if card.method in known else card.method
    return f"{Path(card.folder).name} ({method})"


ERRORS_MS = 200
"""Between two changes of the strip: photos of a finished model are judged faster than anybody reads."""


class ViewPane(QWidget):
    """Looks at models of the controller's data set."""

    def __init__(
        self, context: ApplicationContext, controller: ReconstructController, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._context, self._controller = context, controller
        self.pictures = Thumbnails(self)
        self.bar, self.view, self.strip = ViewBar(), ModelView(), ErrorStrip(self.pictures)
        self.line, self.worst = QSlider(Qt.Orientation.Horizontal), QPushButton(self.tr("Worst first"))
        calm(self.line)
        self.pictures_in_view = ViewPictures(
            controller.request_view, self._size_px, self, lambda: context.models_drawn_by
        )
        self._photo: PosedPhoto | None = None
        self.guided = GuidedCamera(self.view, self)
        self._images: dict[str, QImage | None] = {"left": None, "right": None}
        self._scale: tuple[float, float] | None = None
        self._problem = ""
        self._answer: ViewAnswer | None = None
        self._units = UnitSystem.METRIC
        self._is_at_home, self._has_model, self._n_first_looks = True, False, 0
        self._judged = QTimer(self)
        self._judged.setSingleShot(True)
        self._judged.setInterval(ERRORS_MS)
        self._make()
        self._connect()
        self.set_data_set()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._say()

    def camera(self) -> PosedPhoto | None:
        """Where the view is from."""
        return self.guided.camera

    def close_pictures(self) -> None:
        """The window goes."""
        self.pictures.close()

    def set_data_set(self) -> None:
        """Show the controller's data set."""
        card = self._controller.card
        photos = () if card is None else card.source.photos
        self.strip.set_photos(photos, self._controller.unseen())
        self._photo = self.guided.camera = None
        self.offer_models()
        self._show_errors()
        if photos:
            self.strip.choose(photos[0].name)
        else:
            self.show_view()

    def offer_models(self) -> None:
        """The models that there are now."""
        controller = self._controller
        own = self.tr("in training") if controller.is_busy else self.tr("trained last") if controller.has_model else ""
        self._has_model = controller.has_model
        self.bar.set_models(controller.others, own)
        self.show_view()

    def show_training(self) -> None:
        """Turn to the model in training."""
        self.offer_models()
        self.bar.setValue("", *self.bar.value()[1:])

    def show_view(self) -> None:
        """Show what is chosen, from where the camera is."""
        if self.guided.camera is None:
            self._images = {"left": None, "right": None}
            self.pictures_in_view.show(None)
            self._say()
            return
        _, layer, _ = self.bar.value()
        left, right = self._subjects()
        for place, subject in (("left", left), ("right", right)):
            if subject is None:
                self._images[place] = None
        name = "" if self._photo is None else self._photo.name
        self.pictures_in_view.show(View(self.guided.camera, left, right, layer, name))
        self.line.setVisible(left is not None and right is not None)
        self._say()

    def follow_training(self) -> None:
        """The training has gone on."""
        n_first_looks = self._controller.training.n_first_looks
        if self._has_model != self._controller.has_model:
            self.show_training()
        elif self._n_first_looks != n_first_looks:
            self.pictures_in_view.look_anew()
        self._n_first_looks = n_first_looks
        is_learning = self._controller.phase in (Phase.TRAINING, Phase.COOLING_DOWN)
        self.pictures_in_view.set_learning(is_learning and not self._controller.is_paused)

    # How it is put together

    def _make(self) -> None:
        self.line.setRange(0, 1000)
        self.line.setValue(500)
        self.line.setAccessibleName(self.tr("Line between the two pictures"))
        self.worst.setCheckable(True)
        self.worst.setToolTip(self.tr("Sort the photos by how well the model shows them now"))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.bar)
        layout.addWidget(self.view, 1)
        below = QHBoxLayout()
        below.addStretch(1)
        below.addWidget(self.line, 8)
        below.addStretch(1)
        below.addWidget(self.worst)
        layout.addLayout(below)
        layout.addWidget(self.strip)

    def _connect(self) -> None:
        view, controller = self.view, self._controller
        self.bar.valueChanged.connect(self._bar_changed)
        self.bar.homeRequested.connect(self._go_home)
        self.worst.toggled.connect(self.strip.set_worst_first)
        self.strip.chosen.connect(self._choose_photo)
        self.guided.cameraMoved.connect(self._camera_moved)
        view.homeRequested.connect(self._go_home)
        view.resized.connect(self.show_view)
        self._context.drawnByChanged.connect(self.show_view)
        view.valueChanged.connect(self._line_moved)
        self.line.valueChanged.connect(self._slider_moved)
        self.pictures_in_view.pictureCame.connect(self._show_picture)
        controller.viewAnswered.connect(self._take)
        controller.errorsChanged.connect(self._errors_changed)
        self._judged.timeout.connect(self._show_errors)

    # What the user does

    def _choose_photo(self, name: str) -> None:
        card = self._controller.card
        photo = None if card is None else next((one for one in card.source.photos if one.name == name), None)
        if photo is not None and photo is not self._photo:
            self._photo = photo
            self._go_home()

    def _go_home(self) -> None:
        if self._photo is not None:
            lens = self._photo.intrinsics
            self.guided.camera, self._is_at_home = sized(self._photo, lens.width_px, lens.height_px), True
            self.show_view()

    def _camera_moved(self) -> None:
        self._is_at_home = False
        self.show_view()

    def _bar_changed(self) -> None:
        subject = self._model()
        if subject is not None and subject != self._controller.errors_of:
            self._controller.watch_errors(subject)
        self.show_view()

    def _line_moved(self, value: float) -> None:
        if self.line.value() != round(1000.0 * value):
            self.line.setValue(round(1000.0 * value))

    def _slider_moved(self, value: int) -> None:
        if round(1000.0 * self.view.value()) != value:
            self.view.setValue(value / 1000.0)

    # What is shown

    def _model(self) -> Subject | None:
        """The model that is looked at."""
        folder = self.bar.value()[0]
        if folder:
            return Subject("model", Path(folder))
        return TRAINING if self._controller.has_model else None

    def _subjects(self) -> tuple[Subject | None, Subject | None]:
        left, compare, card = self._model(), self.bar.value()[2], self._controller.card
        photo = None
        if card is not None and self._photo is not None and self._is_at_home:
            photo = Subject("photo", card.folder, self._photo.name)
        if left is None:
            return None, photo
        if compare == PHOTO:
            return left, photo
        return left, None if compare == NOTHING else Subject("model", Path(compare))

    def _take(self, answer: ViewAnswer | None) -> None:
        if answer is None:
            self.pictures_in_view.forget()
            leave_card(self._context, self._answer)
        else:
            self.pictures_in_view.take(answer)

    def _show_picture(self, place: str, image: QImage | None, answer: ViewAnswer) -> None:
        left, right = self._subjects()
        if answer.look.subject != (left if place == "left" else right):
            return
        self._images[place], self._answer = image, answer
        tell_device(self._context, self.view, answer)
        if place == "left":
            self._scale, self._problem = answer.scale, answer.problem
            if answer.depth_m is not None:
                self.guided.distance_m = answer.depth_m
        elif answer.problem:
            self._problem = answer.problem
        self._say()

    def _say(self) -> None:
        left, right = self._subjects() if self.guided.camera is not None else (None, None)
        self.view.set_pictures(self._images["left"], self._images["right"])
        self.view.set_words(self._words(left), self._words(right))
        self.view.set_note(self._note(left))

    def _words(self, subject: Subject | None) -> str:
        if subject is None:
            return ""
        if subject.kind == "photo":
            return self.tr("photo")
        words = self.bar.title("" if subject.kind == "training" else str(subject.folder))
        stepped = self._controller.training.stepped
        if subject.kind == "training" and stepped is not None:
            words = self.tr("step {0}").format(stepped.step)
        elif subject.kind == "training" and self._controller.is_busy:
            words = self.tr("before the first step")
        if self._scale is None or self.bar.value()[1] == PICTURE:
            return words
        low, high = self._scale
        if self.bar.value()[1] == "depth":
            unit = length_unit(self._units)
            return self.tr("{0}: violet {1}, yellow {2}").format(words, unit.text(low), unit.text(high))
        return self.tr("{0}: violet {1}, yellow {2}").format(words, f"{low:g}", f"{high:g}")

    def _note(self, left: Subject | None) -> str:
        if self._controller.card is None:
            return self.tr(
                "Choose a data set, or a folder of photos with their COLMAP or nerfstudio model; or make one of the "
                "flight's photos on the Photos tab."
            )
        if left is None:
            return self.tr("A photo of the data set. The model is shown here once it learns.")
        if self._problem:
            return str(self._context.localized(self._problem))
        if self.bar.value()[2] == PHOTO and not self._is_at_home:
            return self.tr("The photo is seen from its own place only; 0 goes back there.")
        return ""

    def _errors_changed(self) -> None:
        if not self._judged.isActive():
            self._judged.start()

    def _show_errors(self) -> None:
        self.strip.set_errors(self._controller.errors)

    def _size_px(self) -> tuple[int, int]:
        return max(16, self.view.width()), max(12, self.view.height())
