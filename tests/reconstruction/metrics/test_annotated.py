"""Annotated photos: the three forms as described, their faults told, and the real sets whole."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from reconstruction.metrics.sets import PhotoSet, annotated_set, cmp_photos, coco_photos, ecp_photos, folder_set

GREY = np.full((30, 40, 3), 128, np.uint8)


def write(path: Path, picture: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), picture)


def write_cmp(folder: Path, table: str = "x0,y0,x1,y1\n5,5,15,20\n20,5,30,20\n") -> Path:
    write(folder / "a.jpg", GREY)
    (folder / "a.windows.csv").write_text(table)
    return folder


def cmp_object(rows: tuple[float, ...], columns: tuple[float, ...], name: str = "window") -> str:
    """An object as the published files have it, lines ending as on old Macs; there x is the row and y the column."""
    points = [f"<{axis}>\r{value:.5g}\r</{axis}>" for axis, values in (("x", rows), ("y", columns)) for value in values]
    label = f"<label>\r3\r</label>\r<labelname>\r{name}\r</labelname>\r<flag>\r1\r</flag>"
    return f"<object>\r<points>\r{chr(13).join(points)}\r</points>\r{label}\r</object>\r"


def write_published_cmp(folder: Path, *objects: str) -> Path:
    write(folder / "a.jpg", GREY)
    write(folder / "a.png", GREY[..., 0])
    (folder / "a.xml").write_bytes("".join(objects).encode())
    return folder


def write_coco(folder: Path, content: object = None) -> Path:
    write(folder / "b_png_jpg.rf.123.jpg", GREY)
    polygon = [5, 5, 15, 5, 15, 20, 5, 20]
    content = content or {
        "images": [{"id": 1, "file_name": "b_png_jpg.rf.123.jpg"}],
        "categories": [{"id": 7, "name": "window"}, {"id": 8, "name": "car"}],
        "annotations": [
            {"image_id": 1, "category_id": 7, "segmentation": [polygon]},
            {"image_id": 1, "category_id": 8, "segmentation": [[0, 0, 9, 0, 9, 9]]},
        ],
    }
    (folder / "_annotations.coco.json").write_text(json.dumps(content))
    return folder


def write_ecp(folder: Path, size: tuple[int, int] = (30, 40)) -> Path:
    labels = np.zeros((*size, 3), np.uint8)
    labels[:] = (0, 255, 255)
    labels[5:20, 5:15] = labels[5:20, 20:30] = (0, 0, 255)
    write(folder / "image" / "c.jpg", GREY)
    write(folder / "ground_truth" / "c.png", labels)
    return folder


@pytest.mark.slow
def test_cmp_rectangles_become_numbered_windows(tmp_path: Path) -> None:
    (photo,) = cmp_photos(write_cmp(tmp_path))
    assert photo.name == "a"
    assert (photo.index == 1).sum() == (photo.index == 2).sum() == 150
    assert photo.index[5, 5] == 1
    assert photo.index[4, 5] == photo.index[5, 15] == 0


def test_published_cmp_objects_become_windows_with_rows_first(tmp_path: Path) -> None:
    windows = cmp_object((5 / 30, 20 / 30), (5 / 40, 15 / 40)), cmp_object((20 / 30, 5 / 30), (30 / 40, 20 / 40))
    other = cmp_object((0.0, 1.0), (0.0, 1.0), "facade"), cmp_object((0.8, 0.9), (0.1, 0.9), "sill")
    (published,) = cmp_photos(write_published_cmp(tmp_path / "xml", other[0], *windows, other[1]))
    (table,) = cmp_photos(write_cmp(tmp_path / "csv"))
    np.testing.assert_array_equal(published.index, table.index)
    content = (tmp_path / "xml" / "a.xml").read_bytes()
    (tmp_path / "xml" / "a.xml").write_bytes(b'<?xml version="1.0"?>\n<annotation>' + content + b"</annotation>")
    (with_root,) = annotated_set("cmp", tmp_path / "xml").photos()
    np.testing.assert_array_equal(with_root.index, table.index)
    # A table beside it counts.
    write_cmp(tmp_path / "xml", "x0,y0,x1,y1\n0,0,40,30\n")
    (by_table,) = cmp_photos(tmp_path / "xml")
    assert (by_table.index == 1).all()


@pytest.mark.parametrize(
    "content",
    [
        "",
        "<object><points>",
        cmp_object((0.1, 0.2), (0.1,)),
        cmp_object((0.1, 0.2, 0.3), (0.1, 0.2)),
        cmp_object((5.0, 20.0), (5.0, 15.0)),
        cmp_object((0.1, 0.2), (0.1, float("nan"))),
        "<!DOCTYPE a [<!ENTITY b 'c'>]>" + cmp_object((0.1, 0.2), (0.1, 0.2)),
    ],
)
def test_broken_published_objects_are_named(tmp_path: Path, content: str) -> None:
    with pytest.raises(InputError, match=r"a\.xml: expected objects with labelname and two x and y"):
        list(cmp_photos(write_published_cmp(tmp_path, content)))


def test_ecp_areas_of_red_become_windows(tmp_path: Path) -> None:
    (photo,) = ecp_photos(write_ecp(tmp_path))
    np.testing.assert_array_equal(np.bincount(photo.index.ravel()), [900, 150, 150])


def test_coco_polygons_of_windows_alone_become_windows(tmp_path: Path) -> None:
    (photo,) = coco_photos(write_coco(tmp_path))
    assert photo.name == "b"
    np.testing.assert_array_equal(np.bincount(photo.index.ravel()), [1050, 150])


@pytest.mark.parametrize("table", ["x0,y0\n1,2\n", "x0,y0,x1,y1\n1,2,three,4\n", "x0,y0,x1,y1\n1,2\n"])
def test_broken_table_of_rectangles_is_named(tmp_path: Path, table: str) -> None:
    with pytest.raises(InputError, match=r"a\.windows\.csv: expected columns x0, y0, x1, y1"):
        list(cmp_photos(write_cmp(tmp_path, table)))


@pytest.mark.parametrize("content", [[], {"images": []}, {"images": [{}], "categories": [], "annotations": []}])
def test_broken_annotations_are_named(tmp_path: Path, content: object) -> None:
    if not content:
        (tmp_path / "_annotations.coco.json").write_text("[1,")
    else:
        write_coco(tmp_path, content)
    words = "expected annotations in COCO's form|not valid JSON"
    with pytest.raises(InputError, match=rf"_annotations\.coco\.json: ({words})"):
        list(coco_photos(tmp_path))


def test_mask_of_another_size_or_without_windows_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has 30 x 30 pixels, its photo 40 x 30"):
        list(ecp_photos(write_ecp(tmp_path, (30, 30))))
    write(tmp_path / "ground_truth" / "c.png", GREY)
    with pytest.raises(InputError, match="windows painted red"):
        list(ecp_photos(tmp_path))


def test_photos_that_are_gone_or_broken_are_named(tmp_path: Path) -> None:
    folder = write_cmp(tmp_path)
    (folder / "a.jpg").write_bytes(b"\xff\xd8\xff\xe0 no picture")
    with pytest.raises(InputError, match=r"a\.jpg: the file ends in its header"):
        list(cmp_photos(folder))
    (folder / "a.jpg").write_bytes(b"")
    with pytest.raises(InputError, match="empty"):
        list(cmp_photos(folder))
    (folder / "a.jpg").unlink()
    with pytest.raises(InputError, match="cannot be read"):
        list(cmp_photos(folder))
    with pytest.raises(InputError, match="found none"):
        list(cmp_photos(folder / "nowhere"))


def test_own_folder_pairs_photos_and_index_images(tmp_path: Path) -> None:
    index = np.zeros((30, 40), np.uint16)
    index[:10] = 300
    write(tmp_path / "images" / "d.png", GREY)
    write(tmp_path / "truth" / "d.png", index)
    (photo,) = folder_set(tmp_path / "images", tmp_path / "truth").photos()
    np.testing.assert_array_equal(photo.index, index)
    assert photo.views is None
    (turned,) = folder_set(tmp_path / "images", tmp_path / "truth", is_rectified=True).photos()
    assert [(view.width_px, view.height_px) for view in turned.views] == [(40, 30)]
    write(tmp_path / "images" / "e.png", GREY)
    with pytest.raises(InputError, match="'e' has none"):
        folder_set(tmp_path / "images", tmp_path / "truth")
    write(tmp_path / "truth" / "e.png", GREY)
    with pytest.raises(InputError, match="colour image"):
        list(folder_set(tmp_path / "images", tmp_path / "truth").photos())
    write(tmp_path / "truth" / "e.png", index * 100)
    with pytest.raises(InputError, match="panel numbers up to 20000, got 30000"):
        list(folder_set(tmp_path / "images", tmp_path / "truth").photos())
    write(tmp_path / "truth" / "e.png", index[:20])
    with pytest.raises(InputError, match="40 x 20 pixels, but its photo has 40 x 30"):
        list(folder_set(tmp_path / "images", tmp_path / "truth").photos())
    write(tmp_path / "images" / "e.jpg", GREY)
    with pytest.raises(InputError, match="have one name"):
        folder_set(tmp_path / "images", tmp_path / "truth")


def windows_in(photos: PhotoSet) -> list[int]:
    return [len(np.unique(photo.index)) - 1 for photo in photos.photos()]


@pytest.mark.long
def test_real_cmp_photos_have_a_window_for_each_line_of_their_tables(shared_data: Path) -> None:
    photos = annotated_set("cmp", shared_data / "facades")
    tables = sorted((shared_data / "facades" / "cmp").glob("*.csv"))
    lines = [len(table.read_text().split()) - 1 for table in tables]
    counts = windows_in(photos)
    assert len(lines) == photos.n_photos > 0
    # A window annotated twice is seen once.
    assert all(0.95 * n <= count <= n for n, count in zip(lines, counts, strict=True))


@pytest.mark.slow
def test_real_cmp_photos_are_the_same_as_published(shared_data: Path, tmp_path: Path) -> None:
    for path in (shared_data / "facades" / "cmp").iterdir():
        if path.suffix in (".jpg", ".xml"):
            (tmp_path / path.name).symlink_to(path)
    tables = annotated_set("cmp", shared_data / "facades")
    published = annotated_set("cmp", tmp_path)
    assert published.photo_names == tables.photo_names
    for one, other in zip(published.photos(), tables.photos(), strict=True):
        np.testing.assert_array_equal(one.index, other.index)


@pytest.mark.slow
def test_real_ecp_photos_show_windows_where_their_masks_are_red(shared_data: Path) -> None:
    photos = annotated_set("ecp", shared_data / "facades")
    for photo in photos.photos():
        mask = cv2.imread(str(shared_data / "facades" / "ecp" / "ground_truth" / f"{photo.name}.png"))
        assert (photo.index > 0).sum() == (mask == (0, 0, 255)).all(axis=2).sum()
        assert 5 <= photo.index.max() <= 100
    assert photos.n_photos == 40


@pytest.mark.slow
def test_real_offices_have_a_window_for_each_polygon(shared_data: Path) -> None:
    folder = shared_data / "facades" / "offices_at_night"
    content = json.loads((folder / "_annotations.coco.json").read_text())
    n_polygons = sum(len(a["segmentation"]) for a in content["annotations"] if a["category_id"] == 10)
    counts = windows_in(annotated_set("offices", folder))
    assert len(counts) == 15
    assert 0.98 * n_polygons <= sum(counts) <= n_polygons
