"""What stands in the Site tab before there is a site: what to do first."""

from __future__ import annotations

from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.site.site_opener import SiteOpener
from groundstation.gui.site.value_boxes import muted

BUTTON_HEIGHT_PX = 52


class StartPage(QWidget):
    """Three large buttons."""

    def __init__(self, opener: SiteOpener, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        heading = QLabel(self.tr("Begin with a site"))
        heading.setProperty("role", "heading")
        heading.setWordWrap(True)
        layout.addWidget(heading)
        layout.addWidget(muted(self.tr("A site holds the glass panels, the building, and where you may fly.")))
        self.import_button = _large(self.tr("Import a building model"), primary=True)
        self.open_button = _large(self.tr("Open a site file"))
        self.bundled_button = _large(self.tr("Try a bundled site"))
        self.import_button.clicked.connect(opener.choose_import)
        self.open_button.clicked.connect(opener.choose_site)
        self.bundled_button.setMenu(opener.bundled_menu(self.bundled_button))
        for button, text in (
            (self.import_button, self.tr("IFC, CityGML, CityJSON, OBJ, PLY, GLB or STL")),
            (self.open_button, self.tr("A site.json that was saved before")),
            (self.bundled_button, self.tr("To look around, and to try a plan")),
        ):
            layout.addWidget(button)
            layout.addWidget(muted(text))
        layout.addStretch(1)


def _large(text: str, *, primary: bool = False) -> QPushButton:
    button = QPushButton(text)
    button.setStyleSheet(f"min-height: {BUTTON_HEIGHT_PX}px;")
    button.setProperty("primary", primary)
    return button
