"""Mesh files (OBJ, PLY, GLB, STL) as buildings: axes, units and far-off coordinates put right."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.mesh import MESH_SUFFIXES, TriangleMesh, empty_mesh
from planning.progress import Monitor
from planning.site_import.options import UNITS_M, ImportOptions
from planning.site_import.placement import place
from planning.site_import.source import SourceModel

Array = NDArray[np.float64]

COARSE_M = 0.01
"""Coordinates stored in steps coarser than this are worth a note."""


def read_mesh_source(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Building from a mesh file; it has no windows, so panels come from the grid the user states.

    Raises
    ------
    InputError
        The file cannot be read or has no triangles, no panel grid is given, or the place is not known.
    """
    if not options.panel_grids:
        raise InputError(
            f"{path}: a mesh does not tell windows from walls; state where the panels are, for example "
            "--panel-grid '0,0,0 36,0,0 0,0,42' --rows 14 --columns 20 (lower left, lower right and upper left corner "
            "of a facade, seen from outside)"
        )
    monitor.report("reading the mesh", 0, 1)
    vertices, triangles = _load(path)
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
    placement = place(None, vertices[used], None, options)
    building = TriangleMesh(placement.enu(vertices), triangles)
    all_notes = (*placement.georeference.notes, *notes)
    return SourceModel("", (), building, empty_mesh(), placement, notes=all_notes)


def _load(path: Path) -> tuple[Array, NDArray[np.int64]]:
    """Vertices, shape (v, 3), in the file's own axes and units, and triangles, shape (t, 3)."""
    import trimesh

    if path.suffix.lower() not in MESH_SUFFIXES:
        raise InputError(f"{path}: expected a mesh file ({', '.join(MESH_SUFFIXES)}), got '{path.suffix}'")
    try:
        loaded = trimesh.load_mesh(path, process=False, maintain_order=True)
        if isinstance(loaded, trimesh.Scene):
            loaded = loaded.to_mesh()
        vertices, triangles = np.asarray(loaded.vertices, np.float64), np.asarray(loaded.faces, np.int64)
    except Exception as error:  # trimesh's readers raise whatever their parsers raise
        raise InputError(f"{path}: this mesh cannot be read ({error})") from error
    if triangles.ndim != 2 or len(triangles) == 0:
        raise InputError(f"{path}: the mesh has no triangles (a point cloud cannot serve as a building)")
    if not np.isfinite(vertices[triangles]).all():
        raise InputError(f"{path}: the mesh has coordinates that are not finite numbers")
    return np.where(np.isfinite(vertices), vertices, 0.0), triangles
