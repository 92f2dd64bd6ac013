"""What the effects of photographs are called."""

from __future__ import annotations

from planning.base.messages import say

NEAR_FIELD, FRESNEL, SECOND_BOUNCE = say("near-field reflection"), "Fresnel", say("second bounce")
TILT, DOUBLING, SHADOW = say("panel tilt"), say("pane doubling"), "shadow"
CURVATURE, INTERIOR, SUN_GLARE, OCCLUSION = "curvature", say("interior see-through"), say("sun glare"), "occlusion"
SKY_OCCLUSION = say("sky occlusion")
DISTORTION, VIGNETTING, NOISE = say("lens distortion"), "vignetting", "noise"
MOTION_BLUR, EXPOSURE = say("motion blur"), say("exposure changes")
POSITION_ERROR, GIMBAL_ERROR = say("position error"), say("gimbal error")
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
