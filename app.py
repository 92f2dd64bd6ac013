"""Reflight from its sources: `python app.py` is the same as the installed command `reflight`."""

from __future__ import annotations

import sys

from groundstation.__main__ import run

if __name__ == "__main__":
    sys.exit(run())
