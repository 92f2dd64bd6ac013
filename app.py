"""Reflight: the command line, or without a command the window."""

from __future__ import annotations

import sys

from groundstation.cli.main import main


def open_window() -> int:
    """Open the window; Qt is imported here and not before."""
    from groundstation.gui.start import run_window

    return int(run_window())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:], open_window))
