"""Mesh files (OBJ, PLY, GLB, STL) as buildings: axes, units and far-off coordinates put right."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from planning.errors import InputError
from planning.mesh import TriangleMesh, empty_mesh
from planning.progress import Monitor
from planning.site_import.ground import stand, stated_ground
from planning.site_import.mesh_parts import read_mesh_parts
from planning.site_import.options import UNITS_M, ImportOptions
from planning.site_import.placement import place
from planning.site_import.source import SourceModel, left_out_notes

MAX_SOURCE_COORDINATE = 1e12
"""A projected coordinate has 1e7 metres, or 1e10 millimetres."""

COARSE_M = 0.01
"""Coordinates stored in steps coarser than this are worth a note."""


def read_mesh_source(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Building from a mesh file; it has no windows, so panels come from the grid the user states, or later.

    Raises
    ------
    InputError
        The file cannot be read or has no triangles, no panel grid is given though panels are
        required, or the place is not known.
    """
    if options.panels_required and not options.panel_grids:
        raise InputError(
            f"{path}: a mesh does not tell windows from walls; state where the panels are, for example "
            "--panel-grid '0,0,0 36,0,0 0,0,42' --rows 14 --columns 20 (lower left, lower right and upper left corner "
            "of a facade, seen from outside), or import the building alone with --without-panels and find them in "
            "photos with 'panels'"
        )
    monitor.report("reading the mesh", 0, 1)
    mesh, left_out = read_mesh_parts(path, MAX_SOURCE_COORDINATE)
    vertices, triangles = mesh.vertices_enu_m, mesh.triangles
    up = options.up or ("y" if path.suffix.lower() == ".glb" else "z")
    if up == "y":
        vertices = np.stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]], axis=-1)
    notes = [f"axes: {up} is up" + (" (glTF's rule)" if up == "y" and options.up is None else "") + " (--up)"]
    unit_m = UNITS_M[options.unit]
    if options.crs is None:
        vertices = vertices * unit_m
        notes.append(f"lengths are in {options.unit} (--units)")
    elif options.unit != "m":
        raise InputError(
            "--units and --crs both say what the coordinates are in; the system of --crs has its own units"
        )
    used = np.unique(triangles)
    step_m = float(np.spacing(np.abs(vertices[used]).max().astype(np.float32)))
    if step_m > COARSE_M and (vertices[used] / unit_m == (vertices[used] / unit_m).astype(np.float32)).all():
        notes.append(
            f"the file stores coordinates this far from zero in steps of {step_m:.2g} m (single precision), so the "
            "building's shape is that rough; export it again with a local offset"
        )
    stands = stand(vertices, triangles, stated_ground(options), lambda points, z: place(None, points, z, options))
    return SourceModel(
        "",
        (),
        TriangleMesh(stands.vertices_enu_m, triangles[stands.is_kept]),
        empty_mesh(),
        stands.placement,
        notes=(*stands.placement.georeference.notes, *notes, *stands.notes, *left_out_notes(left_out)),
        terrain=stands.terrain,
        question=stands.question,
    )
