"""Photos for tests: a small JPEG with EXIF by Pillow and XMP segments by hand, as the cameras lay them out."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping
from pathlib import Path

from PIL import Image

XMP_HEAD = b"http://ns.adobe.com/xap/1.0/\0"
EXTENDED_HEAD = b"http://ns.adobe.com/xmp/extension/\0"
DJI = "http://www.dji.com/drone-dji/1.0/"


def plain_jpeg(size=(64, 48)):
    buffer = io.BytesIO()
    Image.new("RGB", size, (90, 120, 150)).save(buffer, "JPEG")
    return buffer.getvalue()


PLAIN = plain_jpeg()


def exif_part(image=None, photo=None, gps=None, byte_order="<"):
    """EXIF segment content of tags by number."""
    exif = Image.Exif()
    exif.endian = byte_order
    exif.update(image or {})
    exif.get_ifd(0x8769).update(photo or {})
    exif.get_ifd(0x8825).update(gps or {})
    return exif.tobytes()


def gps_tags(lat_deg, lon_deg, altitude_m, below=None):
    def parts(degrees):
        size = abs(degrees)
        whole = int(size)
        minutes = int((size - whole) * 60.0)
        return float(whole), float(minutes), round((size - whole - minutes / 60.0) * 3600.0, 6)

    return {
        1: "S" if lat_deg < 0 else "N",
        2: parts(lat_deg),
        3: "W" if lon_deg < 0 else "E",
        4: parts(lon_deg),
        5: bytes([altitude_m < 0 if below is None else below]),
        6: abs(altitude_m),
    }


def packet(properties: Mapping[str, object], namespace=DJI, prefix="drone-dji", as_elements=False, extra=""):
    """XMP packet with properties as attributes or as elements."""
    if as_elements:
        attributes = ""
        body = "".join(f"<{prefix}:{name}>{value}</{prefix}:{name}>\n" for name, value in properties.items())
    else:
        attributes = "".join(f'\n{prefix}:{name}="{value}"' for name, value in properties.items())
        body = ""
    return (
        '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>\n<x:xmpmeta xmlns:x="adobe:ns:meta/">'
        '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        f'<rdf:Description rdf:about="photo" xmlns:{prefix}="{namespace}"{attributes}{extra}>{body}</rdf:Description>'
        '</rdf:RDF></x:xmpmeta>\n<?xpacket end="w"?>'
    )


def segment(content: bytes, marker=0xE1):
    return bytes((0xFF, marker)) + (len(content) + 2).to_bytes(2, "big") + content


def extended_segments(text: str, piece=2000):
    """Segments of an extended packet, and the identifier that the main packet names it by."""
    content = text.encode()
    identifier = hashlib.md5(content, usedforsecurity=False).hexdigest().upper().encode()
    pieces = []
    for offset in range(0, len(content), piece):
        place = len(content).to_bytes(4, "big") + offset.to_bytes(4, "big")
        pieces.append(segment(EXTENDED_HEAD + identifier + place + content[offset : offset + piece]))
    return pieces, identifier.decode()


def jpeg(exif=b"", xmp=None, further=(), base=PLAIN):
    """A JPEG with these parts; `further` are whole segments."""
    parts = [segment(exif)] if exif else []
    parts += [] if xmp is None else [segment(XMP_HEAD + xmp.encode())]
    return base[:2] + b"".join([*parts, *further]) + base[2:]


def save(path: Path, content: bytes) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    return path
