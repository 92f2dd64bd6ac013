"""What the effects of photographs are called."""

from __future__ import annotations

NEAR_FIELD, FRESNEL, SECOND_BOUNCE = "near-field reflection", "Fresnel", "second bounce"
TILT, DOUBLING, SHADOW = "panel tilt", "pane doubling", "shadow"
CURVATURE, INTERIOR, SUN_GLARE, OCCLUSION = "curvature", "interior see-through", "sun glare", "occlusion"
SKY_OCCLUSION = "sky occlusion"
DISTORTION, VIGNETTING, NOISE = "lens distortion", "vignetting", "noise"
MOTION_BLUR, EXPOSURE = "motion blur", "exposure changes"
POSITION_ERROR, GIMBAL_ERROR = "position error", "gimbal error"
EFFECTS = (
    NEAR_FIELD,
    FRESNEL,
    SECOND_BOUNCE,
    TILT,
    CURVATURE,
    DOUBLING,
    SHADOW,
    INTERIOR,
    SUN_GLARE,
    OCCLUSION,
    SKY_OCCLUSION,
    DISTORTION,
    VIGNETTING,
    NOISE,
    MOTION_BLUR,
    EXPOSURE,
    POSITION_ERROR,
    GIMBAL_ERROR,
)
