"""The shading of compared methods, measured: `python -m tests.reconstruction.training.methods.measure [FOLDER]`.

Errors of rough light against sums over the sphere; mirror balls; and, of a folder of `prepare` or `scene render`, its
glass pixels with known planes, materials on 4 x 4 places of each pane, tilts of panes and vignetting learned. One
thread of torch, seed 0; processor time.
"""

import sys
import time
from pathlib import Path

import numpy as np
import torch

from reconstruction.light.cube_lookup import Levels, averaged, sides_from, solid_angles, texel_directions
from reconstruction.light.cube_map import filters, level_of
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.harmonics import harmonics
from reconstruction.light.photo_set import held_out_names, read_photo_set
from reconstruction.light.shading import (
    display_from_linear,
    incidence_cosines,
    linear_from_display,
    reflected_directions,
    schlick,
    shade,
)
from reconstruction.splats.harmonic_colour import light_of_display
from reconstruction.training.methods.gaussian_shader import (
    GaussianShaderSettings,
    GaussianShaderShading,
    shading_normals,
)
from reconstruction.training.methods.ref_gaussian import RefGaussianSettings, RefGaussianShading
from reconstruction.training.methods.ref_gs import RefGsSettings, RefGsShading
from reconstruction.training.methods.shader import Attribute
from tests.reconstruction.light.test_lobes import ggx_by_half_vectors
from tests.reconstruction.training.methods.synthetic_ball import (
    environment,
    psnr,
    psnr_of_harmonics,
    seen,
    trained,
    unit,
)

SIDE, PLACES, STEPS, BATCH = 64, 4, 400, 4096
COLOUR = Attribute("colour", (16, 3), 0.0)


def say(text):
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def rough_light():
    """Errors of the map's levels, and of averages at whichever level is best, as shares of the light's spread."""
    asked = unit(np.random.default_rng(0).normal(size=(300, 3)))
    towards, kept = torch.from_numpy(asked), filters(SIDE)
    light = torch.from_numpy(environment(texel_directions(SIDE)))
    levels, plain, where = kept.rough(kept.averages(light)), averaged(SIDE, 1)(light), Levels(sides_from(SIDE))
    places = texel_directions(2 * SIDE)
    shown = kept.finest_level.look_up(torch.from_numpy(places), torch.zeros(len(places)).double(), kept.finest(light))
    for roughness in (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0):
        weights = ggx_by_half_vectors(np.clip(asked @ places.T, -1.0, 1.0), roughness) * solid_angles(2 * SIDE)
        truth = weights @ shown.numpy() / weights.sum(axis=1, keepdims=True)

        def share(found, truth=truth):
            return float(np.sqrt(np.mean((found.numpy() - truth) ** 2)) / truth.std(axis=0).mean())

        at = level_of(torch.full((300,), roughness, dtype=torch.float64))
        own = share(kept.rough_levels.look_up(towards, at, levels))
        tried = [torch.full((300,), level).double() for level in np.arange(0.0, 6.01, 0.25)]
        best = min(share(where.look_up(towards, level, plain)) for level in tried)
        say(f"roughness {roughness:.2f}: levels {own:.3f}, averages {best:.3f}")


class Materials(torch.nn.Module):
    """Attributes on a grid of places on each pane, linear in between; one place for all where there are no panes."""

    def __init__(self, attributes, n_panes, generator):
        super().__init__()
        self.attributes = attributes
        n = n_panes * PLACES * PLACES
        learned = {each.name: torch.nn.Parameter(each.learned(n, generator).reshape(n, -1)) for each in attributes}
        self.learned = torch.nn.ParameterDict(learned)

    def forward(self, panels, shares):
        place = shares * (PLACES - 1)
        first = place.floor().clamp(max=PLACES - 2.0)
        a, b = (place - first).unsqueeze(-1).unbind(dim=1)
        here = (panels * PLACES + first[:, 1].long()) * PLACES + first[:, 0].long()
        found = {}
        for each in self.attributes:
            table = self.learned[each.name]
            lower, upper = (torch.lerp(table[here + k], table[here + k + 1], a) for k in (0, PLACES))
            found[each.name] = each.value(torch.lerp(lower, upper, b).reshape(len(panels), *each.shape))
        return found


def contestants(start):
    """Name, module, attributes, light by (values, normals, omega_o), and rates; diffuse colours begin at `start`."""
    generator = torch.Generator().manual_seed(0)
    gaussian, grid, shader = RefGaussianSettings(), RefGsSettings(diffuse=start), GaussianShaderSettings(diffuse=start)
    albedo = (Attribute("albedo", (3,), start, "sigmoid"), *gaussian.attributes()[1:3])
    one, two, three = RefGaussianShading(gaussian), RefGsShading(grid, generator), GaussianShaderShading(shader)
    own_rates = {"colour": 0.005, "reflectivity": 0.01, "f0": 0.01}
    glass = (COLOUR, Attribute("reflectivity", (), 0.8, "sigmoid"), Attribute("f0", (3,), 0.4, "sigmoid"))
    far = EnvironmentMap(128, 0.3)

    def harmonic(value, normals, omega_o):
        return light_of_display(0.5 + (harmonics(omega_o)[:, :, None] * value["colour"]).sum(dim=1))

    def paper(value, normals, omega_o):
        mirrored, fresnel = (
            reflected_directions(omega_o, normals),
            schlick(value["f0"], incidence_cosines(omega_o, normals)),
        )
        own = harmonic(value, normals, omega_o)
        return shade(own, value["reflectivity"][:, None], fresnel, far(mirrored, mirrored))

    def ref_gaussian(value, normals, omega_o):
        found = one(value["albedo"], value["metallic"], value["roughness"], normals, omega_o)
        return found.diffuse + found.specular

    def ref_gs(value, normals, omega_o):
        return value["diffuse"] + two(value["feature"], value["roughness"], normals, omega_o)

    def gaussian_shader(value, normals, omega_o):
        turned = shading_normals(normals, value["residual_normals"], omega_o)
        return three(value["diffuse"], value["tint"], value["roughness"], value["residual_sh"], turned, omega_o)

    return [
        ("harmonics", torch.nn.Module(), (COLOUR,), harmonic, 0.01, {}),
        ("environment map, paper Eqs. 19-21", far, glass, paper, 0.05, own_rates),
        ("Ref-Gaussian", one, albedo, ref_gaussian, gaussian.environment_rate, {}),
        ("Ref-GS", two, grid.attributes(), ref_gs, grid.grid_rate, {}),
        ("GaussianShader", three, shader.attributes(), gaussian_shader, shader.environment_rate,
         {"residual_normals": 0.1 * shader.residual_rate, "residual_sh": 0.0025}),
    ]  # fmt: skip


