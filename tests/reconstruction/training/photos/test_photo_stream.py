"""Photos as a training looks at them: what samples hold, in which order they come, and what they cost in memory."""

import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest
import torch

from planning.base.errors import InputError
from reconstruction.base.cameras import Intrinsics
from reconstruction.light.photo_set import read_photo_set
from reconstruction.training.photos.decoded_photo import DECODING_BYTES_PER_PX
from reconstruction.training.photos.photo_stream import PhotoOrder, PhotoStream, StreamSettings
from tests.reconstruction.light.synthetic_folder import LENS, panel_numbers
from tests.reconstruction.training.synthetic_data_set import write_data_set

ORIGIN = np.array([1.0, -3.0, 2.0])
N = 6
READING = DECODING_BYTES_PER_PX * LENS.width_px * LENS.height_px
HELD = 6 * LENS.width_px * LENS.height_px


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Tests must not change it."""
    made = tmp_path_factory.mktemp("stream") / "photos"
    write_data_set(made, N)
    return made


@pytest.fixture
def own(folder, tmp_path):
    """A copy that may be damaged."""
    return shutil.copytree(folder, tmp_path / "own")


def stream_of(folder, names=None, **settings):
    return PhotoStream(read_photo_set(folder), names, ORIGIN, StreamSettings(**settings))


def generator(seed=0):
    return torch.Generator().manual_seed(seed)


def same(a, b):
    tensors = ("display", "facade", "panels", "normals")
    is_same = all(torch.equal(getattr(a, name), getattr(b, name)) for name in tensors if getattr(a, name) is not None)
    return is_same and (a.number, a.x_px, a.y_px) == (b.number, b.x_px, b.y_px)


def rays_agree(view, photo, pixels):
    """Whether a view looks along the photo's rays at pixels (x, y) of its own."""
    origins, directions = photo.rays(pixels)
    found = view.directions().numpy().reshape(-1, 3)
    return np.allclose(view.position_m.numpy() + ORIGIN, origins[0], atol=1e-5) and np.allclose(
        found, directions, atol=1e-6
    )


