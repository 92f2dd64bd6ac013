"""WPML as text: elements in the order given, indented, with one way of writing numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

VERSION = "1.0.6"
"""Of all files that Pilot 2 and FlightHub 2 have written since 2024."""

Node = tuple[str, "str | Sequence[Node]"]
"""An element: its name without the wpml prefix, and its text or its children."""

_PLAIN_KML = {"Document", "Folder", "Placemark", "Point", "coordinates"}


def render(document: Node) -> str:
    """A whole file around its Document element."""
    namespaces = f'xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/{VERSION}"'
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<kml {namespaces}>", *_lines(document, "  "), "</kml>", ""]
    return "\n".join(lines)


def _lines(node: Node, indent: str) -> Iterator[str]:
    name, content = node
    tag = name if name in _PLAIN_KML else f"wpml:{name}"
    if isinstance(content, str):
        yield f"{indent}<{tag}>{escape(content)}</{tag}>"
        return
    yield f"{indent}<{tag}>"
    for child in content:
        yield from _lines(child, indent + "  ")
    yield f"{indent}</{tag}>"


def number(value: float, decimals: int) -> str:
    """A number with at most `decimals` decimals and nothing superfluous, never "-0"."""
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
