"""Damaged and hostile photos: refused or read in part, never a crash, a hang or an expanded entity."""

import gc
import random
import struct
import time
import tracemalloc

import pytest

from planning.base.errors import InputError
from planning.photos.exif import Tag, read_exif
from planning.photos.metadata import MAX_PROPERTIES, read_photo, read_xmp
from reconstruction.photos.decode import picture_size
from tests.planning.photos.photo_writer import exif_part, extended_segments, gps_tags, jpeg, packet, save
from tests.slow import slow

LONGEST_S = 10.0
N_MUTANTS = 6_000

PROPERTIES = {
    "GpsLatitude": "+22.1", "GpsLongitude": "+114.1", "AbsoluteAltitude": "+12.5", "GimbalYawDegree": "+30.0",
    "GimbalPitchDegree": "-20.0", "GimbalRollDegree": "0.0", "RtkFlag": "50", "UTCAtExposure": "2024-05-01T08:00:01.5",
    "DewarpData": "2018-09-04;3666.6,3666.6,-27.0,11.5,-0.26,0.12,0,0,-0.04", "LRFTargetDistance": "12.0",
}  # fmt: skip


def whole_photo():
    pieces, identifier = extended_segments(packet({"RelativeAltitude": "7"}), 200)
    note = f' xmlns:n="http://ns.adobe.com/xmp/note/" n:HasExtendedXMP="{identifier}"'
    exif = exif_part(
        {0x010F: "DJI", 0x0112: 1}, {0x9003: "2024:05:01 10:00:00", 0x829A: 0.01}, gps_tags(22.1, 114.1, 9)
    )
    return jpeg(exif, packet(PROPERTIES, extra=note), pieces)


def mutants(content, n, seed):
    """Copies with bytes changed, pieces taken out, doubled or swapped, and ends cut off."""
    chance = random.Random(seed)
    lengths = (b"\xff\xff", b"\0\0", b"\xff\xd9", b"\xff\xe1", b"\x7f\xff\xff\xff", b"<", b'"', b"&", b"\0")
    for _ in range(n):
        made = bytearray(content)
        for _ in range(chance.randint(1, 4)):
            at, size = chance.randrange(len(made)), chance.randint(1, 40)
            match chance.choices(range(5), (12, 1, 1, 3, 1))[0]:
                case 0:
                    made[at] = chance.randrange(256)
                case 1:
                    made[at : at + size] = b""
                case 2:
                    made[at:at] = made[at : at + size]
                case 3:
                    made[at : at + 2] = chance.choice(lengths)
                case 4:
                    del made[max(20, at + 200) :]
            if len(made) < 20:
                break
        yield bytes(made)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, slow(1)])
