"""What the import dialog says about a preview."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from groundstation.gui.site.site_tree_model import size_text
from groundstation.services.site_edits import height_above_sea_m
from groundstation.services.site_sources import SiteSummary, site_summary
from groundstation.services.units import UnitSystem, area_unit, length_unit
from planning.site import Origin, SiteModel

MAX_LISTED = 8
"""Facades listed one by one."""


def preview_text(model: SiteModel, units: UnitSystem) -> str:
    """Panels by facade, size, and place on earth, a line each."""
    summary = site_summary(model)
    size = QCoreApplication.translate("ImportTexts", "Size {0} (east × north × up); triangles: {1}").format(
        size_text(list(summary.size_m), units), summary.n_triangles
    )
    return "\n".join((_panels_text(summary, units), size, place_text(model.site.origin, units)))


def place_text(origin: Origin, units: UnitSystem) -> str:
    """A place with its height in both references."""
    unit = length_unit(units)
    return QCoreApplication.translate(
        "ImportTexts", "Zero at {0:.6f}°, {1:.6f}°, {2} above the ellipsoid, {3} above sea level (EGM96)"
    ).format(
        origin.lat_deg,
        origin.lon_deg,
        unit.text(origin.ellipsoid_height_m),
        unit.text(height_above_sea_m(origin)),
    )


def _panels_text(summary: SiteSummary, units: UnitSystem) -> str:
    if summary.n_panels == 0:
        return QCoreApplication.translate(
            "ImportTexts", "No panels yet: find them in photos after the import, or pick a panel grid here."
        )
    listed = ", ".join(f"{facade.id} {facade.n_panels}" for facade in summary.facades[:MAX_LISTED])
    if len(summary.facades) > MAX_LISTED:
        more = QCoreApplication.translate("ImportTexts", "{0} smaller ones")
        listed += ", " + more.format(len(summary.facades) - MAX_LISTED)
    return QCoreApplication.translate("ImportTexts", "Panels: {0}, {1} of glass; by facade: {2}").format(
        summary.n_panels, area_unit(units).text(summary.area_m2), listed
    )
