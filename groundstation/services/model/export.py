"""Use case of exporting a model: a scene of objects, or a trained model, into the formats of other programs.

Plug-ins add formats: an entry point of the group `reflight.model_formats` stands for a `ModelExporter`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from planning.base.errors import InputError
from planning.base.files import check_ending, check_folder_name, read_input_file
from planning.base.messages import say
from planning.base.parameters import Choice, check, parameter
from planning.base.plugins import Plugin, PluginGroup, expect_type, guarded, load_plugins, plugin_problem
from planning.base.progress import QUIET, Monitor, Stop, Trace

if TYPE_CHECKING:
    from reconstruction.exports.compression import Compressed, Compression
    from reconstruction.objects.gs_scene import GsScene
    from reconstruction.training.model.saved import TrainedModel

Preset = Literal["small", "balanced", "fine"]
Gaussians = Literal["numbers", "spz", "points"]

GROUP = "models"

TWO_LAYERS = say("CesiumJS: show gaussians.json and panels.json as two layers")
MIRRORS = say("browsers with WebGPU show panes that mirror as in the model, others these colours")
NO_MIRRORS = say(
    "browsers cannot mirror as this model does, by normals of splats or by a wide network: they show these colours"
)
NO_CESIUM = say(
    "CesiumJS stops at Gaussians that are not compressed: for it, show panels.json alone, or write --gaussians spz"
)


@dataclass(frozen=True, slots=True)
class ModelExport:
    """What is wanted.

    Parameters
    ----------
    components
        Names of those that are wanted; None for all.
    """

    format: str
    baked: bool = parameter(
        True,
        "what panels mirror is baked into their colours, for programs that mirror nothing, or panels have their own",
        label="Colours",
        choices=(Choice(True, "with what panels mirror", "baked"), Choice(False, "panels' own colours", "own")),
        option="--colours",
        group=GROUP,
        row="first",
    )
    degree: int | None = parameter(
        None,
        "of the harmonics by which colours depend on the direction",
        label="Degree of colours",
        choices=tuple(Choice(degree) for degree in range(4)),
        option="--degree",
        metavar="{0,1,2,3}",
        group=GROUP,
        unset="as the format has it",
        row="first",
    )
    preset: Preset = parameter(
        "balanced",
        "of spz, spz-4, sog and Gaussians that are compressed: how small",
        label="File size",
        choices=(Choice("small", "small"), Choice("balanced", "balanced"), Choice("fine", "fine")),
        option="--preset",
        group=GROUP,
        row="first",
    )
    components: tuple[str, ...] | None = None
    gaussians: Gaussians | None = parameter(
        None,
        "of gltf (by itself numbers) and 3d-tiles (by itself spz): as numbers; compressed, as CesiumJS wants them; or "
        "coloured points in their place",
        label="Gaussians",
        choices=(Choice("numbers", "as numbers"), Choice("spz", "compressed"), Choice("points", "as coloured points")),
        option="--gaussians",
        group=GROUP,
        unset="as the format has it",
        row="first",
    )

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, slots=True)
class WrittenModel:
    """What was written, and what its reader should know."""

    path: Path
    n_bytes: int
    notes: tuple[str, ...] = ()


def with_ending(path: Path, kind: str) -> Path:
    """A file's path with the ending of its format, where it has none."""
    endings = model_exporter(kind).endings
    return path if path.suffix or not endings else path.with_name(path.name + endings[0])


def check_name(out: Path, kind: str) -> None:
    """Refuse a name that says that something else is in the file, or that a folder is one.

    Raises
    ------
    InputError
        It does, or the file could not be written.
    """
    endings = model_exporter(kind).endings
    if not endings:
        check_folder_name(out)
        return
    check_ending(out, endings)
    from planning.base.json_file import check_output  # not at the top: the command line describes itself

    check_output(out)


