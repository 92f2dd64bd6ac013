"""Where a flight stands, in the window's language."""

from __future__ import annotations

from PySide6.QtCore import QObject

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.fly.fly_controller import FlyController
from groundstation.services.fly.events import LinkState, LiveView
from groundstation.vehicle.sortie.run_records import Phase


class FlightWords(QObject):
    """Says what a controller is doing."""

    def __init__(self, workspace: ApplicationContext, controller: FlyController, parent: QObject) -> None:
        super().__init__(parent)
        self._workspace, self._controller = workspace, controller

    def connected_to(self) -> str:
        """The other end of the link; empty where there is none."""
        controller = self._controller
        if not controller.is_connected:
            return ""
        if controller.choice.url:
            is_signed = controller.choice.is_signed
            return self.tr("{0}, signed").format(controller.choice.url) if is_signed else controller.choice.url
        return self.tr("Simulation, {0:g} times as fast").format(controller.choice.speed_up)

    def where_it_stands(self) -> str:
        """What is going on, or what to do first."""
        controller, in_hand = self._controller, self._controller.in_hand
        if self._workspace.document.site is None and not controller.is_connected:
            return self.tr("Open or import a site first, on the Site tab.")
        if (controller.plan is None or not controller.plan.sorties) and not controller.is_connected:
            return self.tr("Plan a flight first, on the Plan tab.")
        if controller.is_preparing:
            return self.tr("The flight is being prepared ...")
        if not controller.is_connected or in_hand is None:
            return self.tr("Not connected.")
        if in_hand.link is LinkState.OPENING or in_hand.view is None:
            return self.tr("The link is being opened ...")
        if in_hand.link is LinkState.SILENT:
            if in_hand.link_problem:
                return str(self._workspace.words(in_hand.link_problem))
            return self.tr("The link is open; no vehicle was heard yet.")
        return self._phase_text(in_hand.view)

    def _phase_text(self, view: LiveView) -> str:
        texts = {
            None: self.tr("Connected. Upload the mission."),
            Phase.CONNECTING: self.tr("Connecting ..."),
            Phase.PREPARING: self.tr("The vehicle is being prepared ..."),
            Phase.UPLOADING: self.tr("Uploading ..."),
            Phase.CHECKING: self.tr("On board. Waiting for the list."),
            Phase.READY: self.tr("Ready for take-off."),
            Phase.STARTING: self.tr("Starting ..."),
            Phase.FLYING: self.tr("Flying."),
            Phase.ENDED: self.tr("Landed."),
        }
        text = texts[view.phase]
        if not self._controller.is_for_shown_plan and not view.state.is_armed:
            return self.tr("This connection is for another plan. Disconnect, and connect for the plan that is shown.")
        what, done, total = view.doing
        if view.phase is Phase.UPLOADING and total > 0.0:
            return self.tr("{0} {1} ({2:.0f} of {3:.0f})").format(text, self._workspace.words(what), done, total)
        if view.phase is Phase.FLYING and view.state.mode is not None:
            return self.tr("{0} Mode: {1}").format(text, view.state.mode.value)
        return text
