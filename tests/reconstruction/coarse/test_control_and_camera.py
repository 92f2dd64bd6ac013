"""Control points and cameras that a user gives, as other programs write them."""

from __future__ import annotations

import json

import pytest

from planning.base.errors import InputError
from reconstruction.base.cameras import Intrinsics
from reconstruction.coarse.control_and_camera import read_control_points, read_lens

SIZES = {"a.jpg": (4000, 3000), "b.jpg": (4000, 3000)}


def test_a_list_of_opendronemap_is_read_in_its_coordinate_system(tmp_path):
    path = tmp_path / "gcp_list.txt"
    path.write_text("WGS84 UTM 32N\n500000 5300000 400 10 20 a.jpg one\n500000 5300000 400 30 40 b.jpg one\n")
    (point,) = read_control_points(path, SIZES)
    assert (point.name, point.lon_deg) == ("one", pytest.approx(9.0, abs=1e-6))
    assert point.lat_deg == pytest.approx(47.85, abs=0.05)
    assert point.seen == (("a.jpg", 10.0, 20.0), ("b.jpg", 30.0, 40.0))
    path.write_text("EPSG:32632\n1 2 three\n")
    with pytest.raises(InputError, match="line 2: expected 'X Y Z"):
        read_control_points(path, SIZES)


def test_points_of_opensfm_count_from_the_middle_of_the_picture(tmp_path, shared_data):
    (tmp_path / "gcp.json").write_text(
        json.dumps(
            {
                "points": [
                    {
                        "id": "0",
                        "position": {"latitude": 52.5, "longitude": 13.4, "altitude": 15.0},
                        "observations": [{"projection": [0.1, -0.2], "shot_id": "a.jpg"}],
                    },
                    {"id": "1", "observations": []},
                ]
            }
        )
    )
    (point,) = read_control_points(tmp_path / "gcp.json", SIZES)
    assert point.seen == (("a.jpg", pytest.approx(2400.0), pytest.approx(700.0)),)
    berlin = shared_data / "multiview" / "berlin"
    sizes = {f"{number:02d}.jpg": (3264, 2448) for number in (1, 2, 3)}
    assert len(read_control_points(berlin / "ground_control_points.json", sizes)) == 2


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("K.txt", "2905.88 0 1416 \n0 2905.88 1064\n0 0 1"),
        ("cameras.txt", "# list\n1 PINHOLE 2832 2128 2905.88 2905.88 1416 1064\n"),
        ("camera.toml", "fx_px = 2905.88\nimage_width_px = 2832\nimage_height_px = 2128\n"),
        (
            "plan.json",
            '{"camera": {"image_width_px": 2832, "image_height_px": 2128, "sensor_width_mm": 28.32, '
            '"focal_length_mm": 29.0588}}',
        ),
    ],
)
def test_a_camera_is_read_from_what_people_have(tmp_path, name, content):
    (tmp_path / name).write_text(content)
    lens = read_lens(tmp_path / name, {"a.jpg": (2832, 2128)})
    assert lens.fx_px == pytest.approx(2905.88)
    assert lens == Intrinsics(2832, 2128, lens.fx_px, lens.fy_px, 1416.0, 1064.0)


def test_what_is_no_camera_is_refused(tmp_path):
    (tmp_path / "camera.json").write_text('{"image_width_px": 100, "image_height_px": 100}')
    with pytest.raises(InputError, match="expected fx_px, or focal_length_mm"):
        read_lens(tmp_path / "camera.json", SIZES)
