"""Flying the vehicle at the end of a link: its telemetry log is always written, a broken link is opened again."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from groundstation.vehicle.conduct import conduct
from groundstation.vehicle.flight_run import FlightRun
from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.run_records import RunOptions, RunOutcome, RunView
from groundstation.vehicle.telemetry_log import TelemetryLog, new_log_path
from missions.mavlink.link import ChannelLink, open_link
from missions.mavlink.signing import Signer
from planning.progress import QUIET, Monitor


def fly_link(
    orders: SortieOrders,
    url: str,
    options: RunOptions,
    log_folder: Path,
    show: Callable[[RunView], None] | None = None,
    started: Callable[[FlightRun], None] | None = None,
    signer: Signer | None = None,
    monitor: Monitor = QUIET,
) -> tuple[FlightRun, RunOutcome, Path]:
    """Fly a sortie: the run as it ended, how it ended, and its telemetry log.

    Parameters
    ----------
    started
        Called with the run before it begins: whoever keeps it may give it the pilot's orders from any thread.
    signer
        Signs what is sent, and lets nothing in that the vehicle did not sign; None: unsigned.

    Raises
    ------
    InputError
        The url is none, or the log cannot be made.
    LinkError
        The link cannot be opened.
    """
    run = FlightRun(orders, options, url)
    log = TelemetryLog(new_log_path(log_folder, time.time(), f"sortie-{orders.number}"))

    def opened() -> ChannelLink:
        link = open_link(url, signer=signer)
        link.observe(lambda frame, _sent, _time_s: log.write(frame, time.time()))
        return link

    told = ""

    def look(view: RunView) -> None:
        nonlocal told
        if log.problem and log.problem != told:
            run.note("log", log.problem)
        told = log.problem
        if show is not None:
            show(view)

    try:
        link = opened()
        if started is not None:
            started(run)
        outcome = conduct(run, link, time.perf_counter, reopen=opened, show=look, monitor=monitor)
    finally:
        log.close()
    return run, outcome, log.path
