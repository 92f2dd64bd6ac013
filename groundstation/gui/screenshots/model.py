"""Pictures of the Model tab: the model that the Reconstruct tab has trained, with records of its panels."""

from __future__ import annotations

from collections.abc import Callable
from datetime import date, timedelta
from pathlib import Path

from groundstation.gui.model.model_page import ModelPage
from groundstation.gui.window.project_controller import ProjectController
from groundstation.services.model.panel_colours import Computed
from groundstation.services.settings import Language, Theme
from reconstruction.records.entries import Attribute, Defect, Inspection

FIRST_DAY = date(2026, 1, 12)
LEFT_OUT = 7
"""Every so manyth panel has not been inspected yet."""

CHOSEN = 0.55
"""Of the panels, which one is looked at."""

Take = Callable[[str], None]
WaitFor = Callable[[Callable[[], bool]], None]


def model_states(controller: ProjectController, model: Path, take: Take, wait_for: WaitFor) -> None:
    """Drive the Model tab through its states.

    Parameters
    ----------
    model
        Folder of a trained model.
    take
        Saves a picture of the window by a name.
    wait_for
        Returns once a condition holds.
    """

    def page() -> ModelPage:
        tab = controller.window.tab("model")
        assert isinstance(tab, ModelPage)
        return tab

    def rest() -> None:
        wait_for(lambda: page().pane.looks.is_at_rest() and not controller.workspace.jobs())

    controller.window.show_tab("model")
    take("model-empty")
    page().controller.open(model)
    wait_for(lambda: page().controller.card is not None)
    rest()
    take("model-open")
    _write_records(page())
    card = page().controller.card
    assert card is not None
    page().controller.select(card.panels[int(CHOSEN * len(card.panels))].global_id)
    page().side.colour.setCurrentIndex(page().side.colour.findData(str(Computed.INSPECTED)))
    rest()
    take("model-inspections")
    page().side.colour.setCurrentIndex(page().side.colour.findData(str(Computed.DEFECTS)))
    page().pane.front.click()
    rest()
    take("model-panel")
    page().side.colour.setCurrentIndex(0)
    page().pane.home.click()
    page().pane.axis.setCurrentIndex(1)
    rest()
    take("model-section")
    page().pane.axis.setCurrentIndex(0)
    for name, changes in (
        ("dark", {"theme": Theme.DARK}),
        ("sunlight", {"theme": Theme.SUNLIGHT}),
        ("german", {"theme": Theme.LIGHT, "language": Language.GERMAN}),
    ):
        controller.choose(**changes)
        controller.window.show_tab("model")
        page().side.colour.setCurrentIndex(page().side.colour.findData(str(Computed.INSPECTED)))
        rest()
        take(f"{name}-model")
    controller.choose(language=Language.ENGLISH)


def _write_records(page: ModelPage) -> None:
    """Inspections of most panels, and some of all else for the one that is chosen."""
    card = page.controller.card
    assert card is not None
    chosen = int(CHOSEN * len(card.panels))
    entries: list[Inspection | Defect | Attribute] = []
    for number, panel in enumerate(card.panels):
        if number % LEFT_OUT or number == chosen:
            day = FIRST_DAY + timedelta(days=3 * (number % 60))
            entries.append(Inspection(panel.global_id, day.isoformat(), "M. Weber", "photos from the air", "good"))
    global_id = card.panels[chosen].global_id
    entries += [
        Attribute(global_id, "maker", "Glas Nord"),
        Attribute(global_id, "thickness", 8.0, "number", "mm"),
        Attribute(global_id, "installed_on", "2011-09-01", "date"),
        Defect(global_id, "crack", 3, "2026-05-04", 0.2, 0.7, note="from the left edge, 12 cm"),
    ]
    page.controller.put_all(entries)
