"""What the process of models does (`messages.py`): trains, and shows models and photos.

One thread does the work; another reads what is asked. Between two steps of a training, and while it pauses, what is
looked at is rendered by the first, so that nothing looks at a model while it changes. Looking comes before learning: a
picture is waited for, a step is not.
"""

from __future__ import annotations

import os
import queue
import threading
import time
from typing import TYPE_CHECKING, Any

from groundstation.services.jobs.channel import Send, sendable
from groundstation.services.reconstruct.folders import note_training
from groundstation.services.reconstruct.messages import (
    AskScene,
    CancelTraining,
    Chosen,
    Devices,
    Ended,
    FirstLook,
    Measured,
    Organise,
    Pause,
    Phase,
    Probe,
    SceneMade,
    Stage,
    Stepped,
    Stop,
    Train,
    ViewRequest,
    WatchErrors,
)
from groundstation.services.reconstruct.render_queue import RenderQueue
from planning.base.errors import GroundStationError, OperationCancelled
from planning.base.progress import Trace, hear_compiling

if TYPE_CHECKING:
    from reconstruction.splats.rasterising.raster_types import RasterSettings
    from reconstruction.training.callbacks import History, TrainingSnapshot
    from reconstruction.training.model.joint_model import SceneModel

REPORT_S = 0.1
"""Shortest time between two reports of one stage, and of two steps."""

LAST_S = 30.0
"""For keeping the state of a training after the window has gone."""


class _Requests:
    """What the window wants now; written by the thread that reads, asked by the one that works."""

    def __init__(self) -> None:
        self.orders: queue.SimpleQueue[Train | AskScene | Organise | None] = queue.SimpleQueue()
        """None: there is something to look at, or the window has gone."""
        self.pause, self.stop, self.cancel, self.gone = (threading.Event() for _ in range(4))
        self.errors: WatchErrors | None = None
        self._looks: dict[tuple[type, str], ViewRequest | Probe] = {}
        self._lock = threading.Lock()

    def next_look(self) -> ViewRequest | Probe | None:
        """The look or probe that was asked for first, of those that no newer one has replaced."""
        with self._lock:
            place = next(iter(self._looks), None)
            return None if place is None else self._looks.pop(place)

    def take(self, message: Any) -> None:
        """Take a message of the window."""
        match message:
            case ViewRequest() | Probe():
                with self._lock:
                    self._looks[type(message), message.place] = message
                self.orders.put(None)
            case WatchErrors():
                self.errors = message
                self.orders.put(None)
            case Train() | AskScene():
                for event in (self.pause, self.stop, self.cancel):
                    event.clear()
                self.orders.put(message)
            case Organise():
                self.orders.put(message)
            case Pause(is_on):
                (self.pause.set if is_on else self.pause.clear)()
            case Stop():
                self.stop.set()
                self.pause.clear()
            case CancelTraining():
                self.cancel.set()
                self.pause.clear()


class _Server:
    """Does what is wished, and tells."""

    def __init__(self, send: Send) -> None:
        self._tell, self._requests = send, _Requests()
        self.take = self._requests.take
        self._render_queue = RenderQueue(self._tell)
        self._stage, self._reported_s, self._stepped_s = "", 0.0, 0.0
        self._is_joint, self._n_measured = False, 0
        hear_compiling(lambda text: self._tell(Stage(text, 0, 0)))

    def gone(self) -> float:
        """Break a training off: it keeps its state."""
        requests = self._requests
        requests.gone.set()
        requests.cancel.set()
        requests.pause.clear()
        requests.orders.put(None)
        return LAST_S

    def run(self) -> None:
        """Work until the window has gone."""
        from reconstruction.training.ranks import cuda_devices, graphics_cards, use_threads

        self._tell(Devices(cuda_devices(), graphics_cards()))
        while not self._requests.gone.is_set():
            use_threads(max(1, (os.cpu_count() or 1) - 1))
            has_more = (
                self._look() or self._render_queue.prepare() or self._render_queue.judge(self._requests.errors, None)
            )
            try:
                order = self._requests.orders.get(block=not has_more)
            except queue.Empty:
                continue
            match order:
                case Train():
                    self._train(order)
                case AskScene():
                    self._ask(order)
                case Organise():
                    self._organise(order)

    # Work

    def _train(self, order: Train) -> None:
        from groundstation.services.reconstruct.training import train_files, train_summary

        requests = self._requests
        self._is_joint, self._n_measured = False, 0
        self._render_queue.forget_training()
        try:
            if not order.resume:
                note_training(order.out, order.dataset, order.request)
            files = train_files(
                order.dataset,
                order.out,
                order.request,
                resume=order.resume,
                pause=requests.pause.is_set,
                stop=requests.stop.is_set,
                trace=Trace(),
                monitor=self,
                visit=self._visit,
                show_before=self._show_before,
            )
        except OperationCancelled:
            self._tell(Ended("kept"))
        except BaseException as error:
            self._tell(Ended("failed", sendable(error)))
        else:
            self._is_joint = False
            self._render_queue.keep_trained(files.trained)
            self._tell_measured([(point.t_s, point.value) for point in files.trained.history])
            self._tell(Ended("done", None, train_summary(files)))

    def _ask(self, order: AskScene) -> None:
        from groundstation.services.reconstruct.training import light_of_scene

        self._is_joint = False
        try:
            self._tell(Chosen(*light_of_scene(order.dataset, order.request, self)))
        except OperationCancelled:
            self._tell(Ended("kept"))
        except BaseException as error:
            self._tell(Ended("failed", sendable(error)))
        else:
            self._tell(Ended("done"))

    def _organise(self, order: Organise) -> None:
        from groundstation.services.model.objects import organised_beside

        try:
            self._tell(SceneMade(order, organised_beside(order.folder)))
        except GroundStationError as error:
            self._tell(SceneMade(order, None, str(error)))

    def report(self, stage: str, done: float, total: float) -> None:
        """Monitor of a training: looks at photos and finished models come between, its own model only in visits."""
        if self._requests.cancel.is_set():
            raise OperationCancelled("the training was cancelled")
        now = time.monotonic()
        if stage != self._stage or now - self._reported_s >= REPORT_S:
            self._stage, self._reported_s = stage, now
            self._tell(Stage(stage, done, total))
        if not self._is_joint:
            self._look()

    def _show_before(self, model: SceneModel, settings: RasterSettings, history: History) -> None:
        self._render_queue.keep_placed(model, settings)
        self._tell(FirstLook())
        self._tell_measured(history)

    def _visit(self, visit: TrainingSnapshot) -> None:
        self._render_queue.keep_snapshot(visit)
        if not self._is_joint:
            self._is_joint = True
            self._tell(Chosen(*self._render_queue.chosen(visit)))
        now = time.monotonic()
        if now - self._stepped_s >= REPORT_S:
            self._stepped_s = now
            phase: Phase = visit.state
            at = visit.step, visit.seconds, visit.progress, visit.left_s
            self._tell(Stepped(phase, *at, len(visit.model.splats), visit.terms))
        self._tell_measured(visit.history)
        while self._look():
            pass
        self._render_queue.judge(self._requests.errors, visit)

    def _tell_measured(self, history: History) -> None:
        for t_s, value in history[self._n_measured :]:
            self._tell(Measured(t_s, value))
        self._n_measured = max(self._n_measured, len(history))

    def _look(self) -> bool:
        """Answer one look; whether there was one."""
        look = self._requests.next_look()
        match look:
            case ViewRequest():
                self._tell(self._render_queue.answer(look))
            case Probe():
                self._tell(self._render_queue.probed(look))
        return look is not None


service = _Server
