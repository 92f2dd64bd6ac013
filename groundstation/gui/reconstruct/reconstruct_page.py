"""The Reconstruct tab's widgets put together: signals go to the controller, what it knows comes back here."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, QSignalBlocker, QTimer, Signal
from PySide6.QtGui import QAction, QCloseEvent
from PySide6.QtWidgets import QComboBox, QLabel, QProgressBar, QPushButton, QTabWidget, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import GradualTab
from groundstation.gui.charts.axes import Line, LinesPlot
from groundstation.gui.reconstruct.choice_side import ChoiceSide, MachineTexts
from groundstation.gui.reconstruct.reconstruct_controller import Phase, ReconstructController
from groundstation.gui.reconstruct.view_pane import ViewPane
from groundstation.gui.reconstruct.view_pictures import light_name, term_name
from groundstation.gui.shared_view import SharedView
from groundstation.gui.widgets.effects_panel import EffectsPanel
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.parameter_form import title_of
from groundstation.gui.widgets.questions import Questions, agrees
from groundstation.gui.widgets.scrolling import padded, scrolled, split
from groundstation.services.plan.effects import EffectChoice
from groundstation.services.project.steps import Act
from groundstation.services.reconstruct.choices import MethodRow, TrainChoice, method_rows
from groundstation.services.reconstruct.curves import ThinCurve, smoothed
from groundstation.services.units import UnitSystem, minutes_text
from planning.base.effects import Decision
from planning.base.parameters import declared
from reconstruction.training.parameters import LIGHTS, TrainRequest

# Which model of mirrored light the scene calls for and why; and what the user chooses instead.


class LightPage(QWidget):
    """Edits the name of a model of light, and shows decisions about it.

    Signals
    -------
    valueChanged(str)
        By the user.
    asked()
        The scene shall be asked.
    """

    valueChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)
    asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.light, self.ask, self.words = ChoiceBox(), QPushButton(self.tr("Ask the scene")), QLabel()
        self.effects = EffectsPanel()
        self.ask.setToolTip(
            self.tr("Try the cheap models on the photos for some seconds, and say which one is worth it")
        )
        self.words.setWordWrap(True)
        heading = QLabel(title_of(declared(TrainRequest)["light"].parameter))
        heading.setProperty("role", "heading")
        for light in LIGHTS:
            self.light.addItem(light_name(light.value), light.value)
        self.light.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.light.setMinimumContentsLength(10)
        self.light.currentIndexChanged.connect(self._changed)
        self.ask.clicked.connect(self._ask)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        for widget in (heading, self.light, self.ask, self.words, self.effects):
            layout.addWidget(widget)
        layout.addStretch(1)
        self.show_decisions("", ())

    def value(self) -> str:
        """What is chosen."""
        return str(self.light.currentData())

    def setValue(self, light: str) -> None:  # noqa: N802
        """Show another request."""
        with QSignalBlocker(self.light):
            self.light.setCurrentIndex(self.light.findData(light))

    def set_possible(self, method: MethodRow, *, can_ask: bool, can_choose: bool) -> None:
        """Enable what can be done now, with a method."""
        self.ask.setEnabled(can_ask and method.knows_panels)
        self.light.setEnabled(can_choose and method.knows_panels)
        usual = light_name("auto")
        if method.light != "auto":
            usual = self.tr("as the method has it: {0}").format(light_name(method.light))
        self.light.setItemText(self.light.findData("auto"), usual)

    def show_decisions(self, light: str, decisions: tuple[Decision, ...]) -> None:
        """Show what was decided; "" where nothing is known yet."""
        if not light:
            words = self.tr(
                "Nothing is known of this scene yet. It is asked when a training begins, or now, which takes seconds."
            )
        elif decisions:
            words = self.tr("The scene calls for: {0}.").format(light_name(light))
        else:
            words = self.tr("It is learned as: {0}.").format(light_name(light))
        self.words.setText(words)
        self.effects.set_effects(tuple(EffectChoice(decision, None) for decision in decisions))
        self.effects.setVisible(bool(decisions))

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self.effects.set_units(units)

    def text(self) -> str:
        """What is said of the light."""
        return self.words.text()

    def _changed(self) -> None:
        self.valueChanged.emit(self.value())

    def _ask(self) -> None:
        self.asked.emit()


REDRAW_MS = 250
"""Steps come a hundred times as often as the eye can follow."""

SMOOTH = 20
"""Values of a loss that are averaged: each is of another photo."""


MINUTES_FROM_S = 900.0
"""Longer trainings are drawn over minutes."""


class ProgressPage(QWidget):
    """Two charts, and what stands above them."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.state, self.bar, self.numbers = QLabel(), QProgressBar(), QLabel()
        empty = self.tr("Appears here while a model learns.")
        self.quality = LinesPlot(self.tr("time in s"), self.tr("PSNR in dB"), empty)
        self.losses = LinesPlot(self.tr("time in s"), self.tr("loss"), empty)
        for label in (self.state, self.numbers):
            label.setWordWrap(True)
        self.state.setProperty("role", "heading")
        self.numbers.setProperty("role", "muted")
        self.bar.setRange(0, 1000)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        for widget in (self.state, self.bar, self.numbers):
            layout.addWidget(widget)
        self._of_what = QLabel()
        for title, plot in ((self._of_what, self.quality), (QLabel(self.tr("Terms of the loss")), self.losses)):
            title.setProperty("role", "heading")
            title.setWordWrap(True)
            layout.addWidget(title)
            layout.addWidget(plot, 1)
        self._curves: tuple[ThinCurve, dict[str, ThinCurve]] = (ThinCurve(), {})
        self._redraw = QTimer(self)
        self._redraw.setSingleShot(True)
        self._redraw.setInterval(REDRAW_MS)
        self._redraw.timeout.connect(self._draw)
        self.set_state("", None)
        self.set_has_facades(True)

    def set_has_facades(self, has_facades: bool) -> None:
        """Say what quality is measured on: facades, or all of the views where there are none."""
        some, facades = self.tr("Some unseen views"), self.tr("Facades of some unseen views")
        self._of_what.setText(facades if has_facades else some)

    def set_state(self, words: str, share: float | None, numbers: str = "") -> None:
        """Say where it stands; `share` done, 0 to 1, negative where that is not known, None where nothing runs."""
        self.state.setText(words or self.tr("Nothing is being trained."))
        self.bar.setVisible(share is not None)
        if share is not None:
            self.bar.setRange(0, 0 if share < 0.0 else 1000)
            self.bar.setValue(int(1000 * min(1.0, max(0.0, share))))
        self.numbers.setText(numbers)
        self.numbers.setVisible(bool(numbers))

    def set_curves(self, quality: ThinCurve, terms: dict[str, ThinCurve]) -> None:
        """Draw curves, soon."""
        self._curves = quality, terms
        if not self._redraw.isActive():
            self._redraw.start()

    def text(self) -> str:
        """What stands above the charts."""
        return f"{self.state.text()}\n{self.numbers.text()}".strip()

    def _draw(self) -> None:
        quality, terms = self._curves
        last_s = max([0.0, *(curve.x[-1] for curve in (quality, *terms.values()) if curve.x)])
        in_minutes = last_s > MINUTES_FROM_S
        for plot in (self.quality, self.losses):
            plot.set_title_x(self.tr("time in min") if in_minutes else self.tr("time in s"))
        scale = 1.0 / 60.0 if in_minutes else 1.0
        seconds, psnr_db = quality.arrays()
        self.quality.set_lines((Line(self.tr("unseen views"), scale * seconds, psnr_db),) if quality.x else ())
        lines = []
        for name, curve in terms.items():
            x, y = curve.arrays()
            lines.append(Line(term_name(name), scale * x, smoothed(y, SMOOTH)))
        self.losses.set_lines(tuple(lines), from_zero=True)


