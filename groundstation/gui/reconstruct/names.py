"""What the tab calls layers, terms of the loss, stages and lights."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from reconstruction.training.layers import LAYERS, PICTURE


def layer_names() -> dict[str, str]:
    """Layers by name, in the order in which they are offered; those that are not known here by their own names."""
    translate = QCoreApplication.translate
    known = {
        PICTURE: translate("LayerNames", "Picture"),
        "diffuse": translate("LayerNames", "Diffuse"),
        "reflectivity": translate("LayerNames", "Reflectivity"),
        "fresnel": translate("LayerNames", "Fresnel"),
        "reflection": translate("LayerNames", "Reflection"),
        "mirrored": translate("LayerNames", "Mirrored light"),
        "normals": translate("LayerNames", "Normals"),
        "panels": translate("LayerNames", "Panels"),
        "depth": translate("LayerNames", "Depth"),
        "alpha": translate("LayerNames", "Coverage by splats"),
    }
    return {name: text for name, text in known.items() if name in (PICTURE, *LAYERS)} | {
        name: name for name in LAYERS if name not in known
    }


def term_name(term: str) -> str:
    """A term of the loss."""
    names = {
        "colour": QCoreApplication.translate("LossTerms", "colour"),
        "normal consistency": QCoreApplication.translate("LossTerms", "normals and depth"),
        "normal prior": QCoreApplication.translate("LossTerms", "known normals"),
        "high frequency": QCoreApplication.translate("LossTerms", "worst pixels"),
    }
    return names.get(term, term)


def light_name(light: str) -> str:
    """A model of mirrored light."""
    names = {
        "auto": QCoreApplication.translate("LightNames", "as the scene calls for"),
        "harmonics": QCoreApplication.translate("LightNames", "none apart from the splats (harmonics)"),
        "environment-map": QCoreApplication.translate("LightNames", "far away (environment map)"),
        "mlp": QCoreApplication.translate("LightNames", "network by place and direction (paper)"),
        "radiance-grid": QCoreApplication.translate("LightNames", "near things (radiance grid)"),
    }
    return names.get(light, light)
