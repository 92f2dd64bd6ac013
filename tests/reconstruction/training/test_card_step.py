"""Steps on a graphics card against the definition in float64, in values and gradients; by lavapipe where no card is."""

from __future__ import annotations

import copy
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor, nn

from reconstruction.base.out_of_memory import NotFinite
from reconstruction.gpu.device import open_device, why_no_gpu
from reconstruction.light import radiance_grid
from reconstruction.light.config import GlassLearned, HighFrequencyStage
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import GridBox, RadianceGrid
from reconstruction.metrics.image_metrics import WINDOW_PX
from reconstruction.splats import card_splats
from reconstruction.splats.card_splats import PLACES, AdamStep, CardSplats
from reconstruction.splats.densification.mcmc import MarkovChain
from reconstruction.splats.densification.strategy import (
    NO_CHANGES,
    FixedNumber,
    Limits,
    SplatStatistics,
    keep_within,
)
from reconstruction.splats.rasterising import wgpu_backend
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import Splats
from reconstruction.training import trainer
from reconstruction.training.card_step import SLOTS, CardStep, n_values, packed_photo, similarity
from reconstruction.training.config import ANTIALIASED, LossWeights, Rates, TrainConfig
from reconstruction.training.losses import dssim
from reconstruction.training.model.joint_model import SceneModel, photo_of
from reconstruction.training.photos.exposures import Exposures
from reconstruction.training.photos.photo_stream import Sample
from reconstruction.training.photos.poses import PoseCorrections, moved_view
from reconstruction.training.training_state import adam_of, set_rates, take_step
from tests.reconstruction.splats.drawn_splats import (
    level_view,
    random_ellipsoids,
    random_splats,
    relative_error,
    seeded,
    turned_view,
)

ROOT = Path(__file__).parents[3]
GRADIENT_ERROR = 1e-4
LATE, EARLY = 0.6, 0.1
"""Of a training's progress: with all losses, and with the first ones only."""


@pytest.fixture(autouse=True)
def _card() -> None:
    if reason := why_no_gpu():
        pytest.skip(f"no graphics card: {reason}")


class Turning(nn.Module):
    """Light that changes with place and direction, with gradients to both."""

    def __init__(self) -> None:
        super().__init__()
        self.factor = nn.Parameter(torch.tensor(2.0))

    def forward(self, points: Tensor, omega_r: Tensor, panels: Tensor | None = None) -> Tensor:
        return torch.sigmoid(points + self.factor * omega_r)


def made_splats(view: View, *, n: int = 300, solid: bool = False, glass: bool = False) -> Splats:
    made = (random_ellipsoids if solid else random_splats)(n, view, 3)
    panels = torch.full((n,), -1, dtype=torch.int32)
    if glass:
        panels[::2] = 0
    g = seeded(1)
    means, quats, scales, opacities, features = (values.float() for values in made.tensors)
    splats = Splats.of(means, quats, scales, opacities, features[:, :3].sigmoid(), panels)
    with torch.no_grad():
        for name, spread in (("sh", 0.2), ("reflectivity_logits", 1.0), ("f0_logits", 1.0)):
            values = getattr(splats, name)
            values += spread * torch.randn(values.shape, generator=g)
    return splats


def made_grid() -> RadianceGrid:
    """With dense and empty places, as none that was trained is."""
    box = GridBox(0.4, (0.1, 0.8, 0.2), (1.5, 1.1, 1.3), (9, 8, 7), 0.5, 2.0)
    grid = RadianceGrid(box, 0.3, 0, 16).eval()
    g = seeded(8)
    with torch.no_grad():
        grid.cells[..., 0] = 0.35 * torch.randn(grid.cells.shape[:3], generator=g) - 0.2
        grid.cells[:, :, :4, 0] = -0.5
        grid.cells[..., 1:] = 0.2 + 0.8 * torch.rand((*grid.cells.shape[:3], 3), generator=g)
        grid.far.copy_(0.2 + torch.rand(grid.far.shape, generator=g))
    grid.refresh()
    assert 0.05 < (grid.skips > 0).mean() < 0.9
    return grid


