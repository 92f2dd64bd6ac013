"""GaussianShader: normals of splats, their light, losses, and a mirror ball of splats that it must learn."""

import math

import pytest
import torch

from reconstruction.light.harmonics import harmonics
from reconstruction.light.shading import reflected_directions
from reconstruction.splats.harmonic_colour import N_HARMONICS
from reconstruction.training.methods.gaussian_shader import (
    GaussianShaderSettings,
    GaussianShaderShading,
    normal_loss,
    residual_loss,
    shading_normals,
    sparsity,
)
from tests.reconstruction.training.methods.synthetic_ball import (
    N_TRAINED,
    N_UNSEEN,
    axes_of,
    nearest,
    psnr,
    psnr_of_harmonics,
    seen,
    trained,
)

SMALL = GaussianShaderSettings(side=8)


def splats(n, dtype=torch.float64, seed=1):
    """diffuse, tint, roughness, residual_sh, normals and omega_o."""
    generator = torch.Generator().manual_seed(seed)
    omega_o, normals, _ = seen(n, seed)
    parts = [torch.rand(n, *shape, generator=generator) for shape in ((3,), (3,), ())]
    parts.append(0.02 * torch.randn(n, N_HARMONICS, 3, generator=generator))
    return [each.to(dtype) for each in (*parts, normals, omega_o)]


def made_with(dtype=torch.float64, seed=0):
    made = GaussianShaderShading(SMALL)
    with torch.no_grad():
        made.environment.texels.copy_(
            torch.randn(made.environment.texels.shape, generator=torch.Generator().manual_seed(seed))
        )
    return made.to(dtype)


def test_light_is_diffuse_tinted_and_residual():
    made = made_with()
    diffuse, tint, roughness, residual_sh, normals, omega_o = splats(30)
    mirrored = made.environment(reflected_directions(omega_o, normals), roughness)
    residual = (harmonics(omega_o)[:, :, None] * residual_sh).sum(dim=1)
    found = made(diffuse, tint, roughness, residual_sh, normals, omega_o)
    assert torch.allclose(found, (diffuse + tint * mirrored + residual).clamp(min=0.0))


def test_light_is_never_negative():
    diffuse, tint, roughness, residual_sh, normals, omega_o = splats(30)
    found = made_with()(diffuse, tint, roughness, residual_sh - 3.0, normals, omega_o)
    assert (found >= 0.0).all()