def export_model(folder: Path, out: Path, export: ModelExport, monitor: Monitor = QUIET) -> WrittenModel:
    """Write a model, with the records that lie beside it where the format has a place for them.

    Raises
    ------
    InputError
        The folder holds no model, or a file cannot be read or written.
    """
    check_name(out, export.format)
    if export.format == "ifc":
        return _ifc(folder, out)
    exporter = model_exporter(export.format)
    whole, trained = _read(folder, monitor)
    degree = exporter.degree if export.degree is None else export.degree
    scene, notes = _shown(whole, trained, export, exporter, degree, monitor)
    attributes, rows = _records(folder)
    notes += exporter.write(ModelToExport(scene, trained, folder, out, export, degree, attributes, rows, monitor))
    return WrittenModel(out, _size(out), tuple(notes))


def export_model_in_process(
    folder: Path, out: Path, export: ModelExport, *, stop: Stop, trace: Trace, monitor: Monitor
) -> WrittenModel:
    """`export_model`, as a process beside the window's calls it; it gets no better by and by, so it is not stopped."""
    return export_model(folder, out, export, monitor)


@dataclass(frozen=True, slots=True, eq=False)
class ModelToExport:
    """What a writer is given.

    Parameters
    ----------
    scene
        The components that are wanted, with what panels mirror in their colours where that is wanted.
    trained
        The whole model, with its light.
    folder
        Where the model lies, for what is beside it.
    out
        The file or folder to write.
    degree
        Of the harmonics of colours.
    attributes, rows
        Records of panels: attributes by object, and all records as plain rows.
    """

    scene: GsScene
    trained: TrainedModel
    folder: Path
    out: Path
    wanted: ModelExport
    degree: int
    attributes: Mapping[str, Mapping[str, Any]]
    rows: tuple[Mapping[str, Any], ...]
    monitor: Monitor


def _read(folder: Path, monitor: Monitor) -> tuple[GsScene, TrainedModel]:
    from groundstation.services.model.objects import scene_of
    from reconstruction.objects.organise import put_together

    scene = scene_of(folder, monitor)
    return scene, put_together(scene, folder)


def _shown(
    whole: GsScene, trained: TrainedModel, export: ModelExport, exporter: ModelExporter, degree: int, monitor: Monitor
) -> tuple[GsScene, list[str]]:
    """The components that are wanted, with what panels show in their colours."""
    from reconstruction.exports.mesh import baked, needs_baking
    from reconstruction.training.methods.shader import Shader

    scene, notes = whole, list[str]()
    if export.components is not None:
        known = [component.name for component in whole.components]
        unknown = next((name for name in export.components if name not in known), None)
        if unknown is not None:
            raise InputError(say("--components: there is no component '{}'; known are {}", unknown, ", ".join(known)))
        chosen = tuple(component for component in whole.components if component.name in export.components)
        scene = replace(whole, components=chosen)
    if not exporter.has_colours:
        return scene, notes
    if not needs_baking(trained.model):
        if type(trained.model.shader) is not Shader:
            notes.append(
                say("what this method's shading adds is not in the file: its Gaussians have their own colours only")
            )
    elif export.baked:
        scene = baked(scene, trained.model, degree, monitor)
        notes.append(
            say(
                "mirrored light is in the colours, as harmonics of degree {}: blurred, and it stays on the panes",
                degree,
            )
        )
    else:
        notes.append(say("panels show their own colour only, and mirror nothing"))
    return scene, notes


def _records(folder: Path) -> tuple[dict[str, dict[str, Any]], tuple[Mapping[str, Any], ...]]:
    """Attributes by object, and all records as plain rows; none where there is no book."""
    from groundstation.services.model.facility_records import open_records, plain_records, records_path
    from reconstruction.records.queries import attributes_by_object

    if not records_path(folder).is_file():
        return {}, ()
    with open_records(folder) as book:
        found, attributes = plain_records(book), attributes_by_object(book)
    return attributes, tuple({"global_id": global_id, **row} for global_id, each in found.items() for row in each)


