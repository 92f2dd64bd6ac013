"""Names of settings and files of trainings; apart, so that they can be listed without loading what trains."""

from __future__ import annotations

from planning.base.messages import say

PRESETS = {
    "10min": say("small photos or a first look"),
    "1h": say("for photos of some hundred pixels' width, or windows of larger ones"),
    "overnight": say("the paper's network and number of steps, as far as they go"),
    "smoke": "a minute; shows that everything works, and nothing else",
}

LIGHTS = ("auto", "harmonics", "environment-map", "mlp", "radiance-grid")

# Files of a training's folder

MODEL, CHECKPOINT = "model.json", "checkpoint.safetensors"
