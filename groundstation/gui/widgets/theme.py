"""Light, dark, and a theme for bright sun; sizes that a finger hits; colours that charts and views share.

All pairs of text and background have a contrast of at least 4.5 : 1 (WCAG 2.2, level AA), in sunlight 7 : 1 (AAA).
Hues are those of Okabe and Ito (2008), which colour-blind people tell apart; no state is told by colour alone.
"""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QGuiApplication, QPalette
from PySide6.QtWidgets import QApplication

from groundstation.services.settings import Theme
from planning.site.zones.records import Restriction

TOUCH_PX = 38
"""Height of what can be pressed: 9 mm at the 106 dpi of a 15-inch laptop, the least that is hit reliably by finger
(Parhi, Karlson and Bederson, 2006, found 9.2 mm)."""

FLIGHT_PX = 48
"""Height of the buttons of a flight, which are hit in a hurry."""

GLOVE_PX = 60
"""Of Return and Land, which are hit in a hurry with gloves."""

SORTIES = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#b58900", "#56b4e9")
FACADES = ("#3f8fd0", "#4aa880", "#8f6fc8", "#c86f9a", "#c8a23f", "#5fa8b8")


AUTHORISATION, CONDITION, NO_LIMIT = "#c2570c", "#8a7a00", "#4f6d7a"
"""Of geo-zones; what is prohibited or not known has the colour of errors."""


@dataclass(frozen=True, slots=True)
class Colours:
    """Named colours of one theme, as `#rrggbb`.

    `done` fills progress bars behind their text. `covered`, `open`, `unreachable` and `undecided` are the states of a
    hemisphere section.
    """

    is_dark: bool
    window: str
    base: str
    text: str
    muted: str
    line: str
    handle: str
    accent: str
    accent_text: str
    done: str
    error: str
    warning: str
    note: str
    ok: str
    scene: str
    covered: str = "#0072b2"
    open: str = "#e69f00"
    unreachable: str = "#9aa3ab"
    undecided: str = "#cc79a7"


LIGHT = Colours(
    is_dark=False,
    window="#f3f5f7",
    base="#ffffff",
    text="#15202b",
    muted="#52606d",
    line="#c5ccd3",
    handle="#d7dde2",
    accent="#005a9c",
    accent_text="#ffffff",
    done="#7fb2dd",
    error="#b3261e",
    warning="#8a5300",
    note="#005a9c",
    ok="#1b6e3c",
    scene="#eef2f5",
)
DARK = Colours(
    is_dark=True,
    window="#1c2227",
    base="#14191d",
    text="#e8edf1",
    muted="#a4b0ba",
    line="#3c4751",
    handle="#2b343c",
    accent="#66b2e8",
    accent_text="#0b1014",
    done="#22689c",
    error="#ff9d94",
    warning="#f2b950",
    note="#7cc0f0",
    ok="#7fd6a0",
    scene="#232a30",
)
SUNLIGHT = Colours(
    is_dark=False,
    window="#ffffff",
    base="#ffffff",
    text="#000000",
    muted="#222222",
    line="#000000",
    handle="#b4bbc1",
    accent="#003f7a",
    accent_text="#ffffff",
    done="#6fa3d0",
    error="#8c0f08",
    warning="#5e3800",
    note="#003f7a",
    ok="#07471f",
    scene="#ffffff",
    covered="#004c87",
    open="#c46a00",
    unreachable="#7b848c",
    undecided="#a0357a",
)


def colours_of(theme: Theme) -> Colours:
    """Colours of a theme; `system` follows the desktop."""
    if theme is Theme.SYSTEM:
        dark = QGuiApplication.styleHints().colorScheme() == Qt.ColorScheme.Dark
        return DARK if dark else LIGHT
    return {Theme.LIGHT: LIGHT, Theme.DARK: DARK, Theme.SUNLIGHT: SUNLIGHT}[theme]


_current = [LIGHT]


def colours() -> Colours:
    """Colours of the theme that was applied last."""
    return _current[0]


def apply_theme(application: QApplication, theme: Theme, text_scale: float = 1.0) -> Colours:
    """Dress the whole application; widgets that paint by themselves hear of it as a palette change."""
    found = colours_of(theme)
    _current[0] = found
    application.setStyle("Fusion")
    font = application.font()
    font.setPointSizeF(10.0 * text_scale * (1.1 if theme is Theme.SUNLIGHT else 1.0))
    font.setBold(False)
    application.setFont(font)
    application.setPalette(_palette(found))
    application.setStyleSheet(_style_sheet(found))
    return found


def _palette(found: Colours) -> QPalette:
    role = QPalette.ColorRole
    palette = QPalette()
    for name, colour in (
        (role.Window, found.window),
        (role.WindowText, found.text),
        (role.Base, found.base),
        (role.AlternateBase, found.window),
        (role.Text, found.text),
        (role.Button, found.window),
        (role.ButtonText, found.text),
        (role.BrightText, found.error),
        (role.Highlight, found.accent),
        (role.HighlightedText, found.accent_text),
        (role.Link, found.accent),
        (role.ToolTipBase, found.base),
        (role.ToolTipText, found.text),
        (role.PlaceholderText, found.muted),
        (role.Mid, found.line),
    ):
        palette.setColor(name, QColor(colour))
    for name in (role.Text, role.ButtonText, role.WindowText):
        palette.setColor(QPalette.ColorGroup.Disabled, name, QColor(found.muted))
    return palette


