"""What Mitsuba lacks: panes as `optics` describes them, and cameras whose pixels are not square or whose lens bends.

Mitsuba's classes exist per variant; ours are made for a variant when it is first used.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.jit import n_threads
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.record import Glass

# A pixel by a variant of Mitsuba, in a process of its own: `python -m reconstruction.scenes.mitsuba.plugins VARIANT`.
#
# Where LLVM's library lacks an instruction that the processor has, it ends the process that asked for it, which no
# `except` can help.

LONGEST_S = 120.0
"""Loading Mitsuba and compiling takes seconds, on a busy machine more."""


def survives(variant: str) -> bool:
    """Whether a pixel is rendered and the process lives on."""
    known = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-P", "-m", __name__, variant]
    try:
        done = subprocess.run(command, env=known, capture_output=True, timeout=LONGEST_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def render_pixel(mi: Any) -> None:
    """Render a pixel of a plain sky with the variant that is set.

    Raises
    ------
    RuntimeError
        It is not finite, or the variant does not work.
    """
    film = {"type": "hdrfilm", "width": 1, "height": 1}
    scene = {"type": "scene", "sky": {"type": "constant"}, "sensor": {"type": "perspective", "film": film}}
    picture = mi.render(mi.load_dict({**scene, "integrator": {"type": "direct"}}), spp=1)
    if not np.isfinite(np.asarray(picture)).all():
        raise RuntimeError("a pixel of the sky is not finite")


Array = NDArray[np.float64]

VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
"""The first of them that works is used: both cores and vector instructions, or plain C++."""

SHEET = "reflight_sheet"
TINTS = ("red", "green", "blue")

UNDISTORT_STEPS = 20
"""Of the fixed-point iteration that takes Brown's distortion away; lenses of drones need fewer than ten."""

STEPS = 512
"""Of the cosine, in tables of what sheets mirror: between them the error is under 1e-5."""

SMALL = 1e-9
"""Keeps 0 / 0 away where everything is reflected."""


def mitsuba(variant: str | None = None) -> Any:
    """Mitsuba in a variant that works here, with what it lacks; the variant holds for the whole process.

    Raises
    ------
    InputError
        It is not installed, or that variant does not work here.
    """
    try:
        import drjit
        import mitsuba as mi
    except ImportError as error:
        raise InputError(
            say(
                "Mitsuba is not installed; install it (pip install 'reflight-groundstation[mitsuba]'), or use the "
                "embedded renderer"
            )
        ) from error
    name = next(filter(_works, VARIANTS if variant is None else (variant,)), None)
    if name is None:
        wanted = " and ".join(VARIANTS) if variant is None else variant
        raise InputError(say("Mitsuba is installed but does not work here ({}); use the embedded renderer", wanted))
    mi.set_variant(name)
    # Plain C++ calls our plugins, which are Python, from one thread at a time: two waited for each other and took twice
    # as long as one.
    drjit.set_thread_count(1 if name.startswith("scalar") else n_threads())
    return mi


@functools.cache
def _works(variant: str) -> bool:
    """Whether a pixel can be rendered; the variant gets its plugins then."""
    import mitsuba as mi

    if variant.startswith("llvm") and not survives(variant):
        return False
    try:
        mi.set_variant(variant)
        render_pixel(mi)
    except (ImportError, RuntimeError, AttributeError):
        return False
    _register(mi)
    return True


@dataclass(frozen=True, slots=True)
class SheetRole:
    """Which sheet of a pane of glass a surface is.

    Parameters
    ----------
    part
        `front` and `back` of a double pane whose images lie apart, or `whole` pane in one surface.
    fresnel
        Whether light depends on the angle; otherwise it is that at normal incidence.
    """

    glass: Glass
    part: str
    fresnel: bool

    def plugin(self) -> dict[str, Any]:
        """Its description for Mitsuba, which takes numbers and words."""
        description: dict[str, Any] = {"type": SHEET, "part": self.part, "fresnel": self.fresnel}
        glass = asdict(self.glass)
        return description | dict(zip(TINTS, glass.pop("tint"), strict=True)) | glass

    @classmethod
    def of(cls, props: Any) -> SheetRole:
        """Out of that description."""
        numbers = {name: props[name] for name in ("index", "coating", "sheets", "gap_m", "dirt")}
        red, green, blue = (props[name] for name in TINTS)
        return cls(Glass(tint=(red, green, blue), **numbers), props["part"], props["fresnel"])