def _ifc(folder: Path, out: Path) -> WrittenModel:
    from groundstation.services.model.facility_records import book_of_scene, export_ifc, user_name

    with book_of_scene(folder, user_name()) as book:
        done = export_ifc(book, out)
    return WrittenModel(out, _size(out), done.notes)


def _web(export: ModelToExport) -> list[str]:
    from contextlib import nullcontext

    from groundstation.services.model.facility_records import open_records, records_path
    from reconstruction.exports.mesh import needs_baking
    from reconstruction.exports.web import WebOptions, sky_light, write_web
    from reconstruction.records.stored_files import DOCUMENT_FILE, stored_path
    from reconstruction.training.model.pane_mirrors import mirrors_of

    mirrors = mirrors_of(export.trained.model) if export.wanted.baked else None
    notes: list[str] = []
    if export.wanted.baked and needs_baking(export.trained.model):
        notes.append(MIRRORS if mirrors is not None else NO_MIRRORS)
    has_records = records_path(export.folder).is_file()
    with open_records(export.folder) if has_records else nullcontext() as book:

        def content_of(name: str) -> bytes | None:
            try:
                return None if book is None else read_input_file(stored_path(book, name), DOCUMENT_FILE)
            except InputError:
                return None

        options = WebOptions(
            degree=export.degree,
            is_baked=export.wanted.baked,
            mirrors=mirrors,
            sky=sky_light(export.trained.model.sky),
            content_of=content_of,
        )
        page = write_web(export.scene, export.out, export.rows, options, export.monitor)
    strays, missing, damaged, large = page.n_strays, page.n_missing, page.n_damaged, page.n_large
    notes_by_count = (
        (strays, say("{} records of objects that the model lacks are left out", strays)),
        (
            missing,
            say(
                "{} files of records are missing or changed: the page says so; copy them back beside the records",
                missing,
            ),
        ),
        (damaged, say("{} pictures of records cannot be read: the page says so; attach them again", damaged)),
        (large, say("{} documents are too large for the page, which names them; pass them on by themselves", large)),
    )
    return notes + [text for n, text in notes_by_count if n]


def _gltf(export: ModelToExport) -> list[str]:
    from reconstruction.exports.gltf import GltfOptions, write_gltf

    gaussians = export.wanted.gaussians or "numbers"
    options = GltfOptions(sh_degree=export.degree, gaussians=gaussians, compression=_compression(export))
    write_gltf(export.scene, export.out, options, export.attributes, export.monitor)
    return []


def _tiles(export: ModelToExport) -> list[str]:
    from reconstruction.exports.tiles3d import TilesOptions, write_tiles

    place: Literal["earth", "local"] = "local" if export.scene.origin is None else "earth"
    gaussians = export.wanted.gaussians or "spz"
    options = TilesOptions(sh_degree=export.degree, place=place, gaussians=gaussians, compression=_compression(export))
    write_tiles(export.scene, export.out, options, export.attributes, export.monitor)
    notes: list[str] = (
        [] if place == "earth" else [say("the place on Earth is not known: tiles stay in the site's own frame")]
    )
    return notes + {"spz": [TWO_LAYERS], "numbers": [NO_CESIUM], "points": []}[gaussians]


def _usd(export: ModelToExport) -> list[str]:
    from reconstruction.exports.usd import UsdOptions, write_usd

    write_usd(export.scene, export.out, UsdOptions(sh_degree=export.degree), export.attributes, export.monitor)
    return []


def _ply(export: ModelToExport, kind: Literal["2dgs", "3dgs"] = "3dgs") -> list[str]:
    from reconstruction.exports.ply_export import write_ply

    done = write_ply(export.scene, export.out, kind, degree=export.degree, monitor=export.monitor)
    return _left_out(done)