def _style_sheet(found: Colours) -> str:
    return f"""
    QPushButton, QToolButton {{ min-height: {TOUCH_PX - 8}px; padding: 3px 8px; border: 1px solid {found.line};
        border-radius: 4px; background: {found.base}; color: {found.text}; }}
    QPushButton:hover, QToolButton:hover {{ border-color: {found.accent}; }}
    QPushButton:disabled, QToolButton:disabled {{ background: {found.window}; color: {found.muted}; }}
    QPushButton:checked, QToolButton:checked, QPushButton[primary="true"]
        {{ background: {found.accent}; color: {found.accent_text}; border-color: {found.accent}; }}
    QPushButton[primary="true"]:disabled
        {{ background: {found.window}; color: {found.muted}; border-color: {found.handle}; }}
    QPushButton[flight] {{ min-height: {FLIGHT_PX - 8}px; }}
    QPushButton[flight="return"], QPushButton[flight="land"] {{ min-height: {GLOVE_PX - 8}px; }}
    QPushButton[flight="return"]:enabled
        {{ background: {found.warning}; color: {found.base}; border-color: {found.warning}; font-weight: bold; }}
    QPushButton[flight="land"]:enabled
        {{ background: {found.error}; color: {found.base}; border-color: {found.error}; font-weight: bold; }}
    QPushButton:focus, QToolButton:focus {{ border: 2px solid {found.accent}; padding: 2px 7px; }}
    QPushButton:checked:focus, QToolButton:checked:focus, QPushButton[primary="true"]:focus,
    QPushButton[flight="return"]:focus, QPushButton[flight="land"]:focus
        {{ border: 3px solid {found.text}; padding: 1px 6px; }}
    QDialogButtonBox {{ dialogbuttonbox-buttons-have-icons: 0; }}
    QComboBox, QAbstractSpinBox, QLineEdit {{ min-height: {TOUCH_PX - 6}px; }}
    QComboBox QAbstractItemView::item, QMenu::item {{ min-height: {TOUCH_PX - 6}px; }}
    QMenu::item {{ padding: 2px 24px 2px 12px; }}
    QMenu::item:selected, QMenuBar::item:selected {{ background: {found.accent}; color: {found.accent_text}; }}
    QMenuBar::item {{ padding: 7px 12px; }}
    QCheckBox::indicator:unchecked, QAbstractItemView::indicator:unchecked
        {{ border: 1px solid {found.muted}; background: {found.base}; }}
    QCheckBox, QRadioButton {{ min-height: {TOUCH_PX - 8}px; spacing: 8px; }}
    QTabBar QToolButton {{ min-height: 0px; padding: 0px; }}
    QTabBar QToolButton:focus {{ padding: 0px; }}
    QTabBar::scroller {{ width: {2 * (TOUCH_PX - 8)}px; }}
    QTabBar::tab {{ min-height: {TOUCH_PX - 8}px; padding: 3px 12px; background: {found.window}; color: {found.text};
        border: none; border-bottom: 3px solid transparent; }}
    QTabBar::tab:selected {{ border-bottom: 3px solid {found.accent}; font-weight: bold; }}
    QTabBar::tab:selected:focus {{ border: 2px solid {found.accent}; border-bottom-width: 3px; padding: 1px 10px; }}
    QTabBar::tab:disabled {{ color: {found.muted}; }}
    QHeaderView::section {{ min-height: {TOUCH_PX - 12}px; padding: 2px 6px; border: none;
        border-right: 1px solid {found.line}; border-bottom: 1px solid {found.line}; background: {found.window}; }}
    QTreeView, QTableView, QListView, QPlainTextEdit, QTextBrowser {{ border: 1px solid {found.line};
        background: {found.base}; }}
    QTreeView:focus, QTableView:focus, QListView:focus, QPlainTextEdit:focus, QTextBrowser:focus
        {{ border: 2px solid {found.accent}; }}
    QCheckBox:focus, QRadioButton:focus {{ color: {found.accent}; text-decoration: underline; }}
    QTreeView::item, QListView::item {{ min-height: {TOUCH_PX - 8}px; }}
    QProgressBar {{ border: 1px solid {found.line}; border-radius: 4px; text-align: center; min-height: 20px; }}
    QProgressBar::chunk {{ background: {found.done}; }}
    QScrollBar:vertical {{ width: 16px; }} QScrollBar:horizontal {{ height: 16px; }}
    QSplitter::handle {{ background: {found.handle}; }}
    QGroupBox {{ font-weight: bold; border: none; margin-top: 1.4em; }}
    QGroupBox::title {{ subcontrol-origin: margin; left: 0px; }}
    QToolTip {{ color: {found.text}; background: {found.base}; border: 1px solid {found.line}; }}
    QLabel[role="muted"] {{ color: {found.muted}; }}
    QLabel[role="error"] {{ color: {found.error}; font-weight: bold; }}
    QLabel[role="warning"] {{ color: {found.warning}; font-weight: bold; }}
    QLabel[role="ok"] {{ color: {found.ok}; font-weight: bold; }}
    QLabel[role="heading"] {{ font-weight: bold; }}
    """


def zone_colour(restriction: Restriction, found: Colours) -> str:
    """Colour of a geo-zone, `#rrggbb`."""
    known = {
        Restriction.AUTHORISATION: AUTHORISATION,
        Restriction.U_SPACE: AUTHORISATION,
        Restriction.CONDITIONAL: CONDITION,
        Restriction.NONE: NO_LIMIT,
    }
    return known.get(restriction, found.error)