def test_mutated_photos_are_read_or_refused_in_time(tmp_path, seed):
    path, n_read = tmp_path / "DJI_0001.JPG", 0
    for content in mutants(whole_photo(), N_MUTANTS // 2, seed):
        path.write_bytes(content)
        started = time.process_time()
        try:
            read_photo(path)
            n_read += 1
        except InputError:
            pass
        assert time.process_time() - started < LONGEST_S
    assert 0.2 * N_MUTANTS / 2 < n_read < N_MUTANTS / 2


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_mutated_packets_and_directories_give_values_of_the_right_kind(seed):
    for content in mutants(packet(PROPERTIES).encode(), N_MUTANTS // 2, seed):
        assert all(isinstance(text, str) for text in read_xmp(content).values())
    for content in mutants(whole_photo()[12:400], N_MUTANTS // 2, seed):
        assert all(isinstance(value, (str, tuple)) for value in read_exif(content).values())


def test_entities_are_never_expanded_nor_files_fetched(tmp_path):
    secret = save(tmp_path / "secret.txt", b"the secret")
    bombs = [
        '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>',
        f'<!DOCTYPE x [<!ENTITY a SYSTEM "{secret.as_uri()}">]>',
        '<!DOCTYPE x SYSTEM "http://127.0.0.1:9/x.dtd">',
    ]
    for bomb in bombs:
        text = packet(PROPERTIES | {"Make": "&a;"}).partition("?>")[2]
        assert read_xmp((bomb + text).encode()) == {}
        assert read_xmp((bomb + text.replace("</rdf:RDF>", "")).encode()) == {}  # nor where it is searched piecewise


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "text",
    [
        "<a>" * 100_000,
        "<a xmlns:p='q' " + "p:a='" * 50_000,
        "a" * 1_000_000 + ":b='c'",
        ("a" * 63 + ":") * 15_000,
        "<p:a>" * 200_000,
        "<rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'>" + "<rdf:Description>" * 20_000,
    ],
    ids=["deep", "quotes", "long", "colons", "elements", "nested"],
)
def test_packets_made_to_be_slow_are_not(text):
    # Deep packets make many objects; searching all that other tests left behind for garbage is not their fault.
    gc.disable()
    try:
        started = time.process_time()
        read_xmp(text.encode())
        read_xmp((text + "</x").encode())
        assert time.process_time() - started < LONGEST_S
    finally:
        gc.enable()


def test_packets_with_very_many_properties_are_cut():
    many = {f"P{number}": "1" for number in range(MAX_PROPERTIES + 500)}
    started = time.process_time()
    assert len(read_xmp(packet(many).encode())) == MAX_PROPERTIES
    deep = "<d:a>" * 900 + "1" + "</d:a>" * 900
    assert read_xmp(packet({}, prefix="d").replace("</rdf:D", deep + "</rdf:D").encode()) == {}
    nested = '<rdf:Description d:A="1">' * 400 + "</rdf:Description>" * 400
    assert len(read_xmp(packet({}, prefix="d").replace("</rdf:D", nested + "</rdf:D", 1).encode())) == 1
    assert time.process_time() - started < LONGEST_S


def test_directories_that_point_at_each_other_or_claim_gigabytes_cost_nothing():
    entries = [(0x8769, 4, 1, 8), (0x8825, 4, 1, 8), (0x010F, 2, 0xFFFFFFFF, 8), (0x829A, 5, 0x7FFFFFFF, 8)]
    body = b"".join(struct.pack("<HHII", *entry) for entry in entries) * 1300
    content = b"II*\0" + struct.pack("<IH", 8, 0xFFFF) + body
    tracemalloc.start()
    started = time.process_time()
    assert read_exif(content) == {}
    assert time.process_time() - started < LONGEST_S
    assert tracemalloc.get_traced_memory()[1] < 2**20
    tracemalloc.stop()


@pytest.mark.parametrize("kind", range(14))
@pytest.mark.parametrize("value", [0, 8, 0x7FC00000, 0x7F800000, 0x80000000, 0xFFFFFFFF])
def test_pointers_of_any_type_and_value_are_followed_or_not(kind, value):
    entries = struct.pack("<HHII", 0x8769, kind, 1, value) + struct.pack("<HHIHH", 0x0112, 3, 1, 6, 0)
    assert read_exif(b"II*\0" + struct.pack("<IH", 8, 2) + entries) == {Tag.ORIENTATION: (6.0,)}


def test_extended_xmp_of_any_size_is_not_kept(tmp_path):
    pieces, identifier = extended_segments("<!--" + "x" * 6_000_000 + "-->", 60_000)
    note = f' xmlns:n="http://ns.adobe.com/xmp/note/" n:HasExtendedXMP="{identifier}"'
    path = save(tmp_path / "x.jpg", jpeg(xmp=packet(PROPERTIES, extra=note), further=pieces))
    started = time.process_time()
    assert read_photo(path).gimbal_heading_deg == 30.0
    assert time.process_time() - started < LONGEST_S


def test_bytes_that_belong_to_no_segment_are_passed_over(tmp_path):
    exif = exif_part({0x010F: "KODAK"}, {0x920A: 6.0})
    content = jpeg(exif)
    end = 4 + int.from_bytes(content[4:6], "big")
    for number, stray in enumerate((b"\0", b"\x12\x34\x56", b"\xff\0" + bytes(500), b"\xff\xff")):
        path = save(tmp_path / f"{number}.jpg", content[:end] + stray + content[end:])
        photo = read_photo(path)
        assert (photo.make, photo.focal_length_mm, photo.width_px) == ("KODAK", 6.0, 64)
        assert picture_size(path.read_bytes()) == (64, 48)
    far = save(tmp_path / "far.jpg", content[:end] + bytes(70_000) + content[end:])
    with pytest.raises(InputError, match="damaged"):
        read_photo(far)