def _spz(export: ModelToExport, version: Literal[3, 4] = 3) -> list[str]:
    from reconstruction.exports.spz import write_spz

    compression = _compression(export)
    return _left_out(write_spz(export.scene, export.out, compression, monitor=export.monitor, version=version))


def _sog(export: ModelToExport) -> list[str]:
    from reconstruction.exports.sog import write_sog

    return _left_out(write_sog(export.scene, export.out, _compression(export), monitor=export.monitor))


def _mesh(export: ModelToExport) -> list[str]:
    from reconstruction.exports.mesh import write_mesh

    write_mesh(export.scene, export.trained.model, export.out, attributes=export.attributes, monitor=export.monitor)
    return [say("each panel is a picture of its front: mirror images in it belong to that view alone")]


def _cityjson(export: ModelToExport) -> list[str]:
    from reconstruction.exports.cityjson import write_cityjson

    write_cityjson(export.scene, export.out, export.attributes, export.monitor)
    return []


@dataclass(frozen=True, slots=True)
class ModelExporter:
    """A format that models are written as.

    Parameters
    ----------
    endings
        Of the names of its files, with the dot; the first is proposed. Empty: a folder is written.
    write
        Writes a `ModelToExport`; gives what a reader of the file should know.
    title, about
        What it is called, and in one sentence what it is for. Those of this program are translated in the window.
    splats, panels, attributes
        For the docs: what a reader of the file finds of splats, of panels to pick, and of records.
    has_presets
        Whether a preset decides the size.
    has_parts
        Whether components can be written alone.
    has_colours
        Whether Gaussians, with their colours, are written; otherwise panels alone.
    has_gaussians
        Whether Gaussians can be written in other ways than as numbers.
    degree
        Of the harmonics of colours, where no other is asked for.
    """

    endings: tuple[str, ...]
    write: Callable[[ModelToExport], list[str]]
    title: str = ""
    about: str = ""
    splats: str = ""
    panels: str = ""
    attributes: str = ""
    has_presets: bool = False
    has_parts: bool = True
    has_colours: bool = True
    has_gaussians: bool = False
    degree: int = 3

    def takes(self, name: str, gaussians: Gaussians | None) -> bool:
        """Whether a parameter of `ModelExport` changes what is written, with Gaussians in this way."""
        is_compressed = self.has_gaussians and gaussians == "spz"
        return {
            "baked": self.has_colours,
            "degree": self.has_colours,
            "preset": self.has_presets or is_compressed,
            "components": self.has_parts,
            "gaussians": self.has_gaussians,
        }[name]

    def __post_init__(self) -> None:
        if not all(ending.startswith(".") for ending in self.endings):
            raise ValueError(f"endings: expected such as ('.ply',), got {self.endings}")


def _in_another_way(_export: ModelToExport) -> list[str]:
    raise ValueError("IFC is written from records alone: _ifc")


