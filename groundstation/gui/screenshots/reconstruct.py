"""Pictures of the Reconstruct tab: photos of a bundled scene are rendered, and a model learns from them."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from groundstation.gui.reconstruct.reconstruct_controller import Phase
from groundstation.gui.reconstruct.reconstruct_page import ReconstructPage
from groundstation.gui.window.project_controller import ProjectController
from groundstation.services.reconstruct.choices import TrainChoice
from groundstation.services.settings import Language, Theme
from groundstation.services.units import UnitSystem

N_VIEWS, WIDTH_PX = 24, 192

MINUTES = 5.0
"""Of the training, which is stopped before."""

STEPS, MEASURED = 60, 4
"""Steps, and looks at the quality, after which the model can be seen for what it is."""

Take = Callable[[str], None]
WaitFor = Callable[[Callable[[], bool]], None]


def reconstruct_states(controller: ProjectController, scratch: Path, take: Take, wait_for: WaitFor) -> Path:
    """Drive the Reconstruct tab through its states; returns the folder of the model that was trained.

    Parameters
    ----------
    scratch
        Folder for the photos and models; photos that are there already are taken.
    take
        Saves a picture of the window by a name.
    wait_for
        Returns once a condition holds.
    """
    photos = scratch / "planar.photos"
    if not (photos / "dataset.json").exists():
        _render(photos)
    out = scratch / f"planar-{controller.window.width()}.model"

    def page() -> ReconstructPage:
        tab = controller.window.tab("reconstruct")
        assert isinstance(tab, ReconstructPage)
        return tab

    def rest() -> None:
        wait_for(lambda: page().pane.looks.is_at_rest() and not page().pane.pictures.is_busy())
        wait_for(lambda: not controller.workspace.jobs())

    controller.window.show_tab("reconstruct")
    page().controller.read(photos)
    wait_for(lambda: page().controller.card is not None and page().controller.cuda is not None)
    choice = TrainChoice(minutes=MINUTES)
    page().side.form.setValue(choice)
    page().controller.choose(choice)
    page().controller.choose_out(out)
    rest()
    take("reconstruct-chosen")
    page().side.train.click()
    wait_for(lambda: page().controller.training.stage is not None)
    take("reconstruct-preparing")
    wait_for(lambda: _steps(page()) >= STEPS and len(page().controller.training.quality.y) >= MEASURED)
    page().side.pause.click()
    rest()
    take("reconstruct-training")
    _layers(page(), rest, take)
    _looks(controller, page, rest, take)
    page().side.pause.click()
    page().side.stop.click()
    wait_for(lambda: page().controller.phase is Phase.IDLE)
    page().pane.worst.click()
    page().details.setCurrentIndex(2)
    rest()
    take("reconstruct-done")
    return out


def _render(photos: Path) -> None:
    """Photos of a bundled scene. Rendering is loaded by its name only: it is no part of the window."""
    request = import_module("groundstation.services.scenes.views").SceneRequest
    render = import_module("groundstation.services.scenes.photos").photograph_files
    render(request("planar", n_views=N_VIEWS, width_px=WIDTH_PX), photos)


def _steps(page: ReconstructPage) -> int:
    stepped = page.controller.training.stepped
    return 0 if stepped is None else stepped.step


def _layers(page: ReconstructPage, rest: Callable[[], None], take: Take) -> None:
    """Layers, a way around, and the photo beside the model."""
    for layer in ("reflectivity", "fresnel", "reflection", "mirrored", "normals", "panels", "depth"):
        page.pane.bar.setValue("", layer, "")
        rest()
        take(f"reconstruct-{layer}")
    page.pane.bar.setValue("", "picture", "photo")
    rest()
    take("reconstruct-compare")
    for _ in range(6):
        page.pane.view.orbited.emit(-0.08, 0.02)
    rest()
    take("reconstruct-from-elsewhere")
    page.pane.view.homeAsked.emit()
    rest()


def _looks(
    controller: ProjectController, page: Callable[[], ReconstructPage], rest: Callable[[], None], take: Take
) -> None:
    """The same in other looks and another language."""
    for name, changes in (
        ("dark", {"theme": Theme.DARK}),
        ("sunlight", {"theme": Theme.SUNLIGHT}),
        ("feet", {"theme": Theme.LIGHT, "units": UnitSystem.IMPERIAL}),
        ("german", {"units": UnitSystem.METRIC, "language": Language.GERMAN}),
    ):
        controller.choose(**changes)
        controller.window.show_tab("reconstruct")
        page().pane.bar.setValue("", "depth" if name == "feet" else "picture", "photo")
        rest()
        take(f"{name}-reconstruct")
        page().details.setCurrentIndex(0)
        take(f"{name}-reconstruct-computer")
    controller.choose(language=Language.ENGLISH)
    controller.window.show_tab("reconstruct")
    rest()
