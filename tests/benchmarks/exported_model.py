"""Write a scene of objects in one format: `python -m tests.benchmarks.exported_model SCENE FORMAT OUT`.

A process of its own, so that its largest memory is that of the format. Prints processor seconds and bytes as JSON;
nothing but reading the scene where FORMAT is `none`.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

from reconstruction.exports.gltf import GltfOptions, write_gltf
from reconstruction.exports.ply_export import write_ply
from reconstruction.exports.spz import write_spz
from reconstruction.exports.tiles3d import TilesOptions, write_tiles
from reconstruction.exports.usd import write_usd
from reconstruction.exports.web import write_web
from reconstruction.objects.gs_scene import GsScene
from reconstruction.objects.store import StoredScene

WRITERS: dict[str, Callable[[GsScene, Path], object]] = {
    "ply": lambda scene, out: write_ply(scene, out.with_suffix(".ply")),
    "SPZ": lambda scene, out: write_spz(scene, out.with_suffix(".spz")),
    "SPZ 4": lambda scene, out: write_spz(scene, out.with_suffix(".spz"), version=4),
    "web": write_web,
    "glTF, numbers": lambda scene, out: write_gltf(scene, out.with_suffix(".glb")),
    "glTF, SPZ": lambda scene, out: write_gltf(scene, out.with_suffix(".glb"), GltfOptions(gaussians="spz")),
    "3D Tiles, SPZ": write_tiles,
    "3D Tiles, SPZ, finest tiles alone": lambda scene, out: write_tiles(scene, out, TilesOptions(has_coarser=False)),
    "USD": lambda scene, out: write_usd(scene, out.with_suffix(".usdc")),
}


def measured(folder: Path, kind: str, out: Path) -> dict[str, float]:
    """Of writing alone: processor seconds, and bytes of all that was written into `out`'s empty folder."""
    scene = StoredScene(folder).read()
    started = time.process_time()
    if kind in WRITERS:
        WRITERS[kind](scene, out)
    seconds = time.process_time() - started
    return {"cpu_s": seconds, "bytes": sum(path.stat().st_size for path in out.parent.rglob("*") if path.is_file())}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measured(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))))