def test_a_frame_is_what_the_files_hold(folder):
    source = read_photo_set(folder)
    with stream_of(folder, with_normals=True) as stream:
        frame = stream.frame(2)
    photo = source.photos[2]
    assert frame.number == 2
    assert np.array_equal(frame.display, source.picture(photo))
    assert np.array_equal(frame.panels, source.panel_numbers(photo))
    assert frame.panels.dtype == torch.int32
    mask = cv2.imread(str(folder / "masks" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(frame.facade, mask > 0)
    assert frame.shown is None
    glass = frame.panels.numpy() >= 0
    inner = cv2.erode(glass.astype(np.uint8), np.ones((5, 5))) > 0
    assert np.allclose(frame.normals.numpy()[inner], (0.0, -1.0, 0.0), atol=1e-4)
    y, x = np.mgrid[:30, :40] + 0.5
    assert rays_agree(frame.view, photo, np.column_stack([x.ravel(), y.ravel()]))


def test_windows_are_parts_of_frames_and_their_views_look_there(folder):
    places = set()
    with stream_of(folder, with_normals=True, window_px=17 * 13) as stream:
        draws = generator()
        for _ in range(20):
            window = stream.sample(draws)
            frame = stream.frame(window.number)
            rows, columns = slice(window.y_px, window.y_px + 12), slice(window.x_px, window.x_px + 17)
            for name in ("display", "facade", "panels", "normals"):
                assert torch.equal(getattr(window, name), getattr(frame, name)[rows, columns])
            assert (window.view.width_px, window.view.height_px) == (17, 12)
            y, x = np.mgrid[rows, columns] + 0.5
            assert rays_agree(window.view, stream.photos[window.number], np.column_stack([x.ravel(), y.ravel()]))
            places.add((window.x_px, window.y_px))
        assert len(places) > 15
        stream.window_px = 4 * 3
        assert stream.sample(draws).facade.shape == (3, 4)


def test_where_all_fit_each_is_read_once_and_seen_once_a_round(folder):
    with stream_of(folder) as stream:
        draws = generator()
        assert stream.all_fit
        rounds = [[stream.sample(draws).number for _ in range(N)] for _ in range(5)]
        assert all(sorted(each) == [*range(N)] for each in rounds)
        assert len({tuple(each) for each in rounds}) > 1
        assert stream.n_read == N


@pytest.mark.parametrize("n_held", [1, 2, 3, 5])
def test_memory_stays_within_the_limit_and_photos_are_shared_out_evenly(folder, n_held):
    with stream_of(folder, memory_bytes=READING + n_held * HELD, uses=4) as stream:
        assert not stream.all_fit
        draws, seen = generator(), [0] * N
        for _ in range(4 * 4 * N):
            seen[stream.sample(draws).number] += 1
            assert stream.held_bytes <= n_held * HELD
            assert len({*stream._held, *stream._pending}) <= n_held
        assert sum(seen) == 4 * 4 * N
        assert min(seen) >= 3 * 4
        assert max(seen) <= 5 * 4
        # About once a round.
        assert stream.n_read <= 5 * N + 2
        stream.forget()
        assert stream.held_bytes == 0
        stream.sample(draws)


def test_a_training_that_is_gone_on_with_sees_the_same(folder):
    settings = {"memory_bytes": READING + 2 * HELD, "window_px": 200}
    with stream_of(folder, **settings) as stream, stream_of(folder, **settings) as other:
        draws = generator(3)
        for _ in range(11):
            stream.sample(draws)
        again = torch.Generator()
        again.set_state(draws.get_state())
        other.load_state_dict(stream.state_dict())
        for _ in range(30):
            assert same(stream.sample(draws), other.sample(again))
        with pytest.raises(ValueError, match="other photos"):
            other.load_state_dict({**other.state_dict(), "upcoming": [N]})


def test_a_distorted_photo_becomes_straight(tmp_path):
    bent = replace(LENS, width_px=80, height_px=60, fx_px=60.0, fy_px=60.0, cx_px=40.0, cy_px=30.0)
    bent = replace(bent, distortion=(-0.12, 0.03, 0.002, -0.001, 0.0))
    write_data_set(tmp_path / "bent", 2, bent, 1)
    with stream_of(tmp_path / "bent", with_normals=True) as stream:
        frame = stream.frame(0)
    straight = replace(stream.photos[0], intrinsics=bent.straight())
    y, x = np.mgrid[:60, :80] + 0.5
    assert rays_agree(frame.view, straight, np.column_stack([x.ravel(), y.ravel()]))
    shown = frame.shown.numpy()
    assert 0.5 < shown.mean() < 1.0
    truth = panel_numbers(straight, read_photo_set(tmp_path / "bent").panels.corners_enu_m).astype(int) - 1
    assert (frame.panels.numpy() == truth)[shown].mean() > 0.98
    assert (frame.panels.numpy() == panel_numbers(stream.photos[0], stream._source.panels.corners_enu_m)).mean() < 0.9
    assert not frame.facade.numpy()[~shown].any()
    glass = cv2.erode((truth >= 0).astype(np.uint8), np.ones((3, 3))) > 0
    assert np.allclose(frame.normals.numpy()[glass & shown], (0.0, -1.0, 0.0), atol=1e-4)


def test_smaller_photos_are_means_of_whole_blocks(tmp_path):
    write_data_set(tmp_path / "odd", 1, replace(LENS, width_px=41, height_px=31), 2)
    with stream_of(tmp_path / "odd", with_normals=True, reduce=3) as stream:
        frame = stream.frame(0)
        full = read_photo_set(tmp_path / "odd").picture(stream.photos[0])
        assert stream.sample(generator()).display.shape == (10, 13, 3)
        assert stream.held_bytes == sum(photo.n_bytes for photo in stream._held.values())
    means = full[:30, :39].reshape(10, 3, 13, 3, 3).mean(axis=(1, 3))
    assert np.abs(frame.display.numpy() - means).max() <= 0.5 + 1e-6
    y, x = np.mgrid[:10, :13] * 3 + 1.5
    assert rays_agree(frame.view, stream.photos[0], np.column_stack([x.ravel(), y.ravel()]))
    numbers = stream._source.panel_numbers(stream.photos[0])
    assert np.array_equal(frame.panels, numbers[1:30:3, 1:39:3])


@pytest.mark.parametrize("reduce", [1, 2])
@pytest.mark.parametrize("normal_step", [1, 3])
def test_bytes_are_known_before_a_photo_is_read(tmp_path, reduce, normal_step):
    write_data_set(tmp_path / "set", 1, normal_step=normal_step)
    with stream_of(tmp_path / "set", with_normals=True, reduce=reduce) as stream:
        stream.sample(generator())
        assert stream.held_bytes == stream._held[0].n_bytes


def cut_off(path):
    path.write_bytes(path.read_bytes()[:60])


def one_more_panel(path):
    cv2.imwrite(str(path), np.full((30, 40), 7, np.uint16))


def other_size(path):
    cv2.imwrite(str(path), np.zeros((30, 41), np.uint8))


def of_colours(path):
    cv2.imwrite(str(path), np.zeros((30, 40, 3), np.uint8))


def eight_bit(path):
    cv2.imwrite(str(path), np.zeros((15, 20, 3), np.uint8))


@pytest.mark.parametrize(
    ("file", "damage", "words"),
    [
        ("images/p03.png", cut_off, "damaged"),
        ("masks/p03.png.png", lambda path: path.unlink(), "cannot be read"),
        ("masks/p03.png.png", other_size, "expected 40 x 30 pixels by its camera, got 41 x 30"),
        ("masks/p03.png.png", of_colours, "expected 1 channel"),
        ("panels/p03.png.png", cut_off, "cut off or damaged"),
        ("panels/p03.png.png", one_more_panel, "has panel 7, and dataset.json 6"),
        ("normals/p03.png.png", eight_bit, "of 16 bit"),
    ],
)
def test_a_damaged_file_is_named(own, file, damage, words):
    damage(own / file)
    with stream_of(own, with_normals=True) as stream:
        draws = generator()
        with pytest.raises(InputError, match=words) as caught:
            [stream.sample(draws) for _ in range(N)]
        assert str(own / file) in str(caught.value)


def test_impossible_wishes_are_refused(folder):
    with pytest.raises(InputError, match="take 0 MiB each while they are read, more than the limit"):
        stream_of(folder, memory_bytes=READING)
    with pytest.raises(InputError, match="none of the photos"):
        stream_of(folder, ["other.png"])
    with pytest.raises(InputError, match="31 times smaller"):
        stream_of(folder, reduce=31)
    for wrong in ({"memory_bytes": 0}, {"reduce": 0}, {"uses": 0}, {"window_px": 0}):
        with pytest.raises(ValueError, match="expected 1 or more"):
            StreamSettings(**wrong)


def test_only_named_photos_come_up(folder):
    with stream_of(folder, ["p01.png", "p04.png"]) as stream:
        assert [photo.name for photo in stream.photos] == ["p01.png", "p04.png"]
        draws = generator()
        assert {stream.sample(draws).number for _ in range(8)} == {0, 1}


@pytest.mark.parametrize("sizes", [[10] * 7, [10, 1, 1, 1, 1, 1], [5, 6, 7, 8, 9, 10, 1, 2, 3, 4], [10]])
def test_every_photo_comes_up_equally_often_and_no_more_are_at_hand_than_fit(sizes):
    order, draws, rounds = PhotoOrder(sizes, 20, 3), generator(), 8
    uses = 1 if order.all_fit else 3
    for _ in range(rounds * uses * len(sizes)):
        order.look_ahead(len(order.upcoming) + 1, draws)
        assert sum(sizes[k] for k in order._at_hand) <= 20
    seen = [order.upcoming.count(k) for k in range(len(sizes))]
    assert max(seen) <= (rounds + 1) * uses
    assert min(seen) >= (rounds - 1) * uses
    if order.all_fit:
        assert seen == [rounds] * len(sizes)
        assert sorted(order.upcoming[: len(sizes)]) == [*range(len(sizes))]


def test_intrinsics_of_whole_photos_are_kept(folder):
    with stream_of(folder) as stream:
        view = stream.frame(0).view
    assert Intrinsics(view.width_px, view.height_px, view.fx_px, view.fy_px, view.cx_px, view.cy_px) == LENS
