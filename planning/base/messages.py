"""Messages: what errors, findings, decisions and stages say, as a template with values.

A `Message` is its English text, with metric values, to everything that wants text: the command line, files, logs. It
also remembers what it was made from, so that whoever shows it says it in another language and in other units
(`groundstation.services.messages`). The template is the key that translators see, as in gettext: a new message is one
line of code, `say("home lies {:.1f} m below the ground", depth_m)`, and one entry in the translators' file.

Fields of a template are those of `str.format`, counted by themselves. A number with " m", " m/s", " mm", " km" or " m2"
behind it is a quantity with this unit; `{:m}` holds metres that no " m" follows, such as coordinates of a place. What
stands between single quotes is a name, and is never translated. A value may be a message itself, or an error.

An f-string of a message is plain text, in which nobody finds its parts again; `+`, `glue` and `joined` keep them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from string import Formatter
from typing import Any


class Message(str):
    """A text that knows its template and values.

    Parameters
    ----------
    template
        English, fields as `{0}`, `{1}` or `{2:m}`: what translators translate. Empty: `values` follow each other.
    values
        What stands in the fields: texts, numbers as they are written, or messages.
    place
        What it is about, before a colon: a file, a field, a sortie.
    """

    __slots__ = ("place", "template", "values")
    template: str
    values: tuple[str, ...]
    place: str

    def __new__(cls, text: str, template: str, values: tuple[str, ...], place: str = "") -> Message:
        """See the class."""
        message = super().__new__(cls, text)
        message.template, message.values, message.place = template, values, place
        return message

    def __reduce__(self) -> tuple[type[Message], tuple[str, str, tuple[str, ...], str]]:
        return Message, (str.__str__(self)[:], self.template, self.values, self.place)

    def __str__(self) -> str:
        """Itself, so that the text of an error still knows what it was made from."""
        return self

    def __add__(self, other: str) -> Message:
        return glue(self, other)

    def __radd__(self, other: str) -> Message:
        return glue(other, self)


@lru_cache(maxsize=4096)
def _parsed(template: str) -> tuple[str, tuple[tuple[str, str], ...], str]:
    """The key of a template, its fields as (text before it, format), and the text behind the last."""
    key, behind = "", ""
    fields: list[tuple[str, str]] = []
    for literal, name, spec, conversion in Formatter().parse(template):
        if name is None:
            behind = literal
            key += literal
        elif name or conversion:
            raise ValueError(f"expected fields without name or conversion, got {template!r}")
        else:
            mark = ":m" if (spec or "").endswith("m") else ""
            key += f"{literal}{{{len(fields)}{mark}}}"
            fields.append((literal, spec or ""))
    return key, tuple(fields), behind


def key_of(template: str) -> str:
    """What translators see of a template: fields as `{0}`, `{1}`, and `{2:m}` for metres."""
    return _parsed(template)[0]


def say(template: str, *values: object, place: object = "") -> Message:
    """A message from a template and the values of its fields.

    Raises
    ------
    ValueError
        Not as many values as fields.
    """
    key, fields, behind = _parsed(template)
    if len(values) != len(fields):
        raise ValueError(f"expected {len(fields)} values for {template!r}, got {len(values)}")
    texts = tuple(_text(value, spec) for value, (_, spec) in zip(values, fields, strict=True))
    body = "".join(f"{literal}{text}" for (literal, _), text in zip(fields, texts, strict=True)) + behind
    where = _text(place, "")
    return Message(f"{where}: {body}" if where else body, key, texts, where)


def _text(value: object, spec: str) -> str:
    if isinstance(value, Message):
        return value
    if isinstance(value, BaseException):
        return str(value)
    return format(value, spec.removesuffix("m")) if not isinstance(value, str) or spec.removesuffix("m") else value


def glue(*parts: object) -> Message:
    """Parts one after the other, each of which stays what it is."""
    texts = tuple(text for text in (_text(part, "") for part in parts) if text)
    return Message("".join(texts), "", texts)


def joined(separator: str, parts: Iterable[object]) -> Message:
    """Parts with a separator between them, such as "; "; see `glue`."""
    between: list[object] = []
    for part in parts:
        between += [separator, part] if between else [part]
    return glue(*between)


def first_few(names: Sequence[object], most: int) -> Message:
    """Names with commas between them; "..." stands for those behind the first few."""
    return joined(", ", (*names[:most], *(["..."] if len(names) > most else [])))


def packed(text: str) -> Any:
    """A text as JSON can hold it on its way from another process, a message with its parts; see `unpacked`."""
    if not isinstance(text, Message):
        return text
    return [plain(text), text.template, [packed(value) for value in text.values], packed(text.place)]


def unpacked(content: Any) -> str:
    """The text that was `packed`."""
    if isinstance(content, str):
        return content
    text, template, values, place = content
    return Message(text, template, tuple(map(unpacked, values)), unpacked(place))


def plain(text: str) -> str:
    """A text that is nothing but text, for what asks for exactly that."""
    return "".join(iter(text))


def about(place: object, text: object) -> Message:
    """A text or an error that says what it is about before a colon; another one it has comes behind."""
    body, where = _text(text, ""), _text(place, "")
    if not where:
        return glue(body)
    if isinstance(body, Message) and body.template:
        inner = glue(where, ": ", body.place) if body.place else where
        return Message(f"{where}: {body}", body.template, body.values, inner)
    return glue(where, ": ", body)


def without_place(text: str, place: object) -> str:
    """A text without the place that it begins with."""
    start = f"{_text(place, '')}: "
    if not text.startswith(start):
        return text
    if isinstance(text, Message) and text.template and text.place:
        inner = text.place.removeprefix(start.removesuffix(": ")).removeprefix(": ")
        return Message(text[len(start) :], text.template, text.values, inner)
    if isinstance(text, Message) and text.values[0] == start.removesuffix(": "):
        return glue(*text.values[2:])
    return text[len(start) :]
