import numpy as np
import pytest
import torch

from planning.base.errors import InputError
from reconstruction.splats.splats import FEATURES, SHAPES, Splats, normals_of, splats_from_tensors, splats_to_tensors
from tests.reconstruction.splats.learned_scenes import random_splats

EYE = torch.tensor([0.5, -4.0, 1.0])


def test_values_that_splats_are_made_of_come_back():
    means, quats = torch.rand(5, 3), torch.randn(5, 4)
    scales, opacities = torch.rand(5, 2) + 0.01, torch.linspace(0.1, 0.9, 5)
    panels = torch.tensor([-1, 0, 3, -1, 2])
    splats = Splats.of(means, quats, scales, opacities, torch.rand(5, 3), panels, reflectivity=0.7, f0=0.3)
    assert len(splats) == 5
    assert torch.allclose(splats.scales, scales)
    assert torch.allclose(splats.opacities, opacities)
    assert torch.allclose(splats.f0, torch.full((5, 3), 0.3))
    assert torch.allclose(splats.reflectivity, torch.where(panels >= 0, 0.7, 0.0))


def test_shares_at_their_ends_stay_finite():
    splats = Splats.of(
        torch.zeros(2, 3), torch.ones(2, 4), torch.ones(2, 2), torch.tensor([0.0, 1.0]), torch.zeros(2, 3)
    )
    assert torch.isfinite(splats.opacity_logits).all()


def test_reflectivity_is_not_learned_where_there_is_no_glass():
    splats = random_splats(4)
    splats.panels[:2] = 1
    splats.reflectivity.sum().backward()
    assert (splats.reflectivity_logits.grad[:2] != 0.0).all()
    assert (splats.reflectivity_logits.grad[2:] == 0.0).all()


def test_features_stand_where_their_names_say():
    splats = random_splats(7)
    splats.panels[:] = 2
    features = splats.features(EYE, 2)
    assert features.shape == (7, 11)
    assert torch.equal(features[:, FEATURES["colour"]], splats.colours(EYE, 2))
    assert torch.allclose(features[:, FEATURES["reflectivity"]][:, 0], splats.reflectivity, atol=1e-6)
    assert torch.allclose(features[:, FEATURES["f0"]], splats.f0, atol=1e-6)
    assert torch.allclose(features[:, FEATURES["normal"]], splats.normals(EYE), atol=1e-6)


def test_normals_face_the_camera_and_are_across_both_tangents():
    splats = random_splats(50)
    normals = splats.normals(EYE)
    assert torch.allclose(normals.norm(dim=1), torch.ones(50), atol=1e-6)
    assert ((EYE - splats.means) * normals).sum(dim=1).min() >= 0.0
    opposite = splats.normals(2.0 * splats.means[0] - EYE)
    assert torch.allclose(normals[0], -opposite[0])


def test_the_plane_offset_tells_where_a_ray_meets_the_splat():
    splats = random_splats(20)
    features = splats.features(EYE, 0)
    normals, offsets = features[:, FEATURES["normal"]], features[:, FEATURES["offset"]][:, 0]
    towards = splats.means - EYE + 0.1 * torch.linalg.cross(normals, torch.rand(20, 3))
    rays = towards / towards.norm(dim=1, keepdim=True)
    distances = offsets / (normals * rays).sum(dim=1)
    assert torch.allclose(distances, towards.norm(dim=1), rtol=1e-4)


def test_a_quaternion_of_zero_has_a_normal_and_no_gradient():
    quats = torch.tensor([[0.0, 0.0, 0.0, 0.0], [1e-9, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]], requires_grad=True)
    normals = normals_of(quats)
    normals.sum().backward()
    assert torch.allclose(normals, torch.tensor([0.0, 0.0, 1.0]).repeat(3, 1))
    assert torch.isfinite(quats.grad).all()
    assert (quats.grad[:2] == 0.0).all()


def test_the_length_of_a_quaternion_does_not_matter():
    quats = torch.randn(9, 4, generator=torch.Generator().manual_seed(0))
    assert torch.allclose(normals_of(quats), normals_of(17.0 * quats), atol=1e-6)


def test_light_is_never_negative():
    splats = random_splats(30)
    with torch.no_grad():
        splats.sh.normal_(generator=torch.Generator().manual_seed(1))
    assert splats.colours(EYE, 3).min() == 0.0


def test_stored_splats_are_the_same_bits():
    splats = random_splats(11)
    again = splats_from_tensors(splats_to_tensors(splats), "weights")
    for name in (*SHAPES, "panels"):
        assert torch.equal(getattr(again, name), getattr(splats, name))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"means": None}, "no 'means'"),
        ({"sh": torch.zeros(3, 9, 3)}, r"sh: expected shape \(3, 16, 3\), found \(3, 9, 3\)"),
        ({"quats": torch.zeros(3, 4, dtype=torch.float64)}, "quats: expected float32"),
        ({"means": torch.full((3, 3), np.nan)}, "means: holds numbers that are not finite"),
        ({"panels": torch.full((3,), -2, dtype=torch.int32)}, "panels: expected numbers from -1 on, found -2"),
        ({"means": torch.tensor(1.0)}, "expected shape"),
    ],
)
def test_damaged_tensors_are_refused(change, message):
    tensors = splats_to_tensors(random_splats(3)) | change
    with pytest.raises(InputError, match=f"weights.*{message}"):
        splats_from_tensors({name: value for name, value in tensors.items() if value is not None}, "weights")


def test_parameters_of_another_number_are_a_wrong_call():
    tensors = splats_to_tensors(random_splats(3))
    with pytest.raises(ValueError, match="means: expected shape"):
        Splats(tensors, torch.zeros(4))
