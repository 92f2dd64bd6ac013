"""Settings: they survive, mistakes are refused by name, and a file with mistakes is not written over."""

import math
import os
import stat
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.options import USUAL, ConnectionChoice, read_choice, read_flight_settings
from groundstation.services.settings import (
    MAX_RECENT_PROJECTS,
    Language,
    Settings,
    Theme,
    data_folder,
    read_settings,
    settings_at_start,
    settings_path,
    write_settings,
)
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError

texts = st.text(max_size=20)

any_settings = st.builds(
    Settings,
    theme=st.sampled_from(Theme),
    language=st.sampled_from(Language),
    units=st.sampled_from(UnitSystem),
    text_scale=st.floats(0.8, 2.0),
    autosave_s=st.just(0.0) | st.floats(5.0, 3600.0),
    recent_projects=st.lists(texts, max_size=MAX_RECENT_PROJECTS).map(tuple),
    map_tiles=texts,
    default_profile=texts.filter(bool),
    window_layouts=st.dictionaries(st.sampled_from(["1280x720", "1920x1080", "800x600"]), texts),
)


@given(settings=any_settings)
def test_all_settings_survive_the_file(tmp_path_factory, settings):
    path = tmp_path_factory.mktemp("settings") / "new" / "settings.toml"
    write_settings(path, settings)
    assert read_settings(path) == settings
    assert path.read_text("utf-8").startswith("# Settings of Reflight.")


