"""A process that has the program loaded, and makes a copy of itself for each case, with bounds on memory and time.

`python -W error -m tests.hostile.forks` reads one job in JSON from each line and answers each with one: see `main`.
"""

from __future__ import annotations

import importlib
import io
import json
import os
import re
import resource
import select
import signal
import sys
import time
from pathlib import Path
from typing import Any

MEMORY_BYTES = 3 * 2**30
"""Beyond what the program takes when it is loaded."""

LONGEST_S = 60
"""Of processor time: how long that takes hangs on what else the machine does."""

PATIENCE_S = 400.0
"""For what waits and does not work."""


def _run(job: dict[str, Any]) -> int:
    """Do a job in this process, as the command line would; returns its exit status."""
    from groundstation.cli.main import EXIT_FAILED, main
    from planning.base.errors import GroundStationError, shortened

    if "command" in job:
        return main(job["command"], lambda _: 99)
    module, _, name = job["reader"].partition(":")
    try:
        getattr(importlib.import_module(module), name)(Path(job["path"]))
    except GroundStationError as error:
        sys.stderr.write(f"error: {' '.join(shortened(str(error)).split())}\n")
        return EXIT_FAILED
    return 0


WRITES = ("open", "fsync", "replace", "rename", "mkdir", "unlink", "rmdir", "chmod", "link")


def _die_at_write(number: int) -> None:
    """Let this process be killed just before the n-th time, from 0, that it changes something on the disk."""
    left = [number]

    def of(name: str, call: Any) -> Any:
        def counting(*arguments: Any, **options: Any) -> Any:
            how = arguments[1] if len(arguments) > 1 else options.get("mode", "r")
            if name != "open" or (how & (os.O_WRONLY | os.O_RDWR) if isinstance(how, int) else set(how) & set("wax+")):
                left[0] -= 1
                if left[0] < 0:
                    os.kill(os.getpid(), signal.SIGKILL)
            return call(*arguments, **options)

        return counting

    for name in WRITES:
        setattr(os, name, of(name, getattr(os, name)))
    io.open = of("open", io.open)


def _child(job: dict[str, Any]) -> None:
    os.chdir(job["folder"])
    for descriptor, name in ((0, os.devnull), (1, job["out"]), (2, job["err"])):
        opened = os.open(name, os.O_RDWR | os.O_CREAT | os.O_TRUNC)
        os.dup2(opened, descriptor)
    sys.stdin, sys.stdout, sys.stderr = (os.fdopen(n, mode) for n, mode in ((0, "r"), (1, "w"), (2, "w")))
    # Memory of its own; what libraries map of their files is none.
    data_kb = re.search(r"VmData:\s+(\d+)", Path("/proc/self/status").read_text())
    assert data_kb is not None
    limit = 1024 * int(data_kb[1]) + MEMORY_BYTES
    resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST_S, LONGEST_S + 5))
    if "file_limit" in job:
        # Python ignores the signal, so that a write beyond fails as on a disk that is full; else it ends the process.
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL if job.get("is_killed") else signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (job["file_limit"], resource.RLIM_INFINITY))
    if "kill_at" in job:
        _die_at_write(job["kill_at"])
    status = 98
    try:
        status = _run(job)
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def _say(answer: str) -> None:
    sys.stdout.write(answer + "\n")
    sys.stdout.flush()


def main() -> None:
    """Answer jobs until there are no more.

    A job has `folder` to be in, `out` and `err` for what is said, and `command` (arguments) or `reader` (module:name)
    with `path`. With `kill_after_s`, `kill_at` (a number of writes), or `file_limit` (bytes) and `is_killed`, it is
    killed on the way; with `file_limit` alone, writing fails. An answer has `status` (negative for a signal),
    `seconds`, and whether it took too long.
    """
    from groundstation.cli.main import build_parser

    build_parser()
    for name in json.loads(sys.stdin.readline()):
        importlib.import_module(name)
    _say("ready")
    for line in sys.stdin:
        job = json.loads(line)
        started = time.monotonic()
        pid = os.fork()
        if pid == 0:
            _child(job)
        handle = os.pidfd_open(pid)
        in_time = bool(select.select([handle], [], [], job.get("kill_after_s", PATIENCE_S))[0])
        if not in_time:
            os.kill(pid, signal.SIGKILL)
        status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        os.close(handle)
        in_time = in_time and status != -signal.SIGXCPU
        answer = {"status": status, "seconds": time.monotonic() - started, "in_time": in_time}
        _say(json.dumps(answer))


if __name__ == "__main__":
    main()
