"""An aircraft: the entry point stands for the file of its figures."""

from pathlib import Path

PROFILES = Path(__file__).with_name("aircraft.toml")