def facade(folder):
    """PSNR of held-out views' glass pixels."""
    source = read_photo_set(folder)
    held = set(held_out_names([photo.name for photo in source.photos], 0.15, 0))
    parts = [[photo for photo in source.photos if (photo.name in held) == is_held] for is_held in (False, True)]
    known, unseen = (_with_rays(glass_rays(source, photos)) for photos in parts)
    n_panes, start = len(source.panels.corners_enu_m), float(linear_from_display(known["display"]).mean())
    for name, module, attributes, light, rate, own_rates in contestants(start):
        materials = Materials(attributes, n_panes, torch.Generator().manual_seed(0))
        tilts, corner_loss = torch.nn.Parameter(torch.zeros(n_panes, 3)), torch.nn.Parameter(torch.zeros(()))

        def shown(rays, materials=materials, tilts=tilts, corner_loss=corner_loss, light=light):
            turned = rays["normals"] + (tilts - tilts.mean(dim=0))[rays["panels"]]
            value = materials(rays["panels"], rays["shares"])
            found = light(value, torch.nn.functional.normalize(turned, dim=1), rays["omega_o"])
            return display_from_linear(found * rays["gains"] * (1.0 - corner_loss * rays["off_axis"]))

        network = [p for part in ("hidden", "out") if hasattr(module, part) for p in getattr(module, part).parameters()]
        environment = [p for p in module.parameters() if all(p is not each for each in network)]
        groups = [(environment, rate), (network, RefGsSettings().network_rate), ([tilts], 1e-3), ([corner_loss], 2e-3)]
        usual = 0.01 if name == "harmonics" else 0.02
        groups += [([table], own_rates.get(key, usual)) for key, table in materials.learned.items()]
        optimiser = torch.optim.Adam([{"params": list(p), "lr": r, "base": r} for p, r in groups if list(p)])
        generator, begun = torch.Generator().manual_seed(0), time.process_time()
        for step in range(STEPS):
            for group in optimiser.param_groups:
                group["lr"] = group["base"] * 0.1 ** (step / STEPS)
            chosen = torch.randint(len(known["display"]), (BATCH,), generator=generator)
            rays = {key: each[chosen] for key, each in known.items()}
            optimiser.zero_grad()
            (shown(rays) - rays["display"]).abs().mean().backward()
            optimiser.step()
        spent = time.process_time() - begun
        with torch.no_grad():
            error = (shown(unseen).clamp(0.0, 1.0) - unseen["display"]).square().mean()
        say(f"{folder.name}, {name}: {-10.0 * float(torch.log10(error)):.1f} dB, {spent:.0f} s")


def _with_rays(rays):
    hits = rays.hits()
    return {
        "omega_o": hits.directions.float(), "normals": rays.table.normals[rays.panels].float(),
        "panels": rays.panels.long(), "shares": hits.shares.float().clamp(0.0, 1.0), "display": rays.display,
        "gains": rays.gains[:, None], "off_axis": rays.off_axis[:, None],
    }  # fmt: skip


def ball(is_metal):
    """PSNR of unseen rays, of one material."""
    known, unseen = seen(40_000, 0, is_metal=is_metal), seen(4000, 1, is_metal=is_metal)
    what = "metal ball" if is_metal else "ball with Fresnel"
    say(f"{what}, harmonics: {psnr_of_harmonics(known, unseen):.1f} dB")
    for name, module, attributes, light, rate, own_rates in contestants(0.5)[2:]:
        learned = {each.name: each.learned(1, torch.Generator().manual_seed(0)).requires_grad_() for each in attributes}

        def shown(omega_o, normals, _, attributes=attributes, learned=learned, light=light):
            value = {each.name: each.value(learned[each.name]).expand(len(omega_o), *each.shape) for each in attributes}
            return light(value, normals, omega_o)

        groups = [(module.parameters(), rate)] + [([v], own_rates.get(k, 0.02)) for k, v in learned.items()]
        begun = time.process_time()
        trained(shown, groups, known, 300)
        with torch.no_grad():
            found = psnr(shown(*unseen[:2], None), unseen[2])
        say(f"{what}, {name}: {found:.1f} dB, {time.process_time() - begun:.0f} s")


if __name__ == "__main__":
    torch.set_num_threads(1)
    if len(sys.argv) > 1:
        facade(Path(sys.argv[1]))
    else:
        rough_light()
        for each in (False, True):
            ball(each)