def made_model(
    view: View, *, n: int = 300, solid: bool = False, glass: bool = False, light: nn.Module | None = None
) -> SceneModel:
    """Splats before a sky of all colours; with `glass`, a pane over a part of the picture that mirrors."""
    corners = np.zeros((0, 4, 3))
    if glass:
        depth, w, h = 5.0, view.width_px, view.height_px
        x, y = np.array([0.1, 0.8, 0.85, 0.15]) * w, np.array([0.9, 0.8, 0.1, 0.2]) * h
        rays = np.stack([(x - view.cx_px) / view.fx_px, (y - view.cy_px) / view.fy_px, np.ones(4)], axis=1)
        matrix = view.cam_from_world.numpy()
        corners = ((depth * rays - matrix[:3, 3]) @ matrix[:3, :3])[None]
    planes, mirrored = PanelPlanes(corners), None
    if glass:
        mirrored = GlassLight(light or Turning(), planes, GlassLearned(rays=4, tilts=True, bows=True))
        mirrored.common.zero_()
        with torch.no_grad():
            mirrored.tilts += torch.tensor([0.02, -0.01])
            mirrored.bows += torch.tensor([-0.01, 0.03])
    sky = Sky(16)
    with torch.no_grad():
        for level in sky.levels:
            level += torch.randn(level.shape, generator=seeded(2))
    model = SceneModel(made_splats(view, n=n, solid=solid, glass=glass), sky, mirrored, planes, np.zeros(3), 1.5)
    with torch.no_grad():
        model.corner_loss.fill_(0.3)
    return model.train()


