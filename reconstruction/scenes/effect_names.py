"""What the effects of photographs are called."""

from __future__ import annotations

NEAR_FIELD, FRESNEL, SECOND_BOUNCE = "near-field reflection", "Fresnel", "second bounce"
TILT, DOUBLING, SHADOW = "panel tilt", "pane doubling", "shadow"
DISTORTION, VIGNETTING, NOISE = "lens distortion", "vignetting", "noise"
EFFECTS = (NEAR_FIELD, FRESNEL, SECOND_BOUNCE, TILT, DOUBLING, SHADOW, DISTORTION, VIGNETTING, NOISE)
