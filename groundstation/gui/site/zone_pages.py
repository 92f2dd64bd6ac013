"""Property pages of geo-zones and of the files that they are from."""

from __future__ import annotations

import math
from functools import partial

from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.site.pages import Page
from groundstation.gui.widgets.value_boxes import NameBox, muted
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.zones import permit, remove_zones, zone_facts
from groundstation.services.units import UnitSystem, length_unit
from planning.checks.zones import source_text
from planning.site.records import SiteModel
from planning.site.zones.keep_out import known_files, near_zones


class ZonePage(Page):
    """A geo-zone: what it asks for, from which source, and the pilot's authorisation."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._item: Item | None = None
        self._zone_id = self._file = ""
        self._facts, self._source = QLabel(), muted("")
        self._facts.setWordWrap(True)
        self._reference = NameBox()
        self._reference.setPlaceholderText(self.tr("number and date, or who answered when"))
        self.add(self._facts, title=self.tr("Geo-zone"))
        self.add(self._reference, title=self.tr("Authorisation"))
        self.add(
            muted(self.tr("With an authorisation plans may enter this zone. It holds for this state of the file.")),
            self._error,
        )
        self.add(self._source, title=self.tr("Source"))
        self._reference.valueChanged.connect(self._permit)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a zone."""
        near = next(found for found in near_zones(model) if found.key == item.id)
        self._item, self._zone_id, self._file = item, near.local.zone.id, near.source.file
        distance_m = near.local.distance_m
        away = self.tr("{0} from the airspace").format(length_unit(self._units).text(distance_m))
        if not math.isfinite(distance_m):
            away = self.tr("Its place is not known.")
        elif distance_m <= 0.0:
            away = self.tr("It reaches over the airspace.")
        lines = [translated(line, self._units) for line in zone_facts(near)]
        self._facts.setText("\n".join([*lines, away]))
        known = next(found for found in known_files(model) if found.source is near.source)
        self._source.setText(translated(source_text(known), self._units))
        self._reference.setValue(near.permitted)

    def text(self) -> str:
        """What is said of the zone."""
        return self._facts.text()

    def reference_box(self) -> NameBox:
        """Editor of the authorisation."""
        return self._reference

    def _permit(self, reference: str) -> None:
        if self._item is not None:
            edit = partial(permit, zone_id=self._zone_id, reference=reference, file=self._file)
            self.edited.emit(self.tr("Authorisation for {0}").format(self._zone_id), edit, self._item)


class ZoneFilePage(Page):
    """A file of geo-zones: format, publisher, dates, and its problem where it has one."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._file = ""
        self._facts = QLabel()
        self._facts.setWordWrap(True)
        remove = QPushButton(self.tr("Remove this file"))
        remove.clicked.connect(self._remove)
        self.add(self._facts, title=self.tr("File of geo-zones"))
        self.add(remove, self._error)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a file."""
        self._file = item.id
        known = next(found for found in known_files(model) if found.source.file == item.id)
        lines = [translated(source_text(known), self._units)]
        if known.content is None or known.local is None:
            lines.append(translated(known.problem, self._units))
        else:
            lines.append(
                self.tr("Zones: {0}, near the site: {1}").format(len(known.content.zones), len(known.local.near))
            )
        self._facts.setText("\n".join([*lines, f"SHA-256 {known.source.sha256[:16]}"]))

    def text(self) -> str:
        """What is said of the file."""
        return self._facts.text()

    def _remove(self) -> None:
        edit = partial(remove_zones, name=self._file)
        self.edited.emit(self.tr("Remove {0}").format(self._file), edit, Item(ItemKind.BUILDING))
