"""A scene as USD (.usdc, .usda): Gaussians by facade, its panels as quads, with what is known of them.

z is up and the unit is a metre, as in the site's frame; `/World` moves the model to its place there. Prims are named
after facades and panels as far as USD's names allow; `displayName` has the whole name, and `customData` of a prim has
its GlobalId and attributes. Needs the package usd-core.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import real_path
from planning.base.json_file import check_output, part_folder
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.exports.component_parts import check_scene, ellipsoid_blocks, extents_m
from reconstruction.exports.compression import whole_file
from reconstruction.exports.glb import (
    N_OF_DEGREE,
    NO_ATTRIBUTES,
    Attributes,
    PanelTable,
    attributes_of,
    identifier,
    one_after_the_other,
    panel_table,
    plain,
)
from reconstruction.exports.gltf import INVISIBLE
from reconstruction.objects.gs_scene import GsComponent, GsElement, GsScene

FORMAT = "reflight-usd/1"

MODULES = ("Gf", "Sdf", "Tf", "Usd", "UsdGeom", "UsdVol", "Vt")

ENDINGS = (".usdc", ".usda", ".usd")

WORLD, GAUSSIANS = "/World", "Gaussians"

OURS = "reflight"
"""Dictionary in `customData`."""

SPLATS = "ParticleField3DGaussianSplat"

Array = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class UsdOptions:
    """What a file has.

    Parameters
    ----------
    sh_degree
        Of the colours' harmonics, 0 to 3.
    panel_opacity
        Of the panels' quads, 0 to 1.
    """

    sh_degree: int = 3
    panel_opacity: float = INVISIBLE

    def __post_init__(self) -> None:
        if self.sh_degree not in N_OF_DEGREE:
            raise ValueError(f"sh_degree: expected 0 to 3, got {self.sh_degree}")
        if not 0.0 <= self.panel_opacity <= 1.0:
            raise ValueError(f"panel_opacity: expected 0 to 1, got {self.panel_opacity}")


DEFAULT = UsdOptions()


def write_usd(
    scene: GsScene,
    path: Path,
    options: UsdOptions = DEFAULT,
    attributes: Attributes = NO_ATTRIBUTES,
    monitor: Monitor = QUIET,
) -> None:
    """Write a scene, or what of it is here, whole or not at all: binary, or as text where `path` ends in .usda.

    Raises
    ------
    InputError
        usd-core is missing or too old, the ending is another, numbers are not finite, or it cannot be written.
    """
    if path.suffix.lower() not in ENDINGS:
        raise InputError(say("expected a name that ends in {}, got '{}'", ", ".join(ENDINGS), path.suffix, place=path))
    pxr = _pxr()
    check_scene(scene, path)
    table = panel_table(scene, attributes, path)
    check_output(path)
    try:
        # Gaussians wait in files for all to be written at once: USD would keep them in memory.
        with part_folder(real_path(path).parent, "usd") as waiting:
            stage = _Stage(pxr, scene, table, options, attributes, path, waiting)
            try:
                stage.write(monitor)
            finally:
                stage.close()
    except OSError as error:
        raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error
    except pxr.Tf.ErrorException as error:
        raise InputError(say("cannot be written ({})", error, place=path)) from error


def _pxr() -> Any:
    """OpenUSD's modules, which take a third of a second to import."""
    try:
        pxr = SimpleNamespace(**{name: import_module(f"pxr.{name}") for name in MODULES})
    except ImportError as error:
        raise InputError(
            say("USD needs the package usd-core, which is not installed: pip install 'reflight-groundstation[usd]'")
        ) from error
    if not hasattr(pxr.UsdVol, SPLATS):
        raise InputError(
            say(
                "USD: this usd-core knows no Gaussians; install 26.3 or newer: "
                "pip install 'reflight-groundstation[usd]'"
            )
        )
    return pxr


