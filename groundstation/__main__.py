"""The command `reflight`, also as `python -m groundstation`: the command line, or without a command the window."""

from __future__ import annotations

import atexit
import contextlib
import os
import sys

from groundstation.cli.main import WindowOptions, main


def open_window(request: WindowOptions) -> int:
    """Open the window, or take pictures of it; Qt is imported here and not before."""
    if request.screenshots is not None:
        from groundstation.gui.start import take_pictures

        return take_pictures(request.screenshots, request.site)
    from groundstation.gui.start import run_window

    return run_window(request.open)


class _EndOfCommand:
    """Ends the process of a command, behind all else that is to be done then, without freeing what libraries hold.

    With Open3D and Numba loaded that takes 0.7 s. Where no status is set the interpreter ends as usual.
    """

    status: int | None = None

    def __call__(self) -> None:
        if self.status is not None:
            for stream in (sys.stdout, sys.stderr):
                with contextlib.suppress(OSError, ValueError):
                    stream.flush()
            os._exit(self.status)


def run() -> int:
    """Run what the command line asks for; returns the exit status."""
    end, is_window = _EndOfCommand(), False
    atexit.register(end)  # what is registered first is called last

    def window(request: WindowOptions) -> int:
        nonlocal is_window
        is_window = True
        return open_window(request)

    status = main(sys.argv[1:], window)
    if not is_window:
        end.status = status
    return status


if __name__ == "__main__":
    sys.exit(run())
