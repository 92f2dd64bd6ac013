"""A mirroring ball under a made environment far away: rays with known normals, and the light that they should show."""

import math

import numpy as np
import torch

from reconstruction.light.harmonics import harmonics
from reconstruction.light.shading import display_from_linear, incidence_cosines, reflected_directions, schlick

SUN = np.array([0.5, 0.6, 0.62]) / np.linalg.norm([0.5, 0.6, 0.62])
N_TRAINED, N_UNSEEN, BATCH = 16_000, 4000, 2048


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def environment(directions):
    """Linear light of a sky, a dark ground, rows of bright windows and a sun, shape (n, 3)."""
    x, y, z = directions.T
    heading, elevation = np.arctan2(x, y), np.arcsin(np.clip(z, -1.0, 1.0))

    def above(value, blur):
        return 1.0 / (1.0 + np.exp(-value / blur))

    sky = 0.25 + 0.5 * above(z, 0.02) * np.clip(z, 0.0, 1.0) + 0.05 * np.sin(3.0 * heading) * np.sqrt(1.0 - z * z)
    windows = above(np.sin(7.0 * heading) - 0.2, 0.1) * above(np.sin(11.0 * elevation) - 0.2, 0.1)
    windows *= above(0.7 - np.abs(elevation), 0.03)
    sun = 3.0 * np.exp(-((directions - SUN) ** 2).sum(axis=1) / 0.01)
    tinted = sky[:, None] * np.array([0.7, 0.85, 1.0]) + windows[:, None] * np.array([0.35, 0.25, 0.1])
    return tinted + sun[:, None]


def seen(n, seed, f0=0.6, diffuse=0.15, is_metal=False):
    """omega_o, normals and linear light, each shape (n, 3), from all sides; metal mirrors F0 at every angle."""
    generator = np.random.default_rng(seed)
    eye, normals = unit(generator.normal(size=(n, 3))), unit(generator.normal(size=(n, 3)))
    normals = np.where((normals * eye).sum(axis=1, keepdims=True) < 0.0, -normals, normals)
    omega_o, normals = (torch.from_numpy(each.astype(np.float32)) for each in (-eye, normals))
    mirrored = reflected_directions(omega_o, normals)
    light = torch.from_numpy(environment(mirrored.double().numpy()).astype(np.float32))
    share = torch.full((n, 3), f0)
    fresnel = share if is_metal else schlick(share, incidence_cosines(omega_o, normals))
    return omega_o, normals, diffuse + fresnel * light


def psnr(found, truth):
    """Of display values, dB."""
    return psnr_of_display(display_from_linear(found), truth)


def psnr_of_display(found, truth):
    error = (found.clamp(0.0, 1.0) - display_from_linear(truth).clamp(max=1.0)).square().mean()
    return -10.0 * math.log10(float(error))


def trained(shade, groups, data, steps, seed=0, last=0.1):
    """Learn from rays: `groups` are (parameters, rate), `shade` gives light by omega_o and normals."""
    generator = torch.Generator().manual_seed(seed)
    optimiser = torch.optim.Adam([{"params": list(params), "lr": rate, "base": rate} for params, rate in groups])
    omega_o, normals, light = data
    for step in range(steps):
        for group in optimiser.param_groups:
            group["lr"] = group["base"] * last ** (step / steps)
        chosen = torch.randint(len(light), (BATCH,), generator=generator)
        found = shade(omega_o[chosen], normals[chosen], chosen)
        loss = (display_from_linear(found) - display_from_linear(light[chosen])).abs().mean()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()


def nearest(normals, axes):
    """Which of some places on the ball is nearest, shape (n,)."""
    return (normals @ axes.T).argmax(dim=1)


def axes_of(n, seed=5):
    return torch.from_numpy(unit(np.random.default_rng(seed).normal(size=(n, 3))).astype(np.float32))


def psnr_of_harmonics(data, unseen, n_places=150):
    """dB of unseen rays with harmonics of the viewing direction at each of many places: what splats alone can show.

    Least squares in display values; 150 places score best of 50 to 400 with 16 000 rays.
    """
    axes = axes_of(n_places)
    here, there = nearest(data[1], axes), nearest(unseen[1], axes)
    known, asked = harmonics(data[0]).double(), harmonics(unseen[0]).double()
    shown, found = display_from_linear(data[2]).double(), torch.zeros(len(there), 3)
    for place in range(n_places):
        a, b = known[here == place], shown[here == place]
        solved = torch.linalg.solve(a.T @ a + 0.05 * torch.eye(16, dtype=a.dtype), a.T @ b)
        found[there == place] = (asked[there == place] @ solved).float()
    return psnr_of_display(found, unseen[2])
