"""What a list of photos shows of each: its picture's file, where it was taken, and what is wrong with it."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from groundstation.services.photos.intake import PhotoIntake
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import PosedPhoto


class PhotoMark(StrEnum):
    """Why a photo may be no use."""

    UNREADABLE = "unreadable"
    CUT_OFF = "cut off"
    BLURRED = "blurred"
    DARK = "dark"
    BRIGHT = "bright"
    ALIKE = "alike"
    UNPOSED = "unposed"


CODES = {
    "photo-unreadable": PhotoMark.UNREADABLE,
    "photo-cut-off": PhotoMark.CUT_OFF,
    "photo-blurred": PhotoMark.BLURRED,
    "photo-dark": PhotoMark.DARK,
    "photo-bright": PhotoMark.BRIGHT,
    "photo-alike": PhotoMark.ALIKE,
}
"""Marks by the code of the finding that says so."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoCard:
    """One photo of a folder.

    Parameters
    ----------
    posed
        None where the photo does not say enough.
    """

    metadata: PhotoMetadata
    posed: PosedPhoto | None
    marks: tuple[PhotoMark, ...]

    @property
    def path(self) -> Path:
        """Of its file."""
        return self.metadata.path


def photo_cards(intake: PhotoIntake) -> tuple[PhotoCard, ...]:
    """All photos that could be read, in the order of time."""
    posed = {photo.path: photo for photo in intake.photos}
    marks: dict[str, set[PhotoMark]] = defaultdict(set)
    for finding in intake.findings:
        if finding.code in CODES:
            marks[finding.place].add(CODES[finding.code])
    cards = []
    for data in intake.metadata:
        found = marks[str(data.path)] | (set() if data.path in posed else {PhotoMark.UNPOSED})
        cards.append(PhotoCard(data, posed.get(data.path), tuple(mark for mark in PhotoMark if mark in found)))
    return tuple(cards)


def card_of_place(cards: tuple[PhotoCard, ...], place: str) -> int | None:
    """Number of the photo that a finding is about: findings name photos by path or by name; None for none."""
    for number, card in enumerate(cards):
        if place in (str(card.path), card.path.name) or (card.posed is not None and place == card.posed.name):
            return number
    return None
