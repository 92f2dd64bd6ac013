"""Gaussians of web pages: packed into words, and what unpacking them the way the page does gives back."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.exports.component_parts import Ellipsoids, ellipsoids_of_all
from reconstruction.exports.web import COLOUR_RANGE, FAINTEST, FLAT, N_AT_ONCE, packed
from tests.reconstruction.objects.synthetic_scene import synthetic_scene


def some(n, seed=0, **changes):
    rng = np.random.default_rng(seed)
    quats = rng.normal(size=(n, 4))
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    quats *= np.where(quats[:, :1] < 0.0, -1.0, 1.0)
    sh = rng.normal(size=(n, 16, 3)) * 0.2
    values = {
        "means_m": rng.uniform(-500.0, 500.0, (n, 3)),
        "quats": quats,
        "scales_m": np.exp(rng.uniform(-7.0, 3.0, (n, 3))),
        "opacities": rng.uniform(0.1, 1.0, n),
        "sh": sh,
    } | changes
    return Ellipsoids(*(np.asarray(value, np.float32) for value in values.values()), np.full(n, -1, np.int32))


def unpacked(words):
    """As the page's shader reads them."""
    halves = np.ascontiguousarray(words[:, 3:7]).view(np.uint16).reshape(len(words), 4, 2)
    low, high = COLOUR_RANGE
    bytes_ = np.ascontiguousarray(words[:, 7]).view(np.uint8).reshape(-1, 4)
    return {
        "means_m": np.ascontiguousarray(words[:, :3]).view(np.float32),
        "quats": halves[:, :2].reshape(-1, 4).view(np.float16).astype(np.float32),
        "scales_m": np.column_stack([halves[:, 2], halves[:, 3, 0]]).view(np.float16).astype(np.float32),
        "panes": halves[:, 3, 1].astype(int) - 1,
        "colours": low + (high - low) * bytes_[:, :3] / 255.0,
        "opacities": bytes_[:, 3] / 255.0,
    }


@given(st.integers(1, 60), st.integers(0, 2**31), st.sampled_from((0, 1, 2, 3)))
def test_unpacked_gaussians_are_those_that_were_packed(n, seed, degree):
    splats = some(n, seed)
    panes = np.random.default_rng(seed).integers(-1, 65_535, n).astype(np.int32)
    result = packed(splats, panes, degree)
    found = unpacked(result.words)
    order = [int(np.flatnonzero((splats.means_m == mean).all(axis=1))[0]) for mean in found["means_m"]]
    assert sorted(order) == list(range(n))
    assert np.array_equal(found["panes"], panes[order])
    np.testing.assert_allclose(found["quats"], splats.quats[order], atol=2.5e-4)
    np.testing.assert_allclose(found["scales_m"], splats.scales_m[order], rtol=6e-4)
    np.testing.assert_allclose(found["opacities"], splats.opacities[order], atol=0.5 / 255 + 1e-6)
    expected = np.clip(0.5 + FLAT * splats.sh[order, 0], *COLOUR_RANGE)
    np.testing.assert_allclose(found["colours"], expected, atol=1.5 / 255 / 2 + 1e-6)
    rest = result.rest * result.rest_steps[:, None]
    wanted = splats.sh[order, 1 : (degree + 1) ** 2]
    assert rest.shape == wanted.shape
    largest = 127.0 * result.rest_steps[:, None] + 1e-6
    np.testing.assert_allclose(
        rest, np.clip(wanted, -largest, largest), atol=0.51 * result.rest_steps.max(initial=1e-9)
    )


def test_the_most_visible_come_first_and_the_faintest_not_at_all():
    sizes = np.full((4, 3), 0.1)
    sizes[2, :2] = 1.0
    splats = some(4, scales_m=sizes, opacities=[0.5, 0.9, 0.5, 0.5 * FAINTEST])
    none = np.full(4, -1, np.int32)
    assert np.array_equal(unpacked(packed(splats, none, 0).words)["means_m"], splats.means_m[[2, 1, 0]])
    assert np.array_equal(unpacked(packed(splats, none, 0, most=1).words)["means_m"], splats.means_m[[2]])


def test_chunks_are_words_then_coefficients():
    n = N_AT_ONCE + 3
    result = packed(some(n), np.full(n, -1, np.int32), 1)
    chunks = list(result.chunks())
    assert [len(chunk) for chunk in chunks] == [N_AT_ONCE * 41, 3 * 41]
    assert np.array_equal(np.frombuffer(chunks[1][: 3 * 32], "<u4").reshape(3, 8), result.words[N_AT_ONCE:])
    assert np.array_equal(np.frombuffer(chunks[1][3 * 32 :], np.int8), result.rest[N_AT_ONCE:].ravel())


def test_no_gaussians_and_huge_ones_are_packed_too():
    assert len(packed(some(0), np.zeros(0, np.int32), 3)) == 0
    assert list(packed(some(0), np.zeros(0, np.int32), 3).chunks()) == []
    huge = packed(some(1, scales_m=[[1e30, 1e-30, 1.0]]), np.array([-1], np.int32), 0)
    np.testing.assert_allclose(unpacked(huge.words)["scales_m"], [[65504.0, 0.0, 1.0]])


def test_scenes_of_discs_keep_their_thickness():
    found = unpacked(packed(ellipsoids_of_all(synthetic_scene().components), np.full(14, -1, np.int32), 0).words)
    np.testing.assert_allclose(found["scales_m"][:, 2], 1e-6, atol=6e-8)
