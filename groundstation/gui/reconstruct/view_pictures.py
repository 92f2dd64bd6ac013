"""The pictures of a view, asked of the process of models, and what its layers are called.

One look is on its way for each place; what is requested meanwhile waits until it has come back, so that the newest
request wins and nothing piles up. While a model learns, it is looked at again now and then.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QCoreApplication, QObject, QTimer, Signal
from PySide6.QtGui import QImage

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.reconstruct.model_view import ModelView
from groundstation.gui.widgets.parameter_form import choice_text
from groundstation.gui.widgets.picture_decoder import qimage_of
from groundstation.services.reconstruct.guided_camera import PicturePace, sized
from groundstation.services.reconstruct.messages import Section, Subject, Tints, ViewAnswer, ViewRequest
from groundstation.services.settings import DrawnBy
from planning.base.findings import Severity
from planning.base.messages import say
from planning.base.parameters import declared
from reconstruction.base.cameras import PosedPhoto
from reconstruction.training.layers import LAYERS, PICTURE
from reconstruction.training.parameters import TrainRequest

# What the tab calls layers, terms of the loss, stages and lights.


def layer_names() -> dict[str, str]:
    """Layers by name, in the order in which they are offered; those that are not known here by their own names."""
    translate = QCoreApplication.translate
    known = {
        PICTURE: translate("LayerNames", "Picture"),
        "diffuse": translate("LayerNames", "Diffuse"),
        "reflectivity": translate("LayerNames", "Reflectivity"),
        "fresnel": translate("LayerNames", "Fresnel"),
        "reflection": translate("LayerNames", "Reflection"),
        "mirrored": translate("LayerNames", "Mirrored light"),
        "normals": translate("LayerNames", "Normals"),
        "panels": translate("LayerNames", "Panels"),
        "depth": translate("LayerNames", "Depth"),
        "alpha": translate("LayerNames", "Coverage by splats"),
    }
    return {name: text for name, text in known.items() if name in (PICTURE, *LAYERS)} | {
        name: name for name in LAYERS if name not in known
    }


def term_name(term: str) -> str:
    """A term of the loss."""
    names = {
        "colour": QCoreApplication.translate("LossTerms", "colour"),
        "normal consistency": QCoreApplication.translate("LossTerms", "normals and depth"),
        "normal prior": QCoreApplication.translate("LossTerms", "known normals"),
        "high frequency": QCoreApplication.translate("LossTerms", "worst pixels"),
    }
    return names.get(term, term)


def light_name(light: str) -> str:
    """A model of mirrored light."""
    return choice_text(declared(TrainRequest)["light"].parameter, light)


QUICK_S = 0.12
"""What a picture may take while the camera is led about, where so few pixels help (`PicturePace`)."""

LEAST_PX, QUICK_PX = 96 * 72, 160 * 120
"""Pixels of the smallest coarse picture, and of the first one, before anybody knows how long one takes."""

MOST_PX = 1280 * 960
"""Of a fine picture."""

REST_MS = 250
"""After which the camera has come to rest."""

NUMBERS = itertools.count(1)
"""Of looks, all of them: the process is asked by one window after another."""

AGAIN_S, AGAIN_TIMES = 2.0, 25.0
"""Least time between two looks at a model that learns, and how many times as long as the look took: 4 % of it."""


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What is to be seen.

    Parameters
    ----------
    camera
        Of any size.
    left, right
        Subjects; None for nothing.
    layer
        `picture`, or one of `LAYERS`.
    exposed_as
        Name of a photo; "" for none.
    tints, section
        See `ViewRequest`.
    right_tints
        Of the panels of what is on the right, whose numbers are its own.
    """

    camera: PosedPhoto
    left: Subject | None
    right: Subject | None
    layer: str
    exposed_as: str = ""
    tints: Tints = ()
    section: Section | None = None
    right_tints: Tints = ()