def test_each_side_of_a_splat_has_its_own_residual():
    axes = torch.tensor([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    residuals = torch.tensor([[[0.1, 0.0, 0.0], [0.0, 0.2, 0.0]]]).repeat(2, 1, 1)
    omega_o = torch.tensor([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    found = shading_normals(axes, residuals, omega_o)
    expected = torch.tensor([[0.1, 0.0, 1.0], [0.0, -0.2, -1.0]])
    assert torch.allclose(found, torch.nn.functional.normalize(expected, dim=-1))
    assert ((found * omega_o).sum(dim=-1) < 0.0).all()


def test_without_residuals_normals_are_the_axes_turned_to_the_camera():
    omega_o, axes, _ = seen(40, 2)
    axes = axes * torch.where(torch.arange(40) % 2 == 0, 1.0, -1.0)[:, None]
    found = shading_normals(axes, torch.zeros(40, 2, 3), omega_o)
    assert torch.allclose(found.abs(), axes.abs(), atol=1e-6)
    assert ((found * omega_o).sum(dim=-1) <= 0.0).all()


def test_a_residual_that_takes_the_axis_away_leaves_the_axis_and_gradients_that_are_numbers():
    axes = torch.tensor([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]], requires_grad=True)
    residuals = torch.tensor([[[0.0, 0.0, -1.0], [0.0, 0.0, -1.0]]]).repeat(2, 1, 1).requires_grad_()
    found = shading_normals(axes, residuals, torch.tensor([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]))
    assert found.tolist() == [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    slopes = torch.autograd.grad(found.sum(), [axes, residuals])
    assert all(each.isfinite().all() for each in slopes)


def test_gradients_are_those_of_finite_differences():
    made, asked = made_with(), [each.requires_grad_() for each in splats(3)]
    assert torch.autograd.gradcheck(made, asked, fast_mode=True)
    residuals = 0.1 * torch.randn(3, 2, 3, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    assert torch.autograd.gradcheck(shading_normals, (asked[4], residuals.requires_grad_(), asked[5].detach()))


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_grazing_rays_and_ends_of_materials_are_numbers_with_numbers_for_gradients(value):
    made = made_with(torch.float32)
    normals = torch.tensor([[0.0, 0.0, 1.0]]).repeat(4, 1).requires_grad_()
    omega_o = torch.tensor([[1.0, 0.0, 0.0], [1.0, 0.0, -1e-7], [0.0, 0.0, -1.0], [0.0, 0.0, 0.0]]).requires_grad_()
    ends = [torch.full((4, *shape), value, requires_grad=True) for shape in ((3,), (3,), ())]
    sh = torch.zeros(4, N_HARMONICS, 3, requires_grad=True)
    light = made(*ends, sh, normals, omega_o)
    slopes = torch.autograd.grad(light.sum(), [*ends, sh, normals, omega_o, made.environment.texels])
    assert all(each.isfinite().all() for each in (light, *slopes))


def test_losses_are_what_their_formulas_say():
    residuals = torch.tensor([[[0.1, 0.0, 0.0], [0.0, 0.2, 0.2]]])
    assert float(residual_loss(residuals)) == pytest.approx((0.01 + 0.08) / 2)
    normals, surface = torch.zeros(2, 2, 3), torch.zeros(2, 2, 3)
    normals[0, 0, 0] = 0.5
    is_known = torch.tensor([[True, False], [False, True]])
    assert float(normal_loss(normals, surface, is_known)) == pytest.approx(0.125)
    assert float(normal_loss(normals, surface, torch.zeros(2, 2, dtype=torch.bool))) == 0.0
    assert float(sparsity(torch.tensor([0.5, 0.9]))) == pytest.approx((math.log(0.25) + math.log(0.09)) / 2)


def test_losses_are_numbers_with_numbers_for_gradients_where_nothing_counts_and_at_the_ends():
    opacities = torch.tensor([0.0, 1.0, 0.5], requires_grad=True)
    assert sparsity(opacities).isfinite()
    assert torch.autograd.grad(sparsity(opacities), opacities)[0].isfinite().all()
    for empty in (sparsity(torch.zeros(0)), residual_loss(torch.zeros(0, 2, 3))):
        assert float(empty) == 0.0


@pytest.mark.slow
def test_a_mirror_ball_of_splats_is_learned_far_beyond_harmonics():
    """Each splat has one set of values; normals are the ball's, off by 9 degrees for each splat its own way."""
    settings = GaussianShaderSettings(side=32)
    made, axes = GaussianShaderShading(settings), axes_of(150)
    generator = torch.Generator().manual_seed(0)
    bent = 0.1 * torch.randn(150, 3, generator=generator)
    learned = {each.name: each.learned(150, generator).requires_grad_() for each in settings.attributes()}

    def light(omega_o, normals, _):
        owner = nearest(normals, axes)
        value = {each.name: each.value(learned[each.name])[owner] for each in settings.attributes()}
        v = torch.nn.functional.normalize(normals + bent[owner], dim=-1)
        turned = shading_normals(v, value["residual_normals"], omega_o)
        return made(value["diffuse"], value["tint"], value["roughness"], value["residual_sh"], turned, omega_o)

    known, unseen = seen(N_TRAINED, 0), seen(N_UNSEEN, 1)
    material = [learned[name] for name in ("diffuse", "tint", "roughness")]
    groups = [(made.parameters(), settings.environment_rate), (material, settings.material_rate),
              ([learned["residual_normals"]], settings.residual_rate), ([learned["residual_sh"]], 0.0025)]  # fmt: skip
    with torch.no_grad():
        before = float((bent + learned["residual_normals"][:, 0]).norm(dim=1).mean())
    trained(light, groups, known, 150)
    with torch.no_grad():
        found = psnr(light(*unseen[:2], None), unseen[2])
        after = float((bent + learned["residual_normals"][:, 0]).norm(dim=1).mean())
    # 31.6 dB was measured, 25.3 dB with harmonics, and normals that are off by 0.076 in place of 0.159.
    assert found > psnr_of_harmonics(known, unseen) + 5.0
    assert after < 0.6 * before