class _Stage:
    """A file in the making."""

    def __init__(
        self,
        pxr: Any,
        scene: GsScene,
        table: PanelTable,
        options: UsdOptions,
        attributes: Attributes,
        path: Path,
        waiting: Path,
    ) -> None:
        self._pxr, self._vt = pxr, pxr.Vt
        self._scene, self._table, self._options, self._attributes = scene, table, options, attributes
        self._path, self._waiting = path, waiting
        self._stage = pxr.Usd.Stage.CreateInMemory()
        # Files that Gaussians wait in, which have to stay open.
        self._layers: list[Any] = []

    def write(self, monitor: Monitor) -> None:
        """Make the scene and write it."""
        pxr, stage, scene = self._pxr, self._stage, self._scene
        pxr.UsdGeom.SetStageUpAxis(stage, pxr.UsdGeom.Tokens.z)
        pxr.UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        known: dict[str, Any] = {"format": FORMAT, "layer": "scene", "name": scene.name}
        if scene.origin is not None:
            known["origin_wgs84"] = asdict(scene.origin)
        world = self._prim(WORLD, "Xform", scene.name, "assembly", known | self._known(scene.global_id))
        pxr.UsdGeom.Xformable(world).AddTranslateOp().Set(pxr.Gf.Vec3d(*map(float, scene.origin_enu_m)))
        stage.SetDefaultPrim(world)
        names = one_after_the_other(identifier(component.name) for component in scene.components)
        for name, component in zip(names, scene.components, strict=True):
            self._put_component(f"{WORLD}/{name}", component, monitor)
        with whole_file(self._path) as temporary:
            _export(stage, temporary, self._path)

    def close(self) -> None:
        """Let go of the files that Gaussians wait in: of the stage first, or USD would copy them into memory."""
        del self._stage
        self._layers.clear()

    def _put_component(self, place: str, component: GsComponent, monitor: Monitor) -> None:
        known = {"layer": "component", "kind": component.kind, "name": component.name}
        self._prim(place, "Xform", component.name, "component", known | self._known(component.global_id))
        if len(component.gaussians):
            self._put_gaussians(f"{place}/{GAUSSIANS}", component, monitor)
        # Gaussians come first: no panel may take their name.
        names = one_after_the_other((GAUSSIANS, *(identifier(element.name) for element in component.elements)))[1:]
        keys = [column.key for column in self._table.columns]
        for name, element in zip(names, component.elements, strict=True):
            row = dict(zip(keys, self._table.rows[element.global_id], strict=True))
            self._put_panel(f"{place}/{name}", element, row)

    def _put_gaussians(self, place: str, component: GsComponent, monitor: Monitor) -> None:
        """By way of a file of their own."""
        pxr = self._pxr
        stage = pxr.Usd.Stage.CreateInMemory()
        self._fill(stage.DefinePrim(place, SPLATS), component, monitor)
        file = self._waiting / f"{len(self._layers)}.usdc"
        _export(stage, file, self._path)
        self._layers.append(pxr.Sdf.Layer.OpenAsAnonymous(str(file)))
        pxr.Sdf.CopySpec(self._layers[-1], place, self._stage.GetRootLayer(), place)

    def _fill(self, prim: Any, component: GsComponent, monitor: Monitor) -> None:
        n, n_harmonics, vt = len(component.gaussians), N_OF_DEGREE[self._options.sh_degree], self._vt
        positions, scales = np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
        quats, opacities = np.empty((n, 4), np.float32), np.empty(n, np.float32)
        harmonics, panels = np.empty((n, n_harmonics, 3), np.float32), np.empty(n, np.int32)
        lows, highs = [], []
        for start, block in ellipsoid_blocks(component):
            monitor.report(say("writing Gaussians"), start, n)
            rows = slice(start, start + len(block))
            positions[rows], scales[rows], opacities[rows] = block.means_m, block.scales_m, block.opacities
            quats[rows], panels[rows] = block.quats[:, [1, 2, 3, 0]], block.panels
            harmonics[rows] = block.sh[:, :n_harmonics]
            means, extents = block.means_m.astype(np.float64), extents_m(block)
            lows.append((means - extents).min(axis=0))
            highs.append((means + extents).max(axis=0))
        splats = self._pxr.UsdVol.ParticleField3DGaussianSplat(prim)
        splats.CreatePositionsAttr(vt.Vec3fArray.FromNumpy(positions))
        # Numbers of a quaternion lie in memory as x, y, z, w.
        splats.CreateOrientationsAttr(vt.QuatfArray.FromNumpy(quats))
        splats.CreateScalesAttr(vt.Vec3fArray.FromNumpy(scales))
        splats.CreateOpacitiesAttr(vt.FloatArray.FromNumpy(opacities))
        splats.CreateRadianceSphericalHarmonicsDegreeAttr(self._options.sh_degree)
        splats.CreateRadianceSphericalHarmonicsCoefficientsAttr(vt.Vec3fArray.FromNumpy(harmonics.reshape(-1, 3)))
        splats.CreateProjectionModeHintAttr("perspective")
        splats.CreateSortingModeHintAttr("cameraDistance")
        splats.CreateExtentAttr(self._extent(np.min(lows, axis=0), np.max(highs, axis=0)))
        if component.elements:
            self._primvar(prim, "IntArray", "vertex", vt.IntArray.FromNumpy(panels))

    def _put_panel(self, place: str, element: GsElement, row: Mapping[str, Any]) -> None:
        prim = self._prim(place, "Mesh", element.name, "subcomponent", row)
        corners = (np.array(element.corners_enu_m) - np.array(self._scene.origin_enu_m)).astype(np.float32)
        mesh = self._pxr.UsdGeom.Mesh(prim)
        mesh.CreatePointsAttr(self._vt.Vec3fArray.FromNumpy(corners))
        mesh.CreateFaceVertexCountsAttr([4])
        mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
        mesh.CreateSubdivisionSchemeAttr("none")
        mesh.CreateDoubleSidedAttr(True)
        mesh.CreateDisplayColorAttr([(1.0, 1.0, 1.0)])
        mesh.CreateDisplayOpacityAttr([self._options.panel_opacity])
        mesh.CreateExtentAttr(self._extent(corners.min(axis=0), corners.max(axis=0)))
        self._primvar(prim, "Int", "constant", element.panel)

    def _primvar(self, prim: Any, type_name: str, interpolation: str, value: Any) -> None:
        """Which panel a thing is of."""
        kind = getattr(self._pxr.Sdf.ValueTypeNames, type_name)
        self._pxr.UsdGeom.PrimvarsAPI(prim).CreatePrimvar("panel", kind, interpolation).Set(value)

    def _prim(self, place: str, type_name: str, name: str, kind: str, known: Mapping[str, Any]) -> Any:
        prim = self._stage.DefinePrim(place, type_name)
        prim.SetDisplayName(_text(name))
        self._pxr.Usd.ModelAPI(prim).SetKind(kind)
        prim.SetCustomData({OURS: _values(known)})
        return prim

    def _known(self, global_id: str) -> dict[str, Any]:
        """GlobalId and attributes of an object, under names that USD can have."""
        found = attributes_of(global_id, self._attributes, self._path)
        keys = one_after_the_other(identifier(name) for name in found)
        return {"global_id": global_id, "attributes": dict(zip(keys, found.values(), strict=True))}

    def _extent(self, low: NDArray[np.floating], high: NDArray[np.floating]) -> Any:
        return self._vt.Vec3fArray.FromNumpy(np.array([low, high], np.float32))


def _export(stage: Any, file: Path, path: Path) -> None:
    if not stage.GetRootLayer().Export(str(file)):
        raise InputError(say("cannot be written; is the disk full?", place=path))


def _values(values: Mapping[str, Any]) -> dict[str, Any]:
    """What USD can hold of values."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            found[key] = _values(value)
        elif isinstance(value, int) and not -(2**63) <= value < 2**63:
            found[key] = str(value)
        elif value is not None:
            found[key] = _text(value) if isinstance(value, str) else value
    return found


def _text(text: str) -> str:
    """What USD can hold of a text: there it ends at NUL."""
    return plain(text).replace("\0", "\ufffd")
