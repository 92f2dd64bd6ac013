"""IfcOpenShell in a process of its own: a hostile file may crash it, but not the ground station.

`read_in_worker` starts `python -m planning.site_import.ifc_worker FILE DEFLECTION THREADS FOLDER [ELEMENT ...]`, which
leaves `content.json` and `triangles.npy` in the folder and prints one JSON line per step. With 0 threads it takes one
element after the other and leaves out those that are named, which earlier runs have died of. Whatever IfcOpenShell
prints stays in that process.
"""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import IO, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.progress import Monitor
from planning.site_import.ifc_content import IfcContent, extract

POLL_S = 0.2
"""Time between two looks at whether the user has cancelled."""

MAX_FATAL = 5
"""Elements that may be left out because the kernel dies of them; each costs another run."""

EXIT_REFUSED = 3


def read_in_worker(path: Path, deflection_m: float, monitor: Monitor) -> tuple[IfcContent, NDArray[np.float64]]:
    """Content of an IFC file and its triangles, see `extract`.

    Raises
    ------
    InputError
        The file is wrong, or so broken that the geometry kernel died of it.
    """
    from planning.jit import n_threads  # not at the top: the worker needs no compiler

    inherited, root = os.environ.get("PYTHONPATH"), Path(__file__).resolve().parents[2]
    environment = {**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{inherited}" if inherited else str(root)}
    # -P: modules that lie about in the current folder are not ours.
    command = [sys.executable, "-P", "-m", "planning.site_import.ifc_worker", str(path), str(deflection_m)]
    fatal: list[str] = []
    with tempfile.TemporaryDirectory(prefix="reflight-ifc-") as folder:
        run = _run([*command, str(n_threads()), folder], environment, monitor)
        # Then one element after the other tells which of them the kernel dies of.
        while run.is_dead and len(fatal) <= MAX_FATAL:
            run = _run([*command, "0", folder, *fatal], environment, monitor)
            if not run.is_dead or run.element is None or run.element in fatal:
                break
            fatal.append(run.element)
        if run.refusal is not None:
            raise InputError(run.refusal)
        if run.is_dead:
            raise InputError(
                f"{path}: the geometry kernel crashed on this IFC file (status {run.status}), so something in it goes "
                "in circles or beyond all bounds; open and export it again in a BIM program"
            )
        content = msgspec.json.decode((Path(folder) / "content.json").read_bytes(), type=IfcContent)
        return content, np.load(Path(folder) / "triangles.npy")


class _Run(NamedTuple):
    """How a worker ended: its status, why it refused the file, and the last element that it announced."""

    status: int
    refusal: str | None
    element: str | None

    @property
    def is_dead(self) -> bool:
        """Whether the kernel took the process down."""
        return self.refusal is None and self.status != 0


def _run(command: list[str], environment: dict[str, str], monitor: Monitor) -> _Run:
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, env=environment
    )
    try:
        refusal, element = _follow(process, monitor)
    except BaseException:
        process.kill()
        raise
    finally:
        process.wait()
        if process.stdout is not None:
            process.stdout.close()
    return _Run(process.returncode, refusal, element)


def _follow(process: subprocess.Popen[bytes], monitor: Monitor) -> tuple[str | None, str | None]:
    """Pass on the worker's progress until it ends; returns why it refused the file, and the last element it took."""
    assert process.stdout is not None
    lines: queue.Queue[bytes | None] = queue.Queue()
    reader = threading.Thread(target=_read_lines, args=(process.stdout, lines), daemon=True)
    reader.start()
    done, refusal, element = 0, None, None
    while True:
        try:
            line = lines.get(timeout=POLL_S)
        except queue.Empty:
            monitor.report("building geometry", done, 100)
            continue
        if line is None:
            reader.join()
            return refusal, element
        message = json.loads(line)
        done, refusal = message.get("done", done), message.get("refused", refusal)
        element = message.get("element", element)
        monitor.report("building geometry", done, 100)


def _read_lines(stream: IO[bytes], lines: queue.Queue[bytes | None]) -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)


def main(arguments: list[str]) -> int:
    """Read one file, as the worker process."""
    path, deflection_m, threads, folder = Path(arguments[0]), float(arguments[1]), int(arguments[2]), Path(arguments[3])
    fatal = arguments[4:]
    # IfcOpenShell may print: only what is said here shall reach the pipe.
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)

    def say(message: dict[str, object]) -> None:
        channel.write(json.dumps(message) + "\n")
        channel.flush()

    try:
        announce = None if threads else lambda guid: say({"element": guid})
        content, triangles = extract(path, deflection_m, threads, lambda done: say({"done": done}), fatal, announce)
    except InputError as error:
        say({"refused": str(error)})
        return EXIT_REFUSED
    (folder / "content.json").write_bytes(msgspec.json.encode(content))
    np.save(folder / "triangles.npy", triangles)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
