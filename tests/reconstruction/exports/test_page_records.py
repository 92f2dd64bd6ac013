"""Records and pictures of web pages: what is shown, what panes are coloured by, what is refused."""

import struct
import zlib

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from reconstruction.exports.page_records import LONGEST_PX, by_object, columns_of, size_m, small_jpeg
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

ELEMENTS = [element for _, element in synthetic_scene().elements]
A, B = ELEMENTS[0].global_id, ELEMENTS[1].global_id
KNOWN = frozenset({A, B})


def columns(*rows):
    found, _ = by_object(rows, KNOWN)
    return {(each.name, each.unit): each for each in columns_of(ELEMENTS, found)}


def attribute(global_id, name, value, kind="text", unit=""):
    return {"global_id": global_id, "record": "attribute", "name": name, "value": value, "type": kind, "unit": unit}


def defect(global_id, severity, status="open"):
    return {"global_id": global_id, "record": "defect", "kind": "crack", "severity": severity, "status": status}


def test_attributes_become_columns_by_name_type_and_unit():
    found = columns(
        attribute(A, "thickness", 8, "number", "mm"),
        attribute(B, "thickness", 8.5, "number", "mm"),
        attribute(A, "installed_on", "2020-01-31", "date"),
        attribute(B, "tempered", True, "yes/no"),
    )
    assert found["thickness", "mm"].values[:3] == (8, 8.5, None)
    assert found["installed_on", ""].type == "date"
    assert found["tempered", ""].type == "yes/no"
    assert found["tempered", ""].values[1] is True


def test_inspections_defects_and_maintenance_come_to_one_value_a_pane():
    found = columns(
        {"global_id": A, "record": "inspection", "date": "2025-03-01"},
        {"global_id": A, "record": "inspection", "date": "2026-03-01"},
        {"global_id": A, "record": "inspection", "date": "2024-03-01"},
        defect(A, 2),
        defect(A, 4),
        defect(A, 5, "repaired"),
        defect(B, 1, "repaired"),
        {"global_id": B, "record": "maintenance", "date": "2026-01-01", "work": "cleaned", "next_due": "2027-01-01"},
    )
    assert found[":last_inspection", ""].values[:2] == ("2026-03-01", None)
    assert found[":worst_defect", ""].values[:2] == (4, None)
    assert found[":open_defects", ""].values[:2] == (2, None)
    assert found[":next_due", ""].values[:2] == (None, "2027-01-01")


def test_without_records_only_sizes_are_left():
    assert list(columns()) == [(":width", "m"), (":height", "m")]
    assert size_m(ELEMENTS[0].corners_enu_m) == pytest.approx((1.35, 1.8))


def test_records_of_objects_that_are_not_there_are_counted_and_left_out():
    found, n_strays = by_object([defect("elsewhere", 1), defect(A, 1)], KNOWN)
    assert (list(found), n_strays) == ([A], 1)
    assert found[A] == [{"record": "defect", "kind": "crack", "severity": 1, "status": "open"}]


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"record": "defect"}, "record 1: global_id"),
        ({"global_id": 7, "record": "defect"}, "record 1: global_id"),
        ({"global_id": A, "record": "spell"}, "record 1: record: expected one of attribute"),
        (attribute(A, "x", float("nan")), "record 1: value: expected a finite number"),
        (attribute(A, "x", 10**400), "record 1: value: expected a finite number"),
        (attribute(A, "x", {"a": 1}), "record 1: value: expected a text.*dict"),
        (attribute(A, "x", [[0.1, float("inf")]]), "record 1: value: expected"),
        (attribute(A, "x", "y" * 20_001), "at most 20000 characters"),
        ({"global_id": A, "record": "defect", **{f"f{i}": 1 for i in range(64)}}, "66 fields"),
    ],
)
def test_what_no_page_can_show_is_refused(row, message):
    with pytest.raises(InputError, match=message):
        by_object([row], KNOWN)


def picture(width, height, ending=".png"):
    pixels = np.random.default_rng(0).integers(0, 256, (height // 8 + 1, width // 8 + 1, 3), dtype=np.uint8)
    return cv2.imencode(ending, cv2.resize(pixels, (width, height)))[1].tobytes()


@pytest.mark.few(1)
@pytest.mark.parametrize("ending", [".png", ".jpg", ".webp"])
def test_pictures_are_made_small_and_anew(ending):
    content = picture(2000, 1000, ending)
    if ending == ".jpg":
        secret = b"Exif\0\0 secret place"
        content = content[:2] + b"\xff\xe1" + struct.pack(">H", len(secret) + 2) + secret + content[2:]
    found = small_jpeg("a", content)
    assert b"secret" not in found
    assert cv2.imdecode(np.frombuffer(found, np.uint8), 1).shape == (LONGEST_PX // 2, LONGEST_PX, 3)
    assert found == small_jpeg("a", content)
    tiny = cv2.imdecode(np.frombuffer(small_jpeg("a", picture(30, 20, ending)), np.uint8), 1)
    assert tiny.shape == (20, 30, 3)


def png_of(width, height):
    head = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + head + struct.pack(">I", zlib.crc32(head))


def webp_of(kind, start):
    chunk = kind + bytes(4) + start.ljust(20, b"\x00")
    return b"RIFF" + struct.pack("<I", len(chunk) + 4) + b"WEBP" + chunk


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "expected JPEG, PNG, WebP"),
        (b"<svg onload='alert(1)'/>", "expected JPEG, PNG, WebP"),
        (b"GIF89a" + bytes(20), "expected JPEG, PNG, WebP"),
        (png_of(60_000, 60_000), "60000 x 60000"),
        (webp_of(b"VP8X", bytes(4) + b"\xff\xff\xff" * 2), "16777216 x 16777216"),
        (webp_of(b"VP8L", b"\x2f\xff\xff\xff\xff"), "16384 x 16384"),
        (webp_of(b"VP8 ", bytes(3) + b"\x9d\x01\x2a" + b"\xff\xff" * 2), "16383 x 16383"),
        (webp_of(b"ALPH", b""), "expected JPEG"),
        (png_of(0, 5), "0 x 5"),
        (png_of(10, 10), "cut off or damaged"),
        (b"\xff\xd8\xff\xe0", "expected JPEG, PNG, WebP"),
        (b"\xff\xd8\xff\xc0\x00\x11\x08\xff\xff\xff\xff\x03", "65535 x 65535"),
    ],
)
def test_what_is_no_picture_is_refused(content, message):
    with pytest.raises(InputError, match=f"picture 'crack.jpg'.*{message}"):
        small_jpeg("crack.jpg", content)
