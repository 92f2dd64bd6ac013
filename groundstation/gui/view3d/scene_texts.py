"""The texts of the 3-D view: labels in the scene, names under the pointer, and what colours mean."""

from __future__ import annotations

from PySide6.QtCore import QObject

from groundstation.gui.theme import SORTIES, colours
from groundstation.gui.view3d.layers import Label, Layer
from groundstation.gui.view3d.plan_scene import PlanScene, ends_of_sorties
from groundstation.gui.view3d.site_scene import HOME, LANDING_LABEL_M, SiteScene
from groundstation.services.document import Item, ItemKind

SORTIE_LABEL_M = 3.0
"""Height of labels above the ends of sorties, which are where home is labelled, too."""


class SceneTexts(QObject):
    """Words things in the user's language."""

    def labels(self, site: SiteScene | None, plan: PlanScene | None, hidden: frozenset[Layer]) -> list[Label]:
        """Labels of home, obstacles, zones, and where sorties start and land, as far as their layers are shown."""
        if Layer.LABELS in hidden:
            return []
        labels: list[Label] = []
        if site is not None:
            x, y, z = site.model.site.home_enu_m
            labels.append(Label(self.tr("Home"), (x, y, z + LANDING_LABEL_M), Layer.HOME, HOME))
            labels.extend(site.labels)
        if plan is not None:
            labels.extend(self._sortie_labels(plan))
        return [label for label in labels if label.layer not in hidden]

    def name(self, item: Item) -> str:
        """What an item is called beside the pointer."""
        match item.kind:
            case ItemKind.BUILDING:
                return self.tr("Building")
            case ItemKind.HOME:
                return self.tr("Home")
            case ItemKind.LEG:
                sortie, _, leg = item.id.partition("/")
                return self.tr("Sortie {0}, leg {1}").format(sortie, leg)
            case ItemKind.PANEL:
                return self.tr("Panel {0}").format(item.id)
            case ItemKind.VIEWPOINT:
                return self.tr("Viewpoint {0}").format(item.id)
            case _:
                return item.id

    def coverage_legend(self) -> list[tuple[str, str]]:
        """Colours of sections and what they mean."""
        look = colours()
        return [
            (look.covered, self.tr("covered; darker: by more views")),
            (look.open, self.tr("open: could be covered")),
            (look.unreachable, self.tr("unreachable")),
            (look.undecided, self.tr("undecided")),
        ]

    def _sortie_labels(self, plan: PlanScene) -> list[Label]:
        labels = []
        for point, starts, landings in ends_of_sorties(plan.paths):
            numbers = starts or landings
            names = ", ".join(map(str, numbers))
            if starts == landings:
                text = self.tr("Start and landing {0}").format(names)
            elif starts and landings:
                text = self.tr("Start {0}, landing {1}").format(names, ", ".join(map(str, landings)))
            else:
                text = (self.tr("Start {0}") if starts else self.tr("Landing {0}")).format(names)
            x, y, z = (float(value) for value in point)
            colour = SORTIES[(numbers[0] - 1) % len(SORTIES)]
            labels.append(Label(text, (x, y, z + SORTIE_LABEL_M), Layer.ROUTES, colour))
        return labels