def test_without_a_file_all_is_as_at_first(tmp_path):
    assert read_settings(tmp_path / "none.toml") == Settings()
    (tmp_path / "empty.toml").write_text("")
    assert read_settings(tmp_path / "empty.toml") == Settings()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('them = "dark"', "them: expected one of theme, language, .*, found an unknown key; is 'theme' meant\\?"),
        ("colour = 1", "colour: expected one of theme, .*, found an unknown key$"),
        ('theme = "blue"', "theme: expected system or light or dark or sunlight, got 'blue'"),
        ("theme = 3", "theme: expected system or light or dark or sunlight, got 3"),
        ('language = "fr"', "language: expected system or en or de, got 'fr'"),
        ('units = ["metric"]', "units: expected metric or imperial, got \\['metric'\\]"),
        ('text_scale = "big"', "text_scale: expected number, got text"),
        ("text_scale = 0.5", "text_scale: expected 0.8 to 2.0, got 0.5"),
        ("text_scale = nan", "text_scale: expected 0.8 to 2.0, got nan"),
        ("text_scale = true", "text_scale: expected number, got true/false"),
        ("autosave_s = inf", "autosave_s: expected 5 to 3600, or 0 for never, got inf"),
        ("autosave_s = 1", "autosave_s: expected 5 to 3600, or 0 for never, got 1"),
        ("autosave_s = 2026-01-01", "autosave_s: expected number, got 'date'"),
        ("recent_projects = 'x'", "recent_projects: expected list, got text"),
        ("recent_projects = [1]", "recent_projects\\[0\\]: expected text, got whole number"),
        (f"recent_projects = {['x'] * 11}", "recent_projects: expected at most 10 folders, got 11"),
        ("default_profile = ''", "default_profile: expected the name of an aircraft profile"),
        ("[window_layouts]\nlarge = 'x'", "window_layouts: expected sizes such as 1280x720, got 'large'"),
        ("[window_layouts]\n1280x720 = 3", "window_layouts.*: expected text, got whole number"),
        ("theme = ", "not valid TOML"),
        ("theme = 'dark'\ntheme = 'light'", "not valid TOML"),
    ],
)
def test_mistakes_are_refused_with_file_key_expected_and_found(tmp_path, line, message):
    path = tmp_path / "settings.toml"
    path.write_text(line)
    with pytest.raises(InputError, match=message) as caught:
        read_settings(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("content", [b"\xff", b"theme = 'blue'\n", b"\x00"])
def test_a_file_with_mistakes_is_not_written_over_before_the_user_agrees(tmp_path, content):
    path = tmp_path / "settings.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"settings\.toml"):
        write_settings(path, Settings())
    assert path.read_bytes() == content
    write_settings(path, Settings(theme=Theme.DARK), replace_unreadable=True)
    assert read_settings(path).theme is Theme.DARK


def test_settings_that_cannot_be_written_say_where(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file: cannot be made"):
        write_settings(tmp_path / "file" / "settings.toml", Settings())


def test_wrong_values_never_become_settings():
    for change in ({"text_scale": math.nan}, {"autosave_s": -1.0}, {"recent_projects": ("x",) * 11}):
        with pytest.raises(ValueError, match="expected"):
            replace(Settings(), **change)


def test_recent_projects_are_the_latest_ten_without_doubles(tmp_path):
    settings = Settings()
    for number in range(12):
        settings = settings.with_recent(tmp_path / str(number))
    assert len(settings.recent_projects) == 10
    settings = settings.with_recent(tmp_path / "5")
    assert settings.recent_projects[:2] == (str(tmp_path / "5"), str(tmp_path / "11"))
    assert len(set(settings.recent_projects)) == 10
    assert str(tmp_path / "5") not in settings.without_recent(str(tmp_path / "5")).recent_projects


def test_a_folder_whose_name_is_no_text_does_not_spoil_the_settings(tmp_path):
    settings = Settings().with_recent(Path("/a/\udcff"))
    assert settings.recent_projects == ()
    write_settings(tmp_path / "settings.toml", settings)


def test_the_place_of_settings_and_data_can_be_chosen(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    assert settings_path() == tmp_path / "settings.toml"
    assert data_folder() == tmp_path / "data"
    monkeypatch.delenv("REFLIGHT_CONFIG_DIR")
    assert settings_path().name == "settings.toml"
    assert "reflight" in str(settings_path()).lower()
    assert "reflight" in str(data_folder()).lower()


def test_the_header_names_every_choice(tmp_path):
    path = tmp_path / "settings.toml"
    write_settings(path, Settings())
    text = path.read_text("utf-8")
    for kind in (Theme, Language, UnitSystem):
        assert ", ".join(kind) in text
    assert set(tomllib.loads(text)) == set(Settings.__slots__)


def nothing(path):
    path.symlink_to("nowhere")


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_text("a = " + "[" * 100_000),
        lambda path: path.write_text("a." * 100_000 + "a = 1"),
        lambda path: path.write_text("seed = " + "1" * 5000),
        lambda path: path.write_text("a = 1\n" * 1_000_000),
        lambda path: path.write_bytes(b"\xff\xfe"),
        lambda path: path.symlink_to("/dev/zero"),
        lambda path: path.mkdir(),
        os.mkfifo,
        nothing,
    ],
)
def test_a_program_starts_with_damaged_settings_and_keeps_them_aside(tmp_path, damage):
    for path, read, first in (
        (tmp_path / "settings.toml", settings_at_start, Settings()),
        (tmp_path / "flight.toml", read_flight_settings, USUAL),
        (tmp_path / "connection.toml", read_choice, ConnectionChoice()),
    ):
        damage(path)
        kind = stat.S_IFMT(path.lstat().st_mode)
        said = []
        assert read(path, said.append) == first
        aside = path.with_name(f"{path.stem}.damaged.toml")
        assert len(said) == 1
        assert said[0].startswith(f"{path}: ")
        assert said[0].endswith(f"the damaged file is kept as '{aside}'")
        assert len(said[0]) < 700
        assert stat.S_IFMT(aside.lstat().st_mode) == kind
        assert not os.path.lexists(path)
        assert read(path, said.append) == first
        assert len(said) == 1
    write_settings(tmp_path / "settings.toml", Settings())


def test_damaged_settings_that_cannot_be_put_aside_stay(tmp_path):
    path = tmp_path / "settings.toml"
    path.write_text("x")
    aside = tmp_path / "settings.damaged.toml"
    aside.mkdir()
    (aside / "kept").touch()
    said = []
    assert settings_at_start(path, said.append) == Settings()
    assert "the file stays as it is" in said[0]
    assert path.read_text() == "x"