class ViewPictures(QObject):
    """Keeps the pictures in step with the view.

    Parameters
    ----------
    send
        Takes looks.
    size_px
        Width and height of the widget.
    drawn_by
        What the user wants pictures to be drawn by.

    Signals
    -------
    pictureCame(str, QImage or None, Seen)
        For `left` or `right`.
    """

    pictureCame = Signal(str, object, object)  # noqa: N815  (Qt's own way of naming)

    def __init__(
        self,
        send: Callable[[ViewRequest], None],
        size_px: Callable[[], tuple[int, int]],
        parent: QObject | None = None,
        drawn_by: Callable[[], DrawnBy] = lambda: DrawnBy.AUTO,
    ) -> None:
        super().__init__(parent)
        self._send, self._size_px, self._drawn_by = send, size_px, drawn_by
        self._view: View | None = None
        self._on_way: dict[str, int] = {}
        self._version, self._shown = 0, {"left": (-1, False), "right": (-1, False)}
        self._paces: dict[str, tuple[Subject, PicturePace]] = {}
        self._is_learning = False
        self._rest, self._again = QTimer(self), QTimer(self)
        for timer, slot in ((self._rest, self._go_on), (self._again, self._look_again)):
            timer.setSingleShot(True)
            timer.timeout.connect(slot)

    def show(self, view: View | None) -> None:
        """Show another view."""
        self._view = view
        self._version += 1
        self._rest.start(REST_MS)
        self._go_on()

    def set_learning(self, is_learning: bool) -> None:
        """Whether the model in training changes by itself; when it does no more, it is looked at once more."""
        was_learning, self._is_learning = self._is_learning, is_learning
        if is_learning and not self._again.isActive():
            self._again.start(int(1000.0 * AGAIN_S))
        elif was_learning and not is_learning:
            self._again.stop()
            self.look_anew()

    def forget(self) -> None:
        """What is on its way will not come: the process has ended."""
        self._on_way.clear()

    def is_at_rest(self) -> bool:
        """Whether nothing is on its way, and everything is as fine as it will be."""
        return not self._on_way and not self._rest.isActive() and not self._missing()

    def take(self, answer: ViewAnswer) -> None:
        """An answer has come."""
        place, number = answer.look.place, answer.look.number
        waited_for = self._on_way.get(place)
        if waited_for is None or number < waited_for:
            return
        del self._on_way[place]
        if number > waited_for:
            # Another window's, before it went: it has taken the place of ours.
            self._shown[place] = (-1, False)
            self._go_on()
            return
        lens = answer.look.camera.intrinsics
        if answer.picture is not None and answer.look.subject.kind != "photo":
            self._pace(place, answer.look.subject).took(lens.width_px * lens.height_px, answer.seconds)
        self.pictureCame.emit(place, None if answer.picture is None else image_of(answer.picture), answer)
        self._go_on()

    def _look_again(self) -> None:
        if not self._is_learning:
            return
        self.look_anew()
        pixels = self._fine_px()
        took_s = max([0.0, *(pace.seconds_of(pixels) for _, pace in self._paces.values())])
        self._again.start(int(1000.0 * max(AGAIN_S, AGAIN_TIMES * took_s)))

    def look_anew(self) -> None:
        """Look at the model in training once more."""
        if self._view is None:
            return
        for place, subject in (("left", self._view.left), ("right", self._view.right)):
            if subject is not None and subject.kind == "training":
                self._shown[place] = (-1, False)
        self._go_on()

    def _missing(self) -> tuple[str, ...]:
        """Places whose picture is of an older view, or coarse."""
        view = self._view
        if view is None:
            return ()
        wanted = [place for place, subject in (("left", view.left), ("right", view.right)) if subject is not None]
        return tuple(place for place in wanted if self._shown[place] != (self._version, True))

    def _go_on(self) -> None:
        view = self._view
        if view is None:
            return
        for place in self._missing():
            if place in self._on_way:
                continue
            is_new = self._shown[place][0] != self._version
            if not is_new and self._rest.isActive():
                continue  # a coarse picture does until the camera has come to rest
            self._ask(view, place, is_fine=not self._rest.isActive())

    def _ask(self, view: View, place: str, is_fine: bool) -> None:
        subject = view.left if place == "left" else view.right
        assert subject is not None
        pixels, fine = self._quick_px(place, subject), self._fine_px()
        is_fine = is_fine or pixels >= fine or subject.kind == "photo"
        width, height = self._size_px()
        scale = math.sqrt((fine if is_fine else pixels) / max(1.0, fine)) * self._fine_scale()
        camera = sized(view.camera, max(16, round(scale * width)), max(12, round(scale * height)))
        number = next(NUMBERS)
        self._on_way[place] = number
        self._shown[place] = (self._version, is_fine)
        layer = "picture" if subject.kind == "photo" else view.layer
        tints = view.tints if place == "left" else view.right_tints
        wanted = (place, number, subject, camera, layer, view.exposed_as, tints, view.section, not is_fine)
        self._send(ViewRequest(*wanted, self._drawn_by().value))

    def _fine_px(self) -> float:
        width, height = self._size_px()
        return float(min(width * height, MOST_PX))

    def _fine_scale(self) -> float:
        width, height = self._size_px()
        return min(1.0, math.sqrt(MOST_PX / max(1.0, width * height)))

    def _quick_px(self, place: str, subject: Subject) -> float:
        found = self._pace(place, subject).pixels_within(QUICK_S)
        return QUICK_PX if found is None else max(LEAST_PX, found)

    def _pace(self, place: str, subject: Subject) -> PicturePace:
        """Of what is shown at a place; another subject's says nothing of it."""
        known = self._paces.get(place)
        if known is None or known[0] != subject:
            self._paces[place] = known = subject, PicturePace()
        return known[1]


def tell_device(context: ApplicationContext, view: ModelView, answer: ViewAnswer) -> None:
    """Say on the view what drew a picture, and among the messages where the graphics card failed."""
    if answer.by_card is not None:
        translate = QCoreApplication.translate
        by = translate("ViewPictures", "Graphics card") if answer.by_card else translate("ViewPictures", "Processor")
        why = answer.drawn_by or say("a graphics card is tried once the camera rests")
        view.set_device(by, str(context.localized(why)))
    if answer.lost:
        context.say(Severity.WARNING, context.localized(answer.lost), about="models.drawn_by")


def leave_card(context: ApplicationContext, answer: ViewAnswer | None) -> None:
    """Let the processor draw after the process of models ended while a card drew or was tried: its driver may be why.

    Parameters
    ----------
    answer
        The last one; None for none.
    """
    is_by_card = answer is not None and answer.by_card is not None and (answer.by_card or not answer.drawn_by)
    if is_by_card and context.models_drawn_by is not DrawnBy.PROCESSOR:
        context.set_models_drawn_by(DrawnBy.PROCESSOR)
        context.say(
            Severity.NOTE,
            QCoreApplication.translate(
                "ViewPictures", "The processor draws models for now; View, Models drawn by tries a graphics card again."
            ),
            about="models.drawn_by",
        )


def image_of(picture: np.typing.NDArray[np.uint8]) -> QImage:
    """A picture, shape (h, w, 3), red, green, blue, as Qt has it."""
    return qimage_of(picture, QImage.Format.Format_RGB888)
