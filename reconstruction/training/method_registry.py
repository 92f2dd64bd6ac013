"""Methods that a model can be trained with: what each is, where it is from, and what of it we made simpler.

All are written from their papers, on the same rasteriser, start, photos, exposure, sky and densification, so that a
difference between two is one of the methods. All begin on known surfaces (`start_from`) and have antialiased splats
(`raster.antialiased`), as none of the papers has; settings can make them begin and draw as published. This module loads
nothing, for lists on the command line.

Plug-ins add methods: an entry point of the group `reflight.training_methods` stands for a `Method`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, Literal

from planning.base.messages import say
from planning.base.plugins import Plugin, PluginGroup, expect_type, guarded, load_plugins, plugin_problem

Primitive = Literal["discs", "ellipsoids"]
"""What splats are: flat Gaussian discs (2DGS), or Gaussian ellipsoids drawn by EWA splatting (3DGS)."""

DEFAULT_METHOD, PLAIN_METHOD = "reflight", "3dgs"
"""What is trained where nothing else is asked for, with panels and without: on real photos without panels ellipsoids
are mostly ahead of discs (`python -m tests.benchmarks --only real-photos`)."""


@dataclass(frozen=True, slots=True)
class Method:
    """A method.

    Parameters
    ----------
    title
        As its authors call it.
    source
        Authors, year, where it was published.
    what
        How it makes light, in one sentence.
    simplified
        What of it is not as published, and why; "" for nothing.
    settings
        Of `TrainConfig`, as in a TOML file, that make it.
    knows_panels
        Whether it is told which panels there are, learns the light that they mirror alone first, and has the losses
        that the paper adds for glass (Eqs. 23 and 24).
    shader
        Of a plug-in: makes the `methods.shader.Shader` of a training from its `TrainConfig` and `Surroundings`, and
        imports torch only then. None: `make_shader` of the module that has its name in `methods`, or else harmonics.
    """

    title: str
    source: str
    what: str
    simplified: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    knows_panels: bool = False
    primitive: Primitive = "discs"
    shader: Callable[[Any, Any], object] | None = None

    def __post_init__(self) -> None:
        if self.knows_panels and self.shader is not None:
            raise ValueError("shader: expected none of a method that knows panels: those have the light of panels")


PAPER = "Liang et al., RefGlass-GS (the paper), 2026"

AS_PAPER: dict[str, Any] = {
    "light": "mlp",
    "geometry": "splats",
    "overexposed": "off",
    "losses": {"normal_prior": 1.0},
    "rates": {"glass_geometry": 0.1, "light": 0.15},
}
"""Place and normal of what mirrors come from the splats, held by the normal prior; they and light go small steps."""

LIGHT_FIRST = "light is learned alone first, from rays of glass that the refined panels give"


def _ablation(what: str, changes: Mapping[str, Any]) -> Method:
    losses = {**AS_PAPER["losses"], **changes.get("losses", {})}
    settings = {**AS_PAPER, **changes, "losses": losses}
    return Method(
        f"RefGlass-GS {what}", f"{PAPER}, Table 5", say("one of its parts left out"), LIGHT_FIRST, settings, True
    )


METHODS: dict[str, Method] = {
    "reflight": Method(
        "Reflight",
        "this program, docs/concepts/reflections.md",
        say(
            "splats and the light that panels mirror, by the model that the scene calls for: near things are "
            "a scene that mirrored rays march through"
        ),
        settings={
            "light": "auto",
            "geometry": "panels",
            "overexposed": "auto",
            "losses": {"normal_prior": 0.1},
            "rates": {"glass_geometry": 1.0, "light": 0.25},
        },
        knows_panels=True,
    ),
    "refglass-gs": Method(
        "RefGlass-GS",
        f"{PAPER}, 3.3",
        say(
            "splats with reflectivity and base reflectance, and a network that gives mirrored light by place "
            "and direction"
        ),
        LIGHT_FIRST,
        AS_PAPER,
        True,
    ),
    "refglass-gs-environment-map": _ablation("without the Reflection MLP", {"light": "environment-map"}),
    "refglass-gs-no-high-frequency": _ablation("without the high-frequency loss", {"losses": {"high_frequency": []}}),
    "refglass-gs-no-normal-prior": _ablation("without the normal prior", {"losses": {"normal_prior": 0.0}}),
    "3dgs": Method(
        "3DGS",
        "Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance Field Rendering, SIGGRAPH 2023",
        say("ellipsoids whose colour depends on the direction by spherical harmonics"),
        "opacities are not reset",
        {"losses": {"normal_consistency": 0.0}},
        primitive="ellipsoids",
    ),
    "2dgs": Method(
        "2DGS",
        "Huang et al., 2D Gaussian Splatting for Geometrically Accurate Radiance Fields, SIGGRAPH 2024",
        say("flat discs whose colour depends on the direction by spherical harmonics"),
        "no depth distortion term: splats usually begin on known surfaces (`start_from`)",
    ),
    "gaussian-shader": Method(
        "GaussianShader",
        "Jiang et al., GaussianShader: 3D Gaussian Splatting with Shading Functions for Reflective Surfaces, CVPR 2024",
        say(
            "ellipsoids, each shaded for itself: diffuse colour, tint times an environment cube by its "
            "shortest axis and roughness, and harmonics for the rest"
        ),
        "light is blended before it gets its sRGB curve",
        {"losses": {"normal_consistency": 0.0}},
        primitive="ellipsoids",
    ),
    "ref-gaussian": Method(
        "Ref-Gaussian",
        "Yao et al., Reflective Gaussian Splatting, ICLR 2025",
        say(
            "discs with albedo, metallic and roughness, shaded after blending by an environment cube (split "
            "sum), with light from other surfaces where the mirrored ray meets the known mesh"
        ),
        "diffuse light is the albedo; the mesh is the site's and not fused from depths; no stage that shades discs one "
        "by one, no normal propagation",
        {"losses": {"normal_smoothness": 1.0}},
    ),
    "ref-gs": Method(
        "Ref-GS",
        "Zhang et al., Ref-GS: Directional Factorization for 2D Gaussian Splatting, CVPR 2025",
        say(
            "discs with diffuse colour, roughness and features, shaded after blending by a small network "
            "from features of the mirrored direction times those of the place"
        ),
        "the grid of directions is a cube and smaller, the network has 64 hidden units",
    ),
}
"""Of this program, by the name on the command line."""


@cache
def training_methods() -> dict[str, Method]:
    """All methods by the name on the command line: those of this program, then those of plug-ins."""
    return METHODS | load_plugins(PluginGroup.TRAINING_METHODS, _of_plugin, METHODS)


def _of_plugin(plugin: Plugin, found: object) -> Method:
    own = expect_type(found, Method)
    return own if own.shader is None else replace(own, shader=guarded(plugin, own.shader, object))


def method_named(name: str) -> Method:
    """One of `training_methods`.

    Raises
    ------
    ValueError
        There is none of that name; the message lists all, or says why a plug-in was left out.
    """
    if name in METHODS:
        return METHODS[name]
    if name not in training_methods():
        problem = plugin_problem(PluginGroup.TRAINING_METHODS, name)
        expected = say("method: expected {}, got '{}'", ", ".join(training_methods()), name)
        raise ValueError(expected if problem is None else str(problem))
    return training_methods()[name]
