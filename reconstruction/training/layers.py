"""What a rendered view is made of; apart, so that the command line can list it without loading what renders."""

from __future__ import annotations

PICTURE = "picture"

LAYERS = {
    "diffuse": "(1 - R) c and the sky: what is seen without mirroring",
    "reflection": "R F L: what mirroring adds",
    "fresnel": "F: share of the light that glass reflects at this angle",
    "mirrored": "L: the light that glass mirrors, before it does",
    "reflectivity": "R, 0 to 1",
    "alpha": "what splats cover, 0 to 1",
    "normals": "ENU, turned to the camera, 16 bit",
    "depth": "metres along the optical axis, .npy",
    "panels": "number of the panel whose plane mirrors, from 1, 16 bit",
}
