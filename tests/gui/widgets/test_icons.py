"""Icons and colours: icons are drawn in the colour asked for and say their licence; text can be read in each theme."""

import pytest
from PySide6.QtGui import QColor

ROOM_PX = 24


def icons():
    from groundstation.gui.widgets.icons import FOLDER

    return sorted(FOLDER.glob("*.svg"))


@pytest.mark.lint
@pytest.mark.parametrize("path", icons(), ids=lambda path: path.stem)
def test_an_icon_states_its_licence_and_has_no_colour_of_its_own(path):
    text = path.read_text("utf-8")
    assert "SPDX-License-Identifier: Apache-2.0" in text
    assert "currentColor" in text
    assert "#" not in text.replace("http://www.w3.org/2000/svg", "")


def test_every_icon_is_drawn_in_the_colour_it_is_asked_for(application):
    from groundstation.gui.widgets.icons import icon_names, picture

    assert len(icon_names()) >= 20
    for name in icon_names():
        drawn = picture(name, "#cc2200", ROOM_PX).toImage()
        inked = [
            drawn.pixelColor(x, y)
            for x in range(ROOM_PX)
            for y in range(ROOM_PX)
            if drawn.pixelColor(x, y).alpha() > 200
        ]
        assert len(inked) > 12, f"{name} is all but empty"
        assert all(abs(colour.hue() - QColor("#cc2200").hue()) <= 2 for colour in inked), name


@pytest.mark.long
def test_a_button_has_its_icon_in_the_colours_of_the_theme(application):
    from PySide6.QtWidgets import QPushButton

    from groundstation.gui.widgets.icons import ICON_PX, set_icon, tint_all
    from groundstation.gui.widgets.theme import apply_theme
    from groundstation.services.settings import Theme

    def lightness(button):
        drawn = button.icon().pixmap(ICON_PX, ICON_PX).toImage()
        inked = (drawn.pixelColor(x, y) for x in range(drawn.width()) for y in range(drawn.height()))
        return max(colour.lightness() for colour in inked if colour.alpha() > 200)

    apply_theme(application, Theme.LIGHT)
    button = QPushButton("Save")
    set_icon(button, "save")
    dark_on_light = lightness(button)
    apply_theme(application, Theme.DARK)
    tint_all(application)
    assert lightness(button) > dark_on_light + 100
    apply_theme(application, Theme.LIGHT)
    tint_all(application)
    assert lightness(button) == dark_on_light


def luminance(colour):
    """WCAG 2.2's relative luminance of an sRGB colour."""
    values = [int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5)]
    linear = [value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4 for value in values]
    return sum(share * value for share, value in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


@pytest.mark.parametrize("theme", ["LIGHT", "DARK", "SUNLIGHT"])
def test_text_of_every_theme_can_be_read_on_what_is_behind_it(theme):
    from groundstation.gui.widgets import theme as themes

    found = getattr(themes, theme)
    pairs = [(found.accent_text, found.accent)]
    pairs += [(found.text, behind) for behind in (found.window, found.base, found.done)]
    named = (found.muted, found.error, found.warning, found.note, found.ok)
    pairs += [(text, behind) for text in named for behind in (found.window, found.base)]
    for text, behind in pairs:
        dark, light = sorted((luminance(text), luminance(behind)))
        assert (light + 0.05) / (dark + 0.05) >= 4.5, f"{text} on {behind}"