def made_sample(view: View, *, glass: bool = False) -> Sample:
    g, shape = seeded(4), (view.height_px, view.width_px)
    display = torch.randint(0, 256, (*shape, 3), generator=g, dtype=torch.uint8)
    display[:, : shape[1] // 4] = 255
    facade, shown = (torch.rand(shape, generator=g) < share for share in (0.5, 0.9))
    normals = nn.functional.normalize(torch.randn(*shape, 3, generator=g), dim=2) if glass else None
    if normals is not None:
        normals[::3] = 0.0
    return Sample(0, view, display, facade, facade.int() - 1, normals, shown, 0, 0)


WEIGHTS = LossWeights(
    high_frequency=(HighFrequencyStage(0.5, 3.0),), high_frequency_from=0.5, white=0.9, normal_prior=0.3
)


def optimiser_of(model: SceneModel) -> torch.optim.Adam:
    poses = PoseCorrections([photo_of(turned_view())], np.zeros(3))
    return adam_of(model, Exposures([1.0]), poses, TrainConfig(), 3.0)


class Found:
    """Gradients of one step, by name, and its loss's terms."""

    def __init__(self, model: SceneModel, gain: Tensor, move: Tensor, terms: dict[str, float]) -> None:
        self.terms = terms
        self.gradients = {"gain": gain.grad, "move": move.grad, "corner": model.corner_loss.grad}
        for number, level in enumerate(model.sky.levels):
            self.gradients[f"sky {number}"] = level.grad
        if model.light is not None:
            self.gradients |= {name: values.grad for name, values in model.light.named_parameters()}
        self.gradients |= {name: getattr(model.splats, name).grad for name in PLACES}
        self.pulls = torch.zeros(0)


def start(dtype: torch.dtype) -> tuple[Tensor, Tensor]:
    gain = torch.tensor([1.3, 0.9, 1.1], dtype=dtype, requires_grad=True)
    return gain, torch.tensor([0.01, -0.02, 0.01, 0.002, -0.003, 0.001], dtype=dtype, requires_grad=True)


def by_definition(
    model: SceneModel, sample: Sample, progress: float, settings: RasterSettings, monkeypatch: pytest.MonkeyPatch
) -> Found:
    exact = copy.deepcopy(model)
    exact.splats.double()
    exact.sky.double()
    exact.corner_loss.data = exact.corner_loss.data.double()
    gain, move = start(torch.float64)
    monkeypatch.setattr(trainer, "display_of", lambda given: given.display.double() / 255.0)
    offsets = torch.zeros(len(exact.splats), 2, dtype=torch.float64, requires_grad=True)
    picture = exact(sample.view, gain, 3, settings=settings, screen_offsets=offsets, move=move)
    seen = replace(sample, view=moved_view(sample.view, move))
    loss, terms = trainer.objective(picture, seen, WEIGHTS, progress, model.light is not None)
    loss.backward()
    found = Found(exact, gain, move, terms)
    found.pulls = offsets.grad
    return found


def by_card(
    model: SceneModel, sample: Sample, progress: float, settings: RasterSettings, marches: bool | None = None
) -> Found:
    own = copy.deepcopy(model)
    optimiser = optimiser_of(own)
    step = CardStep(open_device(), own, optimiser, marches)
    gain, move = start(torch.float32)
    gradients, terms = step.gradients(sample, gain, move, 3, settings, WEIGHTS, progress, None)
    strategy = FixedNumber()
    seen: list[SplatStatistics] = []
    strategy.take_in = seen.append
    step.learn(gradients, Rates(), strategy, Limits(), 0, observed=1.0, jitters=True)
    step.bring(moments=True)
    step.observed_by(strategy)
    beta1 = optimiser.param_groups[0]["betas"][0]
    for name in PLACES:
        parameter = getattr(own.splats, name)
        parameter.grad = optimiser.state[parameter]["exp_avg"] / (1.0 - beta1)
    found = Found(own, gain, move, terms)
    found.pulls = seen[0].pulls
    return found


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("solid", "glass", "progress", "settings"),
    [
        (False, True, LATE, ANTIALIASED),
        (True, False, EARLY, ANTIALIASED),
        (False, False, LATE, RasterSettings()),
        (False, True, EARLY, ANTIALIASED),
    ],
)
def test_a_step_is_the_defined_one_in_losses_and_gradients(
    solid: bool, glass: bool, progress: float, settings: RasterSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    view = turned_view(47, 35, 45.0)
    model, sample = made_model(view, solid=solid, glass=glass), made_sample(view, glass=glass)
    truth = by_definition(model, sample, progress, settings, monkeypatch)
    found = by_card(model, sample, progress, settings)
    assert found.terms.keys() == truth.terms.keys()
    assert len(found.terms) == 1 + (progress == LATE) * (1 + glass) + glass
    for name, value in truth.terms.items():
        assert found.terms[name] == pytest.approx(value, rel=1e-5, abs=1e-7), name
    for name, gradient in truth.gradients.items():
        if gradient is None or (name in ("reflectivity_logits", "f0_logits") and not glass):
            continue
        assert float(gradient.norm()) > 0.0, name
        assert relative_error(found.gradients[name], gradient) < GRADIENT_ERROR, name
    pulls = truth.pulls.norm(dim=1) * (view.width_px * view.height_px)
    assert relative_error(found.pulls, pulls) < GRADIENT_ERROR


def test_mirrored_rays_march_through_the_radiance_grid_forward_and_back_as_on_the_processor(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(radiance_grid, "MANY_MOVED", 1 << 30)
    view = turned_view(47, 35, 45.0)
    model, sample = made_model(view, glass=True, light=made_grid()), made_sample(view, glass=True)
    model.light.light.eval()
    # Both have float32: what the processor found, brought to the card, is what the card finds by itself.
    truth, found = (by_card(model, sample, LATE, ANTIALIASED, marches) for marches in (False, True))
    assert found.terms == pytest.approx(truth.terms, rel=1e-4)
    for name, gradient in truth.gradients.items():
        if gradient is not None:
            assert float(gradient.norm()) > 0.0, name
            assert relative_error(found.gradients[name], gradient) < GRADIENT_ERROR, name


@pytest.mark.parametrize("glass", [False, True])
def test_the_picture_of_a_step_can_be_looked_at(glass: bool) -> None:
    view = turned_view(47, 35, 45.0)
    model, sample = made_model(view, glass=glass), made_sample(view, glass=glass)
    gain, move = start(torch.float32)
    picture = model(view, gain, 3, settings=ANTIALIASED, move=move)
    step = CardStep(open_device(), model, optimiser_of(model))
    found, _ = step.gradients(sample, gain, move, 3, ANTIALIASED, WEIGHTS, LATE, None, is_looked_at=True)
    display, depths = found.looked_at
    # Where the photo is left out, too: what is no transient after all is found there.
    assert not sample.shown.all()
    assert relative_error(display, picture.display.detach()) < GRADIENT_ERROR
    of_surfaces = picture.raster.surface_depths_m.detach()
    is_sure = (picture.raster.alphas.detach() - 0.5).abs() > 1e-3
    assert 0 < int(of_surfaces.isinf().sum()) < of_surfaces.numel()
    assert torch.equal(depths.isinf()[is_sure], of_surfaces.isinf()[is_sure])
    both = of_surfaces.isfinite() & depths.isfinite()
    assert relative_error(depths[both], of_surfaces[both]) < GRADIENT_ERROR
    unseen, _ = step.gradients(sample, gain, move, 3, ANTIALIASED, WEIGHTS, LATE, None)
    assert unseen.looked_at is None


STEPS = 12
"""Of which the first two compile."""


def print_kept_kernels() -> None:
    """Take steps from another place, of another seed and of other brightness each; print how many kernels are kept."""
    kept, view = Path(os.environ["MESA_SHADER_CACHE_DIR"]), turned_view(47, 35, 45.0)
    model, sample = made_model(view, glass=True, light=made_grid()), made_sample(view, glass=True)
    card, strategy = CardStep(open_device(), model, optimiser_of(model), marches=True), FixedNumber()
    for number in range(STEPS):
        gain, move = start(torch.float32)
        gain, move = ((1.0 + 0.1 * number) * values.detach() for values in (gain, move))
        found, _ = card.gradients(
            sample, gain, move.requires_grad_(), 3, ANTIALIASED, WEIGHTS, LATE, seeded(number), is_looked_at=True
        )
        card.learn(found, Rates(), strategy, Limits(), number, observed=1.0 + number, jitters=True)
        sys.stdout.write(f"{sum(path.is_file() for path in kept.rglob('*'))}\n")


@pytest.mark.slow
def test_no_kernel_is_compiled_anew_from_step_to_step(tmp_path: Path) -> None:
    if not open_device().adapter.is_software:
        pytest.skip("only Mesa's adapters that are programs show what they compile")
    # What Mesa compiles for a pipeline it keeps, each in a file of its own.
    settings = {"CACHE_DIR": str(tmp_path), "CACHE_DISABLE": "false"}
    environment = os.environ | {f"MESA_SHADER_{name}": value for name, value in settings.items()}
    environment |= {"MESA_DISK_CACHE_SINGLE_FILE": "false", "MESA_DISK_CACHE_DATABASE": "false"}
    command = f"from {__name__} import print_kept_kernels; print_kept_kernels()"
    done = subprocess.run(
        [sys.executable, "-c", command], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    kept = [int(line) for line in done.stdout.split()]
    assert len(kept) == STEPS
    assert kept[1] > 20, "Mesa keeps nothing"
    # A file may be written somewhat late; a kernel that uniforms are compiled into comes once a step.
    assert kept[-1] - kept[1] < (STEPS - 2) // 2, kept


def card_similarity(found: Tensor, photo: Tensor) -> tuple[float, Tensor]:
    """D-SSIM of a picture and a photo, uint8, and its gradient, by the card."""
    device, (height, width) = open_device(), found.shape[:2]
    n, n_bytes = height * width, 8 * (int(SLOTS["SKY"]) + 1)
    table, of_found, sums, truth = device.table(n), device.buffer(16 * n), device.buffer(n_bytes), device.buffer(4 * n)
    device.write_table(table, nn.functional.pad(found, (0, 1)).reshape(n, 4).numpy())
    device.write(truth, packed_photo(replace(made_sample(level_view(width, height)), display=photo)))
    commands = device.commands()
    commands.clear(sums, n_bytes)
    similarity(commands, device, width, height, table, truth, of_found, sums, -1.0)
    raw, gradient = commands.read((sums, n_bytes), (of_found, 16 * n))
    total = raw.view("<i8")[int(SLOTS["SIMILAR"])] / 2.0**32
    by_pixel = torch.from_numpy(gradient.view(np.float32).reshape(height, width, 4)[..., :3].copy())
    return 1.0 - total / n_values(width, height), by_pixel


@given(
    size=st.tuples(st.integers(WINDOW_PX, 40), st.integers(WINDOW_PX, 40)),
    contrast=st.sampled_from([0.0, 1e-3, 0.05, 1.0, 30.0]),
    level=st.integers(0, 255),
    noise=st.sampled_from([0, 1, 60]),
    seed=st.integers(0, 99),
)
def test_similarity_and_its_gradient_are_those_in_float64(
    size: tuple[int, int], contrast: float, level: int, noise: int, seed: int
) -> None:
    g = seeded(seed)
    photo = (level + torch.randint(-noise, noise + 1, (*size, 3), generator=g)).clamp(0, 255).to(torch.uint8)
    found = photo.float() / 255.0 + contrast * torch.randn(*size, 3, generator=g)
    exact = found.double().requires_grad_()
    loss = dssim(exact, photo.double() / 255.0)
    loss.backward()
    truth = loss.item()
    value, gradient = card_similarity(found, photo)
    assert gradient.isfinite().all()
    # Of flat pictures only rounding is left: sums of a million times what is looked for.
    assert value == pytest.approx(truth, rel=1e-4, abs=2e-5)
    apart = float((gradient - exact.grad).norm())
    assert apart < 1e-4 * float(exact.grad.norm()) + 2e-5 / size[0]


def test_a_hundred_steps_of_adam_are_those_of_torch_but_for_rounding() -> None:
    view = turned_view(40, 28)
    model = made_model(view, glass=True, n=200)
    optimiser, config = optimiser_of(model), TrainConfig()
    theirs = copy.deepcopy(model)
    reference = optimiser_of(theirs)
    card = CardSplats(open_device(), model.splats, optimiser, with_glass=True)
    rates = replace(config.rates, colour_details=0.3, glass_geometry=0.4)
    limits = Limits(smallest_m=0.01, largest_m=1.0)
    device, n = card.device, len(model.splats)
    g, before = seeded(6), copy.deepcopy(theirs.splats.state_dict())
    drawn = card.drawing(view, ANTIALIASED, 3)
    places = torch.from_numpy(device.read((drawn.places, 4 * (n + 1)))[0].view(np.int32))
    is_seen = places.diff() > 0
    assert 50 < drawn.drawing.n == int(is_seen.sum()) < n - 10
    weights = device.buffer(4 * drawn.drawing.n)
    for step in range(100):
        set_rates(reference, rates, step, step / 100.0, 0.5)
        # Of splats that no pixel shows, half of all in each step, gradients are 0, and moments go on.
        factor = (is_seen[:, None] & (torch.rand(n, 1, generator=g) < 0.5)) * 10.0 ** torch.randint(
            -8, 1, (n, 1), generator=g
        )
        given_features, given_parameters = (factor * torch.randn(n, k, generator=g) for k in (10, 16))
        totals = torch.cat([given_features, torch.zeros(n, 6), given_parameters], dim=1)[is_seen]
        piece = device.buffer(4 * totals.numel())
        device.write(piece, totals.numpy())
        reference.zero_grad(set_to_none=True)
        features = theirs._features(view, 3)[:, :10]
        others = (theirs.splats.means, theirs.splats.opacities[:, None], theirs.splats.quats, theirs.splats.scales)
        loss = (features * given_features).sum()
        for values, start_at in zip(others, (0, 3, 4, 8), strict=True):
            loss = loss + (values * given_parameters[:, start_at : start_at + values.shape[1]]).sum()
        loss.backward()
        take_step(reference, theirs.splats, rates)
        keep_within(theirs.splats, limits)
        by_name = {group["name"]: group["lr"] for group in reference.param_groups}
        by_name["details"] = by_name["colours"] * rates.colour_details
        by = AdamStep(by_name, rates.glass_geometry, 1.0, 0.0, limits, NO_CHANGES, 0)
        card.learn(drawn, 3, [piece], weights, by)
    card.bring(model.splats, optimiser)
    assert optimiser.state[model.splats.means]["step"] == 100.0
    for name in PLACES:
        mine, other = getattr(model.splats, name), getattr(theirs.splats, name)
        mine, other = mine.detach(), other.detach()
        way = other - before[name]
        assert float(way.norm()) > 0.0, name
        # A step is rounded once in float32, or twice where only a share of it is taken.
        assert float((mine - other).norm()) < 2e-4 * float(way.norm()) + 1e-6 * float(other.norm()), name
        for key in ("exp_avg", "exp_avg_sq"):
            assert (
                relative_error(
                    optimiser.state[getattr(model.splats, name)][key],
                    reference.state[getattr(theirs.splats, name)][key],
                )
                < 1e-4
            ), name
    # What is brought to the card again and back is the same, bit by bit.
    again = CardSplats(open_device(), model.splats, optimiser, with_glass=True)
    kept = copy.deepcopy(model.splats.state_dict())
    again.bring(model.splats, optimiser)
    assert again.n_steps == 100
    assert all(torch.equal(kept[name], values) for name, values in model.splats.state_dict().items())


def test_parts_and_windows_of_cards_with_small_buffers_give_the_same_step(monkeypatch: pytest.MonkeyPatch) -> None:
    view = turned_view(60, 40, 50.0)
    model, sample = made_model(view, glass=True), made_sample(view, glass=True)
    whole = by_card(model, sample, LATE, ANTIALIASED)
    monkeypatch.setattr(open_device(), "most_bytes", 60_000)
    monkeypatch.setattr(wgpu_backend, "MOST_SUMS", 900)
    parted = by_card(model, sample, LATE, ANTIALIASED)
    assert parted.terms == pytest.approx(whole.terms, rel=1e-6)
    for name, gradient in whole.gradients.items():
        if gradient is not None:
            assert relative_error(parted.gradients[name], gradient) < 1e-5, name


def test_the_same_step_has_the_same_bits() -> None:
    view = turned_view(60, 40, 50.0)
    model, sample = made_model(view, glass=True), made_sample(view, glass=True)
    first, again = (by_card(model, sample, LATE, ANTIALIASED) for _ in range(2))
    assert first.terms == again.terms
    for name, gradient in first.gradients.items():
        assert gradient is None or torch.equal(gradient, again.gradients[name]), name


def test_what_is_no_number_is_said_and_nothing_is_learned_from_it() -> None:
    view = turned_view(47, 35, 45.0)
    model, sample = made_model(view), made_sample(view)
    with torch.no_grad():
        model.splats.sh[int(model.splats.opacity_logits.argmax())] = 1e30
    with pytest.raises(NotFinite):
        by_card(model, sample, LATE, ANTIALIASED)


def test_densification_is_told_the_same_and_jitters_as_much_as_on_the_processor() -> None:
    view = turned_view(47, 35, 45.0)
    model = made_model(view, n=2000)
    with torch.no_grad():
        model.splats.opacity_logits[:] = -6.0
    optimiser, strategy = optimiser_of(model), MarkovChain()
    before = model.splats.means.detach().clone()
    sizes = model.splats.scales.detach().clone()
    card = CardStep(open_device(), model, optimiser)
    gain, _ = start(torch.float32)
    found, _ = card.gradients(made_sample(view), gain, None, 3, ANTIALIASED, WEIGHTS, EARLY, None)
    card.learn(found, Rates(), strategy, strategy.limits, 7, observed=1.0, jitters=True)
    card.bring(moments=True)
    card.observed_by(strategy)
    # Rates are 0: what moves is noise, along the splats' axes, of a tenth of their size times the gate.
    moved = (model.splats.means.detach() - before).norm(dim=1)
    gate = torch.sigmoid(100.0 * (0.005 - model.splats.opacities.detach()))
    measured = float((moved.square() / (gate * 0.1).square() / sizes.square().sum(dim=1)).mean())
    assert measured == pytest.approx(1.0, abs=0.15)
    seen = strategy.state_dict()
    raster = model(view, degree=3, settings=ANTIALIASED).raster
    assert torch.equal(seen["views"], (raster.radii_px > 0).float())
    assert len(seen["eyes_m"]) == 1


@pytest.mark.long
def test_moments_of_16_bits_learn_as_well_as_those_of_32(monkeypatch: pytest.MonkeyPatch) -> None:
    view, n_steps = turned_view(60, 40, 50.0), 150
    rates, most_whole = TrainConfig().rates, card_splats.MOST_WHOLE
    lost_db, gained_db = [], []

    def psnr_db(model: SceneModel, shown: Tensor) -> float:
        with torch.no_grad():
            error = model(view, degree=3, settings=ANTIALIASED).display - shown
        return -10.0 * float(error.square().mean().log10())

    for seed in range(3):
        truth = made_model(view, n=400)
        with torch.no_grad():
            shown = truth(view, degree=3, settings=ANTIALIASED).display.clamp(0.0, 1.0)
        sample = made_sample(view)
        ones = torch.ones(shown.shape[:2], dtype=torch.bool)
        sample = replace(sample, display=(255.0 * shown).round().to(torch.uint8), facade=ones, shown=ones)
        found = []
        for most in (most_whole, 0):
            monkeypatch.setattr(card_splats, "MOST_WHOLE", most)
            model, strategy = copy.deepcopy(truth), FixedNumber()
            g = seeded(seed)
            with torch.no_grad():
                for name, spread in (("means", 0.05), ("log_scales", 0.5), ("sh", 0.5), ("opacity_logits", 1.0)):
                    values = getattr(model.splats, name)
                    values += spread * torch.randn(values.shape, generator=g)
            optimiser, before_db = optimiser_of(model), psnr_db(model, shown)
            card = CardStep(open_device(), model, optimiser)
            assert card.splats.is_half == (most == 0)
            for step in range(n_steps):
                set_rates(optimiser, rates, step, step / n_steps, 1.0)
                gradients, _ = card.gradients(
                    sample, torch.ones(()), None, 3, ANTIALIASED, LossWeights(), step / n_steps, None
                )
                card.learn(gradients, rates, strategy, Limits(), step, observed=0.0, jitters=False)
            card.bring(moments=True)
            found.append(psnr_db(model, shown))
        gained_db.append(found[0] - before_db)
        lost_db.append(found[0] - found[1])
    assert min(gained_db) > 2.0, gained_db
    assert sum(lost_db) / 3 < 0.05, lost_db
