"""Names of settings, layers and files of trainings; apart, so that they can be listed without loading what trains."""

from __future__ import annotations

PRESETS = {
    "10min": "small photos or a first look",
    "1h": "for photos of some hundred pixels' width, or windows of larger ones",
    "overnight": "the paper's network and number of steps, as far as they go",
    "smoke": "a minute; shows that everything works, and nothing else",
}

LIGHTS = ("auto", "harmonics", "environment-map", "mlp", "radiance-grid")

# What a rendered view is made of

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

# Files of a training's folder

MODEL, CHECKPOINT = "model.json", "checkpoint.safetensors"
