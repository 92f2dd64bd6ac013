"""XMP packets: properties by namespace and name, whether they stand as attributes or as elements (ISO 16684-1).

Also what the makers of drones write there.

Cameras write packets that are not well-formed: the XT S declares a namespace twice and does not close its last
instruction. Such packets are searched for properties piece by piece instead. Document types are refused in both ways,
so that no entity is ever expanded.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.etree.ElementTree import Element
from xml.sax.saxutils import unescape

from planning.base.errors import InputError
from planning.base.files import HostileXml, parse_xml

RDF = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
XMLNS = "xmlns"

Properties = dict[tuple[str, str], str]
"""Text by namespace and name; a field of a structure is `Structure/Field`."""

MAX_DEPTH = 6
MAX_PROPERTIES = 5000

MAX_SCANNED_CHARACTERS = 2**18
"""Of a packet that is not well-formed; the main packet of a photo fits into a segment of 64 KiB."""

_NAME = r"(?<![\w.-])([A-Za-z_][\w.-]{0,63}):([A-Za-z_][\w.-]{0,63})"
_ATTRIBUTE = re.compile(_NAME + r"""\s{0,8}=\s{0,8}(?:"([^"<]{0,4096})"|'([^'<]{0,4096})')""")
_ELEMENT = re.compile(rf"<{_NAME}>([^<]{{0,4096}})</")


def read_xmp(packet: bytes) -> Properties:
    """Properties of a packet; none where it is no XMP."""
    content = packet.strip(b"\0 \t\r\n")
    try:
        root = parse_xml(content, "XMP")
    except (HostileXml, InputError):
        return {}
    except ValueError:
        return _scanned(content)
    found: Properties = {}
    for description in root.iter(f"{{{RDF}}}Description"):
        for key, text in _of_node(description, "", 0):
            if len(found) >= MAX_PROPERTIES:
                return found
            found.setdefault(key, text)
    return found


def _of_node(node: Element, path: str, depth: int) -> Iterator[tuple[tuple[str, str], str]]:
    """Properties in attributes and child elements of a node."""
    for name, text in node.attrib.items():
        namespace, local = _split(name)
        if namespace not in ("", RDF):
            yield (namespace, path + local), text.strip()
    if depth >= MAX_DEPTH:
        return
    for child in node:
        namespace, local = _split(child.tag)
        if namespace == RDF:  # Description, Seq, li: they hold, but are no part of a name
            if local != "Description" or depth > 0:
                yield from _of_node(child, path, depth + 1)
            continue
        text = (child.text or "").strip()
        if text:
            yield (namespace, path + local), text
        yield from _of_node(child, f"{path}{local}/", depth + 1)


def _split(name: str) -> tuple[str, str]:
    if name.startswith("{"):
        namespace, _, local = name[1:].partition("}")
        return namespace, local
    return "", name


def _scanned(content: bytes) -> Properties:
    """Properties of a packet that is not well-formed, without structures."""
    text = content.decode("utf-8", "replace")[:MAX_SCANNED_CHARACTERS]
    if "<!" in text:
        return {}
    pairs = [(m[1], m[2], m[3] if m[3] is not None else m[4]) for m in _ATTRIBUTE.finditer(text)]
    namespaces = {name: value for prefix, name, value in pairs if prefix == XMLNS}
    pairs += [(m[1], m[2], m[3]) for m in _ELEMENT.finditer(text)]
    found: Properties = {}
    for prefix, name, value in pairs[:MAX_PROPERTIES]:
        namespace = namespaces.get(prefix)
        if namespace not in (None, RDF) and value.strip():
            found.setdefault((str(namespace), name), unescape(value.strip()))
    return found


# XMP properties by their name: makers' namespaces vary between their own models, names hardly do.

MAKERS = ("dji", "parrot", "skydio", "autel")
"""Parts of drone makers' namespaces; where several namespaces have a property, theirs goes first."""

PIX4D_CAMERA = "pix4d.com/camera"
"""Part of the namespace of Pix4D's camera tags, which Parrot and Autel write, too."""

MAX_TEXT = 1000
"""Characters; the longest text of use is DewarpData with 150."""


class MakerXmp:
    """Properties of one photo, by name."""

    def __init__(self, properties: Properties) -> None:
        self._texts: dict[str, str] = {}
        self._pix4d = {key[1]: text for key, text in properties.items() if PIX4D_CAMERA in key[0].lower()}
        is_maker = {key: any(maker in key[0].lower() for maker in MAKERS) for key in properties}
        for key in sorted(properties, key=lambda key: not is_maker[key]):
            self._texts.setdefault(key[1], properties[key])
        self.is_skydio = any("skydio" in namespace for namespace, _ in properties)

    def text(self, *names: str) -> str | None:
        """The first of these properties that says something, without control characters and not without end."""
        found = next((text for name in names if (text := self._texts.get(name))), None)
        return None if found is None else "".join(c for c in found[:MAX_TEXT] if c.isprintable())

    def number(self, *names: str, low: float = -1e6, high: float = 1e6) -> float | None:
        """The first of these properties that is a number, with or without a sign or as a fraction, within a range."""
        return next((n for name in names if (n := number(self._texts.get(name), low, high)) is not None), None)

    def angle_deg(self, *names: str) -> float | None:
        """The first of these properties that is an angle."""
        return self.number(*names, low=-360.0, high=360.0)

    def pix4d(self, name: str, low: float = -360.0, high: float = 360.0) -> float | None:
        """A number among Pix4D's camera tags, whose names are too plain to be looked for in all namespaces."""
        return number(self._pix4d.get(name), low, high)


def number(text: str | None, low: float, high: float) -> float | None:
    """A number or a fraction of two, within a range; None for anything else."""
    try:
        above, _, below = (text or "").partition("/")
        value = float(above) / float(below) if below else float(above)
    except (ValueError, ZeroDivisionError):
        return None
    return value if low <= value <= high else None
