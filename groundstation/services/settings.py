"""Settings, one TOML file with wrong keys and values refused by name; and small choices in files beside it."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, TypeVar

from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.base.files import make_folder, real_path
from planning.base.json_file import plain_values, read_toml, to_record, write_atomically
from planning.base.messages import glue, say
from planning.parameters import DEFAULT_PROFILE

# Small choices of the pilot that are kept for the next start, each in a TOML file beside the settings.

Record = TypeVar("Record")


Tell = Callable[[str], None]


def read_preferences(path: Path, first: Record, tell: Tell = lambda _: None) -> Record:
    """What was kept; `first` where nothing was, or the file is damaged, which is told then and put aside."""
    return or_first(path, lambda: read_toml(path, type(first)), first, tell)


def or_first(path: Path, read: Callable[[], Record], first: Record, tell: Tell) -> Record:
    """What a file holds, or `first` where there is none; a damaged one is put aside, so that nothing of it is lost.

    Parameters
    ----------
    tell
        Called with what was wrong and what became of the file.
    """
    try:
        return read()
    except InputError as error:
        if os.path.lexists(path):
            tell(glue(error, "; ", _put_aside(path)))
        return first


def _put_aside(path: Path) -> str:
    """Give a damaged file another name, in place of the last one; returns what was done."""
    aside = path.with_name(f"{path.stem}.damaged{path.suffix}")
    try:
        path.replace(aside)
    except OSError:
        return say("its settings are as at first, and the file stays as it is")
    return say("its settings are as at first again, and the damaged file is kept as '{}'", aside)


def write_preferences(path: Path, record: object) -> None:
    """Keep a record; its folder is made where it is missing.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    import tomli_w

    make_folder(path.parent)
    write_atomically(path, tomli_w.dumps(plain_values(record)).encode())


CONFIG_VARIABLE = "REFLIGHT_CONFIG_DIR"
"""Environment variable that names the folder for settings and data, for tests and for a program on a stick."""

MAX_RECENT_PROJECTS = 10

HEADER = """\
# Settings of Reflight. Edit them while no window is open; what they mean is in docs/guide/projects.md.
# theme: system, light, dark, sunlight; language: system, en, de; units: metric, imperial
# text_scale: 0.8 to 2.0; autosave_s: 5 to 3600, or 0 for never; map_tiles: an MBTiles or PMTiles file, or empty
# models_drawn_by: auto, cpu, gpu
# online_map_is_on: no map tile is asked for from the network while it is false

"""


class Theme(StrEnum):
    """Colours of the window."""

    SYSTEM = "system"
    LIGHT = "light"
    DARK = "dark"
    SUNLIGHT = "sunlight"


class Language(StrEnum):
    """Language of the window."""

    SYSTEM = "system"
    ENGLISH = "en"
    GERMAN = "de"


class DrawnBy(StrEnum):
    """What draws pictures of models; `AUTO` takes what is faster."""

    AUTO = "auto"
    PROCESSOR = "cpu"
    CARD = "gpu"