# Questions of the Reconstruct tab; a class of its own so that whoever drives the window without a user can answer.


class ReconstructQuestions(QObject):
    """Asks by dialogs."""

    def cancel_training(self, parent: QWidget) -> bool:
        """Whether to break a training off because the window closes."""
        return agrees(
            parent,
            self.tr("A model is being trained"),
            self.tr(
                "Closing the window breaks the training off. What it has reached is kept, and the Reconstruct tab "
                "goes on with it later. Close the window?"
            ),
        )


SIDE_PX, DETAIL_PX, LEAST_DETAIL_PX = 270, 340, 260
"""Widths beside the view, at 1280 pixels."""


class ReconstructPage(GradualTab):
    """The tab."""

    def __init__(self, context: ApplicationContext, shared_view: SharedView, *, at_once: bool = True) -> None:
        self._context, self._shared_view = context, shared_view
        super().__init__(shared_view, at_once=at_once)

    def _parts(self) -> Iterator[None]:
        context = self._context
        self.controller, self.questions, self.asks = (
            ReconstructController.of(context),
            Questions(),
            ReconstructQuestions(),
        )
        self._words = MachineTexts(self)
        yield
        self.side = ChoiceSide(self.controller, self._words)
        yield
        self.pane = ViewPane(context, self.controller)
        yield
        self.progress, self.light = ProgressPage(), LightPage()
        self.machine = QWidget()
        self._machine_lines: list[QLabel] = []
        yield
        self.left = yield from self._made_page()
        self.right: QWidget | None = None
        self.bottom: QWidget | None = None
        self._was_busy = False
        self._offered: Path | None = None
        yield
        self._connect()
        self.side.form.setValue(self.controller.choice)
        self.light.setValue(self.controller.choice.light)
        self._units_changed(context.units)
        self._show_light()
        self._show_state()
        yield

    # A tab

    def shown(self) -> None:
        """Take the data set that was made last, else the project's, and see what has changed on the disk."""
        self.controller.warm_up()
        controller, made = self.controller, self._context.milestones.data_set
        if made is not None and made != self._offered and not controller.is_busy:
            self._offered = made
            controller.read(made)
        elif controller.card is None and (folder := controller.usual_data_set()) is not None:
            controller.read(folder)
        self.controller.check_folders()

    def hidden(self) -> None:
        """A training goes on."""

    def actions(self) -> tuple[QAction, ...]:
        """There are none."""
        return ()

    def take_step(self, act: Act) -> None:
        """Train, or stop and keep the model."""
        match act:
            case Act.TRAIN:
                self.controller.train()
            case Act.KEEP_MODEL:
                self.controller.stop()
            case _:
                pass

    # How it is put together

    def _made_page(self) -> Generator[None, None, QWidget]:
        side = scrolled(self.side)
        side.setMinimumWidth(SIDE_PX)
        yield
        detail = self._make_detail()
        detail.setMinimumWidth(LEAST_DETAIL_PX)
        yield
        self.splitter = split((side, self.pane, detail), (SIDE_PX, 1280 - SIDE_PX - DETAIL_PX, DETAIL_PX), 1)
        yield
        return padded(self.splitter)

    def _make_detail(self) -> QTabWidget:
        lines = QVBoxLayout(self.machine)
        lines.setContentsMargins(4, 4, 4, 4)
        lines.addStretch(1)
        self.details = QTabWidget()
        self.details.addTab(scrolled(self.machine), self.tr("Computer"))
        self.details.addTab(self.progress, self.tr("Progress"))
        self.details.addTab(scrolled(self.light), self.tr("Effects"))
        self.details.setTabToolTip(0, self.tr("What this computer has, and what follows"))
        self.details.setTabToolTip(2, self.tr("Which model of mirrored light the scene calls for, and why"))
        return self.details

    def _connect(self) -> None:
        controller, side, context = self.controller, self.side, self._context
        side.choose.clicked.connect(self._choose_data_set)
        side.choose_out.clicked.connect(self._choose_out)
        side.form.valueChanged.connect(self._chosen)
        side.train.clicked.connect(controller.train)
        side.pause.clicked.connect(self._pause)
        side.stop.clicked.connect(controller.stop)
        side.cancel_training.clicked.connect(controller.cancel_training)
        self.light.valueChanged.connect(self._light_chosen)
        self.light.asked.connect(controller.ask_scene)
        controller.dataSetChanged.connect(self.pane.set_data_set)
        controller.dataSetChanged.connect(self._show_choice)
        controller.placeChanged.connect(self.pane.offer_models)
        controller.stateChanged.connect(self._show_state)
        controller.progressed.connect(self._show_progress)
        controller.lightChanged.connect(self._show_light)
        context.unitsChanged.connect(self._units_changed)
        self._shared_view.closing.connect(self._window_closing)

    # What the user does

    def _choose_data_set(self) -> None:
        card = self.controller.card
        places = (None if card is None else card.folder.parent, self._context.session.folder)
        folder = self.questions.folder(self._shared_view.window(), self.tr("Folder of a data set"), *places)
        if folder is not None:
            self.controller.read(folder)

    def _choose_out(self) -> None:
        folder = self.questions.new_folder(
            self._shared_view.window(), self.tr("Folder for the model"), self._proposed()
        )
        if folder is not None:
            self.controller.choose_out(folder)

    def _proposed(self) -> Path:
        """Where the model goes unless it is said otherwise."""
        return self.controller.out if self.controller.out.name else Path.home() / self.tr("model")

    def _chosen(self, choice: TrainChoice) -> None:
        self.controller.choose(replace(choice, light=self.light.value()))

    def _light_chosen(self, light: str) -> None:
        self.side.form.set_light(light)
        self.controller.choose(replace(self.controller.choice, light=light))
        self._show_light()

    def _pause(self) -> None:
        self.controller.pause(not self.controller.is_paused)

    def _window_closing(self, event: QCloseEvent) -> None:
        if not event.isAccepted():
            return
        if self.controller.is_busy and not self.asks.cancel_training(self._shared_view.window()):
            event.ignore()
            return
        self.pane.close_pictures()
        self.controller.close()

    # What is shown

    def _show_choice(self) -> None:
        """Show the method that a data set without panels is trained by."""
        if self.side.form.value().method != self.controller.choice.method:
            self.side.form.setValue(self.controller.choice)

    def _show_state(self) -> None:
        controller = self.controller
        self.side.form.set_cuda(controller.cuda or ())
        self.side.show_state()
        method = next(row for row in method_rows() if row.name == controller.choice.method)
        is_idle = controller.phase is Phase.IDLE
        self.light.set_possible(method, can_ask=is_idle and controller.card is not None, can_choose=is_idle)
        self._show_machine()
        if controller.is_busy and not self._was_busy:
            self.details.setCurrentWidget(self.progress)
            self.pane.show_training()
        self._was_busy = controller.is_busy
        self.pane.follow_training()
        self._show_progress()

    def _show_machine(self) -> None:
        controller, layout = self.controller, self.machine.layout()
        assert isinstance(layout, QVBoxLayout)
        lines = self._words.lines(controller)
        while len(self._machine_lines) < len(lines):
            label = QLabel()
            label.setWordWrap(True)
            layout.insertWidget(len(self._machine_lines), label)
            self._machine_lines.append(label)
        for number, label in enumerate(self._machine_lines):
            role, text = lines[number] if number < len(lines) else ("", "")
            label.setVisible(bool(text))
            label.setText(text)
            if label.property("role") != role:
                label.setProperty("role", role)
                label.style().polish(label)

    def _show_light(self) -> None:
        controller = self.controller
        self.light.show_decisions(controller.light, controller.decisions)

    def _show_progress(self) -> None:
        controller = self.controller
        stage, stepped = controller.training.stage, controller.training.stepped
        words, share = "", None
        if controller.phase is not Phase.IDLE and stage is not None:
            words = self._context.localized(stage.stage)
            share = -1.0 if stage.total <= 0 else stage.done / stage.total
        elif controller.phase is not Phase.IDLE:
            words, share = self.tr("starting"), -1.0
        words = self._phase_words(words)
        numbers = ""
        if stepped is not None:
            numbers = self.tr("{0}, {1} steps, {2} splats").format(
                minutes_text(stepped.seconds), stepped.step, stepped.n_splats
            )
            if controller.training.quality.y:
                numbers += self._quality_words()
        self.progress.set_state(words, share, numbers)
        self.progress.set_has_facades(self._has_facades())
        self.progress.set_curves(controller.training.quality, controller.training.terms)
        self.pane.follow_training()

    def _has_facades(self) -> bool:
        card = self.controller.card
        return card is None or card.source.has_panels

    def _quality_words(self) -> str:
        training = self.controller.training
        done = None if training.ended is None else training.ended.summary
        if done and done["psnr_db"] is not None:
            words = (
                self.tr("; {0:.2f} dB on facades of {1} unseen views")
                if self._has_facades()
                else self.tr("; {0:.2f} dB on {1} unseen views")
            )
            return words.format(done["psnr_db"], done["scored_views"])
        words = (
            self.tr("; {0:.2f} dB on facades of some unseen views")
            if self._has_facades()
            else self.tr("; {0:.2f} dB on some unseen views")
        )
        return words.format(training.quality.y[-1])

    def _phase_words(self, stage: str) -> str:
        controller = self.controller
        if controller.phase is Phase.ENDING:
            return self.tr("Cancelling; the state is being kept ...")
        if controller.phase is Phase.COOLING_DOWN and controller.training.stepped is None:
            return self.tr("Stops as soon as there is a model: {0}").format(stage)
        if controller.phase is Phase.COOLING_DOWN:
            return self.tr("Stopped: the rates fall, then the model is written.")
        if controller.is_paused:
            return self.tr("Paused. The model can be looked at.")
        if controller.phase is Phase.IDLE and controller.training.ended is not None:
            return {
                "done": self.tr("The model is finished."),
                "kept": self.tr("Cancelled; the state is kept."),
                "failed": self.tr("The training has failed; the message says why."),
            }[controller.training.ended.outcome]
        return stage[:1].upper() + stage[1:]

    def _units_changed(self, units: UnitSystem) -> None:
        self.pane.set_units(units)
        self.light.set_units(units)
