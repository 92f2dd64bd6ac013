from __future__ import annotations

import io
import os
import zipfile
from pathlib import Path

import pytest

from missions.formats.registry import read_missions
from missions.mission.safe_files import MAX_FILE_BYTES, MAX_MEMBERS
from planning.base.errors import InputError, MissionError


def kmz(path: Path, members: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


@pytest.mark.slow
def test_zip_bomb_is_refused_without_being_inflated_whole(tmp_path: Path) -> None:
    path = kmz(tmp_path / "bomb.kmz", {"wpmz/waylines.wpml": b"<" * (MAX_FILE_BYTES + 1)})
    assert path.stat().st_size < MAX_FILE_BYTES / 500
    with pytest.raises(MissionError, match="inflates to more than 64 MiB; refused as hostile"):
        read_missions(path)


@pytest.mark.slow
def test_bomb_that_lies_about_its_size_is_refused(tmp_path: Path) -> None:
    path = kmz(tmp_path / "liar.kmz", {"wpmz/waylines.wpml": b"<" * (MAX_FILE_BYTES + 1)})
    with zipfile.ZipFile(path) as archive:
        true_size = archive.getinfo("wpmz/waylines.wpml").file_size
    content = path.read_bytes().replace(true_size.to_bytes(4, "little"), (100).to_bytes(4, "little"))
    path.write_bytes(content)
    with pytest.raises(MissionError):
        read_missions(path)


@pytest.mark.parametrize("name", ["../evil.sh", "/etc/passwd", "wpmz/../../evil", "C:/evil", "wpmz\\..\\..\\evil"])
def test_paths_that_lead_out_of_the_archive_are_refused(tmp_path: Path, name: str) -> None:
    path = kmz(tmp_path / "escape.kmz", {"wpmz/waylines.wpml": b"<kml/>", name: b""})
    with pytest.raises(MissionError, match="leads out of it; refused as hostile"):
        read_missions(path)


def test_too_many_members_and_doubled_members_are_refused(tmp_path: Path) -> None:
    many = kmz(tmp_path / "many.kmz", {f"wpmz/res/{i}": b"" for i in range(MAX_MEMBERS + 1)})
    with pytest.raises(MissionError, match="holds 1001 files"):
        read_missions(many)
    double = tmp_path / "double.kmz"
    with zipfile.ZipFile(double, "w") as archive:
        archive.writestr("wpmz/waylines.wpml", b"<kml/>")
        with pytest.warns(UserWarning, match="Duplicate name"):
            archive.writestr("wpmz/waylines.wpml", b"<kml></kml>")
    with pytest.raises(MissionError, match="twice"):
        read_missions(double)


def test_encrypted_member_is_refused(tmp_path: Path) -> None:
    path = kmz(tmp_path / "locked.kmz", {"wpmz/waylines.wpml": b"<kml/>"})
    content = bytearray(path.read_bytes())
    for header, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        content[content.index(header) + offset] |= 1
    path.write_bytes(content)
    with pytest.raises(MissionError, match="encrypted"):
        read_missions(path)


@pytest.mark.parametrize(
    "xml",
    [
        b'<!DOCTYPE k [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]><kml>&b;</kml>',
        b'<!DOCTYPE k [<!ENTITY f SYSTEM "file:///etc/passwd">]><kml>&f;</kml>',
        b'<!DOCTYPE kml SYSTEM "http://example.org/kml.dtd"><kml/>',
    ],
)
def test_entities_and_dtds_are_refused(tmp_path: Path, xml: bytes) -> None:
    with pytest.raises(MissionError, match="refused as hostile"):
        read_missions(kmz(tmp_path / "entities.kmz", {"wpmz/waylines.wpml": xml}))
    view = tmp_path / "view.kml"
    view.write_bytes(xml)
    with pytest.raises(MissionError, match="refused as hostile"):
        read_missions(view)


def test_damaged_archives_are_refused_with_a_reason(tmp_path: Path) -> None:
    whole = kmz(tmp_path / "whole.kmz", {"wpmz/waylines.wpml": b"<kml/>" * 1000}).read_bytes()
    cut = tmp_path / "cut.kmz"
    cut.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(MissionError, match="damaged or no zip archive"):
        read_missions(cut)
    flipped = bytearray(whole)
    flipped[60] ^= 0xFF
    cut.write_bytes(flipped)
    with pytest.raises(MissionError, match=r"damaged|inflated"):
        read_missions(cut)


def test_archive_of_something_else_says_what_was_expected(tmp_path: Path) -> None:
    with pytest.raises(MissionError, match=r"expected wpmz/waylines\.wpml, found doc\.kml"):
        read_missions(kmz(tmp_path / "earth.kmz", {"doc.kml": b"<kml/>"}))
    with pytest.raises(MissionError, match="found nothing"):
        read_missions(kmz(tmp_path / "empty.kmz", {}))
    with pytest.raises(MissionError, match="template but no waylines"):
        read_missions(kmz(tmp_path / "template.kmz", {"wpmz/template.kml": b"<kml/>"}))
    with pytest.raises(MissionError, match=r"has mission/wpmz/waylines\.wpml; expected"):
        read_missions(kmz(tmp_path / "deep.kmz", {"mission/wpmz/waylines.wpml": b"<kml/>"}))


def test_file_too_large_or_not_a_file_is_refused(tmp_path: Path) -> None:
    large = tmp_path / "large.waypoints"
    with large.open("wb") as file:
        file.write(b"QGC WPL 110\n")
        file.truncate(MAX_FILE_BYTES + 10)
    with pytest.raises(InputError, match="more than 64 MiB"):
        read_missions(large)
    with pytest.raises(InputError, match="cannot be read"):
        read_missions(tmp_path / "missing.kmz")
    with pytest.raises(InputError, match="found a device or a pipe"):
        read_missions(Path(os.devnull))


def test_deeply_nested_xml_does_not_overflow(tmp_path: Path) -> None:
    depth = 200_000
    content = io.BytesIO(b"<a>" * depth + b"</a>" * depth).getvalue()
    with pytest.raises(MissionError):
        read_missions(kmz(tmp_path / "deep.kmz", {"wpmz/waylines.wpml": content}))