def sheet_shares(mi: Any, role: SheetRole) -> Array:
    """Shares of light that is mirrored, and that passes, by cosines in equal steps, shape (STEPS + 1, 2, 3).

    The same quantities as in `pane_surfaces.pane_light`, but from Mitsuba's own polarised Fresnel terms.
    """
    glass = role.glass
    cosines = np.linspace(0.0, 1.0, STEPS + 1) if role.fresnel else np.ones(STEPS + 1)
    first, behind, through = _parts(mi, cosines, glass)
    if glass.coating > 0.0:
        first_0, behind_0, _ = _parts(mi, np.ones(1), glass)
        share = np.minimum(glass.coating / (1.0 - first_0 - behind_0), 1.0)
        first, through = first + share * (1.0 - first - behind), through * (1.0 - share)
    if role.part == "whole":
        return np.stack([first + behind, through], axis=1)
    # The front lets pass what comes from the room; the back mirrors as much more or less as comes back from it.
    passing = np.maximum(through, SMALL)
    if role.part == "front":
        return np.stack([first, passing], axis=1)
    return np.stack([behind / passing, np.zeros_like(behind)], axis=1)


def _parts(mi: Any, cosines: Array, glass: Glass) -> tuple[Array, Array, Array]:
    """First, behind and through of an uncoated pane, each shape (n, 3)."""
    terms = [_fresnel_terms(mi, float(cosine), glass.index) for cosine in cosines]
    cosine_inside = np.maximum([[term[2]] for term in terms], SMALL)
    inside = np.array(glass.tint) ** (1.0 / cosine_inside / glass.sheets)
    first, behind, through = (np.zeros((len(cosines), 3)) for _ in range(3))
    for polarisation in (0, 1):
        face = np.array([term[polarisation] for term in terms])[:, None]
        trips = np.maximum(1.0 - (face * inside) ** 2, SMALL)
        back = face + (1.0 - face) ** 2 * face * inside**2 / trips
        on = (1.0 - face) ** 2 * inside / trips
        first += 0.5 * back
        if glass.sheets == 2:
            gap = np.maximum(1.0 - back**2, SMALL)
            behind += 0.5 * on**2 * back / gap
            on = on**2 / gap
        through += 0.5 * on
    return first, behind, through


def _fresnel_terms(mi: Any, cosine: float, index: float) -> tuple[float, float, float]:
    """Mitsuba's reflectance of a face for both polarisations, and the cosine of the angle inside."""
    across, along, cosine_inside, _, _ = mi.fresnel_polarized(mi.Float(cosine), mi.Float(index))
    squares = (number.real * number.real + number.imag * number.imag for number in (across, along))
    a, b, c = (float(np.ravel(value)[0]) for value in (*squares, cosine_inside))
    return a, b, abs(c)