@dataclass(frozen=True, slots=True)
class Settings:
    """What the user has chosen.

    Parameters
    ----------
    text_scale
        Of all text, 1 as the system has it.
    autosave_s
        Seconds between copies of unsaved work, 0 for none.
    recent_projects
        Folders, the latest first.
    map_tiles
        Path of an MBTiles or PMTiles file for maps without network; empty for none.
    map_overlays
        Files that lie on the map: GeoJSON, KML, KMZ or GeoTIFF.
    online_map_url, online_map_attribution, online_map_max_zoom, online_map_cache_mb, online_map_is_on
        A server of map tiles: address with {z}, {x} and {y}, licence as it stands on the map, deepest level, room for
        tiles on the disk, and whether tiles may be asked for.
    default_profile
        Aircraft and camera that a new plan starts with: see `planning.aircraft.catalogue.profile`.
    window_layouts
        Layout of the window as text, by its size ("1280x720").
    has_seen_tour
        The start page offers the tour no more.
    models_drawn_by
        What draws pictures of models in the window.
    """

    theme: Theme = Theme.SYSTEM
    language: Language = Language.SYSTEM
    units: UnitSystem = UnitSystem.METRIC
    text_scale: float = 1.0
    autosave_s: float = 30.0
    recent_projects: tuple[str, ...] = ()
    map_tiles: str = ""
    map_overlays: tuple[str, ...] = ()
    online_map_url: str = ""
    online_map_attribution: str = ""
    online_map_max_zoom: int = 19
    online_map_cache_mb: int = 200
    online_map_is_on: bool = False
    default_profile: str = DEFAULT_PROFILE
    window_layouts: Mapping[str, str] = field(default_factory=dict, hash=False)
    has_seen_tour: bool = False
    models_drawn_by: DrawnBy = DrawnBy.AUTO

    def __post_init__(self) -> None:
        if not 0.8 <= self.text_scale <= 2.0:
            raise ValueError(f"text_scale: expected 0.8 to 2.0, got {self.text_scale:g}")
        if not (self.autosave_s == 0.0 or 5.0 <= self.autosave_s <= 3600.0):
            raise ValueError(f"autosave_s: expected 5 to 3600, or 0 for never, got {self.autosave_s:g}")
        if len(self.recent_projects) > MAX_RECENT_PROJECTS:
            raise ValueError(
                f"recent_projects: expected at most {MAX_RECENT_PROJECTS} folders, got {len(self.recent_projects)}"
            )
        if not 0 <= self.online_map_max_zoom <= 24:
            raise ValueError(f"online_map_max_zoom: expected 0 to 24, got {self.online_map_max_zoom}")
        if not 10 <= self.online_map_cache_mb <= 10_000:
            raise ValueError(f"online_map_cache_mb: expected 10 to 10000, got {self.online_map_cache_mb}")
        if not self.default_profile:
            raise ValueError("default_profile: expected the name of an aircraft profile, got an empty text")
        for size in self.window_layouts:
            if re.fullmatch(r"[1-9]\d{1,4}x[1-9]\d{1,4}", size) is None:
                raise ValueError(f"window_layouts: expected sizes such as 1280x720, got '{size}'")

    def with_recent(self, folder: Path) -> Settings:
        """With a project as the latest one; a folder whose name is no valid text is not kept, TOML cannot hold it."""
        name = str(real_path(folder))
        if name.encode(errors="replace").decode() != name:
            return self
        others = tuple(known for known in self.recent_projects if known != name)
        return replace(self, recent_projects=(name, *others)[:MAX_RECENT_PROJECTS])

    def without_recent(self, folder: str) -> Settings:
        """Without a project that is not there any more."""
        return replace(self, recent_projects=tuple(known for known in self.recent_projects if known != folder))


CHOICES: dict[str, type[StrEnum]] = {
    "theme": Theme,
    "language": Language,
    "units": UnitSystem,
    "models_drawn_by": DrawnBy,
}


def settings_path() -> Path:
    """Where the settings are: in the user's folder for settings, or where REFLIGHT_CONFIG_DIR says."""
    import platformdirs

    chosen = os.environ.get(CONFIG_VARIABLE)
    folder = Path(chosen) if chosen else platformdirs.user_config_path("reflight", appauthor=False)
    return folder / "settings.toml"


def data_folder() -> Path:
    """Where Reflight keeps what belongs to no project: the user's data folder, or `data` in REFLIGHT_CONFIG_DIR."""
    import platformdirs

    chosen = os.environ.get(CONFIG_VARIABLE)
    return Path(chosen) / "data" if chosen else platformdirs.user_data_path("reflight", appauthor=False)


def read_settings(path: Path) -> Settings:
    """Settings from a file; all as they are at first where there is no file.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML, a key is unknown, or a value has the wrong type or is out of range.
    """
    try:
        content = read_toml(path, dict[str, Any])
    except InputError:
        if os.path.lexists(path):
            raise
        return Settings()
    known = [setting.name for setting in fields(Settings)]
    for key, value in content.items():
        if key not in known:
            close = difflib.get_close_matches(key, known, 1)
            hint = say("; is '{}' meant?", close[0]) if close else ""
            raise InputError(
                say("expected one of {}, found an unknown key{}", ", ".join(known), hint, place=f"{path}: {key}")
            )
        if key in CHOICES and value not in list(CHOICES[key]):
            raise InputError(say("expected {}, got {}", " or ".join(CHOICES[key]), repr(value), place=f"{path}: {key}"))
    return to_record(content, Settings, path)


def settings_at_start(path: Path, tell: Tell) -> Settings:
    """Settings to start with: those of the first start where the file is damaged; see `read_preferences`."""
    return or_first(path, lambda: read_settings(path), Settings(), tell)


def write_settings(path: Path, settings: Settings, *, replace_unreadable: bool = False) -> None:
    """Write settings, whole or not at all; the folder is made where it is missing.

    Parameters
    ----------
    replace_unreadable
        The user has agreed that a file with mistakes may go; without that it is left as it is.

    Raises
    ------
    InputError
        The file cannot be written, or has mistakes that the user may want to correct.
    """
    if not replace_unreadable:
        read_settings(path)
    make_folder(path.parent)
    import tomli_w

    write_atomically(path, (HEADER + tomli_w.dumps(plain_values(settings))).encode())
