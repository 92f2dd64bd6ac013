"""Use cases of a model's objects: a trained model becomes a scene of facades and panels, and is found again."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.services.model.facility_records import update_objects
from planning.base.progress import QUIET, Monitor
from planning.site.file import read_site

if TYPE_CHECKING:
    from reconstruction.objects.gs_scene import GsScene

SUFFIX = ".gsscene"
"""Of folders of scenes."""


@dataclass(frozen=True, slots=True)
class Organised:
    """A scene that was written.

    Parameters
    ----------
    n_given_ids
        Panels whose GlobalId is that of a building model.
    empty
        Names of panels without Gaussians.
    """

    folder: Path
    n_components: int
    n_elements: int
    n_gaussians: int
    n_given_ids: int
    empty: tuple[str, ...]

    def summary(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "folder": str(self.folder),
            "components": self.n_components,
            "elements": self.n_elements,
            "gaussians": self.n_gaussians,
            "given_ids": self.n_given_ids,
            "empty": len(self.empty),
            "empty_panels": list(self.empty),
        }


def organise_files(
    model: Path, out: Path, site: Path | None = None, monitor: Monitor = QUIET, who: str = "organise"
) -> Organised:
    """Write a trained model as a scene of objects; records that lie there are told of them.

    Parameters
    ----------
    site
        Site file that tells which object of a building model each panel is; None: what the model knows of that.
    who
        Named in the history of the records.

    Raises
    ------
    InputError
        A file cannot be read or written.
    """
    from reconstruction.objects.organise import PanelGlobalIds, organised
    from reconstruction.objects.store import write_scene
    from reconstruction.training.model.saved import read_model

    trained = read_model(model)
    source_ids = None if site is None else _source_ids(site)
    scene = organised(trained, source_ids)
    write_scene(scene, out, monitor)
    update_objects(out, who)
    elements = [element for _, element in scene.elements]
    return Organised(
        out,
        len(scene.components),
        len(elements),
        scene.n_gaussians,
        len(PanelGlobalIds.of(trained.record, source_ids).source_ids),
        tuple(element.name for element in elements if element.n_gaussians == 0),
    )


def organised_beside(folder: Path, monitor: Monitor = QUIET) -> Path:
    """The folder itself where it holds a scene; else its model is organised into one beside it.

    Raises
    ------
    InputError
        It holds neither, or a file cannot be read or written.
    """
    from reconstruction.objects.store import DESCRIPTION as SCENE
    from reconstruction.training.parameters import MODEL

    model, out = folder / MODEL, folder.with_name(folder.name.removesuffix(".model") + SUFFIX)
    if (folder / SCENE).is_file() or not model.is_file():
        return folder
    is_newer = (out / SCENE).is_file() and (out / SCENE).stat().st_mtime >= model.stat().st_mtime
    return out if is_newer else organise_files(folder, out, None, monitor).folder


def scene_of(folder: Path, monitor: Monitor = QUIET) -> GsScene:
    """The whole scene of a folder, be it one of objects or of a trained model.

    Raises
    ------
    InputError
        It holds neither, or a file is damaged.
    """
    from reconstruction.objects.organise import organised
    from reconstruction.objects.store import DESCRIPTION as SCENE
    from reconstruction.objects.store import read_scene
    from reconstruction.training.model.saved import read_model
    from reconstruction.training.parameters import MODEL

    if not (folder / SCENE).is_file() and (folder / MODEL).is_file():
        return organised(read_model(folder))
    return read_scene(folder, None, monitor)


def _source_ids(site: Path) -> dict[str, str]:
    panels = read_site(site).site.panels
    return {panel.id: panel.source_id for panel in panels if panel.source_id is not None}
