"""IFC 2x3 and IFC 4 models: windows and glazed plates become panes, all building elements the mesh."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.mesh import empty_mesh, from_corners
from planning.progress import Monitor
from planning.site_import.ground import StatedGround, stand, stated_ground
from planning.site_import.ifc_content import IfcContent
from planning.site_import.ifc_georeference import ifc_georeference
from planning.site_import.ifc_worker import read_in_worker
from planning.site_import.options import ImportOptions
from planning.site_import.placement import place
from planning.site_import.source import HOW_TO_GET_PANELS, SourceModel, SourceWindow
from planning.step_file import check_ends

Array = NDArray[np.float64]


def read_ifc(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Model of the building in an IFC file.

    Raises
    ------
    InputError
        The file is no IFC file, is cut off or broken, the deflection is not positive, or see `ifc_source`.
    """
    check_ends(path)
    if not options.deflection_m > 0.0:
        raise InputError(f"--deflection {options.deflection_m:g}: expected a positive length in metres")
    return ifc_source(path, *read_in_worker(path, options.deflection_m, monitor), options)


def ifc_source(path: Path, content: IfcContent, triangles: Array, options: ImportOptions) -> SourceModel:
    """Model from what was read of an IFC file, see `extract`.

    Raises
    ------
    InputError
        There is no geometry or no glass, or the place is not known.
    """
    if len(triangles) == 0:
        raise InputError(f"{path}: no building element in this file has geometry")
    if options.panels_required and not content.pane_ids and not options.panel_grids:
        raise InputError(f"{path}: there is neither a window nor a glazed plate with geometry; {HOW_TO_GET_PANELS}")
    points = triangles.reshape(-1, 3)
    georeference = ifc_georeference(content, options)
    # Where there is a map conversion, --crs has served to name its map.
    rest = options if georeference is None else replace(options, crs=None)
    # The site's zero is the ground where the building reaches below it: a cellar, foundations.
    ground_z = content.site_z_m
    if ground_z is not None and not points[:, 2].min() < ground_z < points[:, 2].max():
        ground_z = None
    stated = stated_ground(options)
    if stated is None and ground_z is not None:
        stated = StatedGround(
            ground_z, f"ground: z = {ground_z:.2f} of the model, the zero of IfcSite (--ground names another)"
        )
    stands = stand(
        points,
        np.arange(len(points)).reshape(-1, 3),
        stated,
        lambda near, z: place(georeference, near, z, rest, content.north_rad),
    )
    placement = stands.placement
    panes = zip(content.pane_ids, content.outlines, content.thicknesses_m, content.are_oriented, strict=True)
    return SourceModel(
        name=content.name,
        windows=tuple(
            SourceWindow(guid, placement.enu(np.array(ring)), thickness_m, is_oriented)
            for guid, ring, thickness_m, is_oriented in panes
        ),
        building=from_corners(stands.vertices_enu_m.reshape(-1, 3, 3)[stands.is_kept]),
        neighbours=empty_mesh(),
        placement=placement,
        repeats_panes=True,
        notes=(*placement.georeference.notes, *content.notes, *stands.notes),
        terrain=stands.terrain,
        question=stands.question,
    )