def _register(mi: Any) -> None:
    import drjit as dr

    is_scalar = mi.variant().startswith("scalar")

    class Sheet(mi.BSDF):  # type: ignore[misc]
        """Mirrors light and lets it through without a turn.

        A double pane is two of them: the front one mirrors `first` and lets `through` pass, the back one mirrors, and
        sends the room's light. From behind the front one lets everything pass: what it sends back is in `behind`.
        """

        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            self.role = SheetRole.of(props)
            sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
            self.m_components = [mi.BSDFFlags.DeltaReflection | sides, mi.BSDFFlags.Null | sides]
            self.m_flags = self.m_components[0] | self.m_components[1]
            shares = sheet_shares(mi, self.role)
            self._table = shares.tolist() if is_scalar else mi.Float(shares.ravel().astype(np.float32))

        def _shares(self, cosine: Any) -> tuple[Any, Any]:
            """Of light that is mirrored and that passes; linear between the table's cosines."""
            at = dr.clip(cosine, 0.0, 1.0) * STEPS
            if is_scalar:
                low = min(int(at), STEPS - 1)
                pairs = zip(self._table[low], self._table[low + 1], strict=True)
                share = at - low
                mirrored, passed = (
                    [(1.0 - share) * a + share * b for a, b in zip(*pair, strict=True)] for pair in pairs
                )
                return mi.Color3f(mirrored), mi.Color3f(passed)
            low = dr.minimum(mi.UInt32(at), STEPS - 1)
            share = at - mi.Float(low)
            values = [
                (1.0 - share) * dr.gather(mi.Float, self._table, 6 * low + k)
                + share * dr.gather(mi.Float, self._table, 6 * low + 6 + k)
                for k in range(6)
            ]
            return mi.Color3f(*values[:3]), mi.Color3f(*values[3:])

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            cosine = mi.Frame3f.cos_theta(si.wi)
            mirrored, passed = self._shares(cosine)
            is_behind = cosine <= 0.0
            mirrored = dr.select(is_behind, mi.Color3f(0.0), mirrored)
            passed = dr.select(is_behind, mi.Color3f(1.0), passed)
            chance = dr.mean(mirrored) / dr.maximum(dr.mean(mirrored) + dr.mean(passed), SMALL)
            is_mirrored = sample1 < chance
            out = mi.BSDFSample3f()
            out.wo = dr.select(is_mirrored, mi.reflect(si.wi), -si.wi)
            out.pdf = dr.select(is_mirrored, chance, 1.0 - chance)
            out.eta = 1.0
            kinds = (mi.UInt32(int(mi.BSDFFlags.DeltaReflection)), mi.UInt32(int(mi.BSDFFlags.Null)))
            out.sampled_type = dr.select(is_mirrored, *kinds)
            out.sampled_component = dr.select(is_mirrored, mi.UInt32(0), mi.UInt32(1))
            weight = dr.select(is_mirrored, mirrored, passed) / dr.maximum(out.pdf, SMALL)
            return out, dr.select(active, weight, mi.Color3f(0.0))

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return mi.Color3f(0.0)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return mi.Float(0.0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return mi.Color3f(0.0), mi.Float(0.0)

        def traverse(self, callback: Any) -> None:
            pass

        def to_string(self) -> str:
            return f"Sheet[{self.role}]"

    mi.register_bsdf(SHEET, Sheet)


def lens(mi: Any, photo: PosedPhoto, middle_enu_m: Array, moved_enu_m: Array | None = None) -> Any:
    """The camera of a photo as a sensor of Mitsuba with a film of its size; a box filter of one pixel.

    Parameters
    ----------
    middle_enu_m
        What lies at Mitsuba's origin, shape (3,).
    moved_enu_m
        How far it moves while its shutter is open, shape (3,); its pose is that of the middle.
    """
    import drjit as dr

    inner = photo.intrinsics
    rotation = np.asarray(photo.pose.cam_from_enu, float)
    position = (photo.pose.position_enu_m - middle_enu_m).tolist()
    way = None if moved_enu_m is None or not np.any(moved_enu_m) else np.asarray(moved_enu_m, float).tolist()

    class Lens(mi.Sensor):  # type: ignore[misc]
        """Rays through places in the picture."""

        def sample_ray(self, time: Any, wavelength: Any, place: Any, aperture: Any, active: Any = True) -> Any:
            seen_x = (place.x * inner.width_px - inner.cx_px) / inner.fx_px
            seen_y = (place.y * inner.height_px - inner.cy_px) / inner.fy_px
            x, y = seen_x, seen_y
            if not inner.is_straight:
                k1, k2, p1, p2, k3 = inner.distortion
                for _ in range(UNDISTORT_STEPS):
                    r2 = x * x + y * y
                    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
                    x, y = (
                        (seen_x - 2.0 * p1 * x * y - p2 * (r2 + 2.0 * x * x)) / radial,
                        (seen_y - p1 * (r2 + 2.0 * y * y) - 2.0 * p2 * x * y) / radial,
                    )
            axes = [x * rotation[0, k] + y * rotation[1, k] + rotation[2, k] for k in range(3)]
            origin = mi.Point3f(*position)
            if way is not None:
                origin += (time - 0.5) * mi.Vector3f(*way)
            return mi.Ray3f(origin, dr.normalize(mi.Vector3f(*axes))), mi.Color3f(1.0)

        def sample_ray_differential(
            self, time: Any, wavelength: Any, place: Any, aperture: Any, active: Any = True
        ) -> Any:
            ray, weight = self.sample_ray(time, wavelength, place, aperture, active)
            return mi.RayDifferential3f(ray), weight

        def to_string(self) -> str:
            return f"Lens[{inner}]"

    props = mi.Properties()
    props["film"] = mi.load_dict(
        {
            "type": "hdrfilm",
            "width": inner.width_px,
            "height": inner.height_px,
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        }
    )
    props["shutter_close"] = 0.0 if way is None else 1.0
    props["sampler"] = mi.load_dict({"type": "independent"})
    return Lens(props)


if __name__ == "__main__":
    import mitsuba as mi

    mi.set_variant(sys.argv[1])
    render_pixel(mi)
