"""XMP properties by their name: makers' namespaces vary between their own models, names hardly do."""

from __future__ import annotations

from planning.photos.xmp import Properties

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