EXPORTERS: dict[str, ModelExporter] = {
    "web": ModelExporter(
        (),
        _web,
        say("Web page"),
        say("A folder with one page that shows the model and all records in any browser, without a network."),
        "yes",
        "yes",
        "all records",
        degree=2,
    ),
    "gltf": ModelExporter(
        (".glb",),
        _gltf,
        "glTF",
        say("Splats, and panels to pick with their GlobalIds and attributes, in one file."),
        "KHR_gaussian_splatting",
        "quads, EXT_mesh_features",
        "EXT_structural_metadata",
        has_gaussians=True,
    ),
    "3d-tiles": ModelExporter(
        (),
        _tiles,
        "3D Tiles",
        say("A folder with splats and panels in tiles, placed on Earth, as CesiumJS shows them."),
        "the same, compressed",
        "the same",
        "the same",
        has_presets=True,
        has_gaussians=True,
    ),
    "usd": ModelExporter(
        (".usdc", ".usda", ".usd"),
        _usd,
        "USD",
        say("Splats and panels for film and simulation programs."),
        "ParticleField3DGaussianSplat",
        "quads",
        "customData",
    ),
    "ply": ModelExporter(
        (".ply",),
        _ply,
        "PLY",
        say("Splats as ellipsoids: SuperSplat and nearly all viewers open it. Large."),
        "ellipsoids",
        "`panel_id` of each splat",
        "no",
    ),
    "ply-2dgs": ModelExporter(
        (".ply",),
        partial(_ply, kind="2dgs"),
        "PLY (2DGS)",
        say("Splats as flat discs, as they were learned."),
        "discs",
        "`panel_id` of each splat",
        "no",
    ),
    "sog": ModelExporter(
        (".sog",),
        _sog,
        "SOG",
        say("Splats, compressed most: for SuperSplat and PlayCanvas."),
        "compressed",
        "no",
        "no",
        has_presets=True,
    ),
    "spz": ModelExporter(
        (".spz",),
        _spz,
        "SPZ",
        say("Splats, compressed: most viewers of splats open it."),
        "compressed",
        "no",
        "no",
        has_presets=True,
    ),
    "spz-4": ModelExporter(
        (".spz",),
        partial(_spz, version=4),
        "SPZ 4",
        say("The newer version of SPZ: smaller, for the newest programs."),
        "compressed",
        "no",
        "no",
        has_presets=True,
    ),
    "mesh": ModelExporter(
        (".glb",),
        _mesh,
        say("Mesh (glTF)"),
        say("Panels with pictures of their fronts, for programs that know no splats."),
        "pictures of panels",
        "an object each",
        "extras",
        has_colours=False,
    ),
    "cityjson": ModelExporter(
        (".city.json", ".json"),
        _cityjson,
        "CityJSON",
        say("The panels alone, as windows of the building, with their attributes."),
        "no",
        "Window of a WallSurface",
        "yes",
        has_colours=False,
    ),
    "ifc": ModelExporter(
        (".ifc",),
        _in_another_way,
        "IFC",
        say("The panels alone, as plates of curtain walls, with their property sets."),
        "no",
        "IfcPlate of an IfcCurtainWall",
        "property sets",
        has_parts=False,
        has_colours=False,
    ),
}
"""Of this program, by the name on the command line."""


@cache
def model_exporters() -> dict[str, ModelExporter]:
    """All formats by the name on the command line: those of this program, then those of plug-ins."""
    return EXPORTERS | load_plugins(PluginGroup.MODEL_FORMATS, _of_plugin, EXPORTERS)


def _of_plugin(plugin: Plugin, found: object) -> ModelExporter:
    own = expect_type(found, ModelExporter)
    return replace(own, title=own.title or plugin.name, write=guarded(plugin, own.write, list))


def model_exporter(name: str) -> ModelExporter:
    """A format by its name.

    Raises
    ------
    InputError
        There is none; the message lists all, or says why a plug-in was left out.
    """
    if name in EXPORTERS:
        return EXPORTERS[name]
    if name not in model_exporters():
        problem = plugin_problem(PluginGroup.MODEL_FORMATS, name)
        known = ", ".join(model_exporters())
        raise InputError(
            say("there is no model format '{}'; known are: {}", name, known) if problem is None else str(problem)
        )
    return model_exporters()[name]


def _compression(export: ModelToExport) -> Compression:
    from reconstruction.exports.compression import PRESETS

    found = PRESETS[export.wanted.preset]
    return replace(found, degree=export.degree)


def _left_out(done: Compressed) -> list[str]:
    found: list[str] = []
    if done.n_left_out:
        found.append(say("{} Gaussians that nobody sees are left out", done.n_left_out))
    if done.n_resized:
        found.append(
            say("{} Gaussians are larger or smaller than the format has, and have its nearest size", done.n_resized)
        )
    return found


def _size(path: Path) -> int:
    """Bytes of a file, or of all files of a folder."""
    if path.is_file():
        return path.stat().st_size
    return sum(each.stat().st_size for each in path.rglob("*") if each.is_file())
