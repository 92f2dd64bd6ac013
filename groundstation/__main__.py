"""The command `reflight`, also as `python -m groundstation`: the command line, or without a command the window."""

from __future__ import annotations

import sys

from groundstation.cli.main import WindowOptions, main


def open_window(request: WindowOptions) -> int:
    """Open the window, or take pictures of it; Qt is imported here and not before."""
    if request.screenshots is not None:
        from groundstation.gui.start import take_pictures

        return take_pictures(request.screenshots, request.site)
    from groundstation.gui.start import run_window

    return run_window(request.open)


def run() -> int:
    """Run what the command line asks for; returns the exit status."""
    return main(sys.argv[1:], open_window)


if __name__ == "__main__":
    sys.exit(run())
