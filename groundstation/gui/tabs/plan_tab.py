"""The Plan tab: what is wanted, the running plan, and what came of it; editing by hand and comparing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.plan.plan_page import PlanPage
    from groundstation.gui.shared_view import Stage


def make(workspace: ApplicationContext, stage: Stage) -> PlanPage:
    """The tab."""
    from groundstation.gui.plan.plan_page import PlanPage

    return PlanPage(workspace, stage)


TAB = TabSpec(
    order=20,
    name="plan",
    title=QT_TRANSLATE_NOOP("Tabs", "Plan"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Choose viewpoints and routes"),
    place=Place.AROUND_VIEW,
    make=make,
    implementation="groundstation.gui.plan.plan_page",
)
