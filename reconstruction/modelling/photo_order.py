"""In which order photos are looked at, known some time ahead, so that they can be read before they are needed.

Where all photos fit into memory, each comes up once before any comes up again. Where they do not, some are at hand:
each sample is of a random one of them, and one that has been looked at a number of times makes room for the next one
of a round through all photos. So every photo is read once a round, one at a time and not all at once, and all are
looked at equally often.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch

State = dict[str, list[int]]


class PhotoOrder:
    """A random order that goes on for ever.

    Parameters
    ----------
    sizes
        Bytes of each photo in memory.
    room
        Bytes for those at hand; one is at hand always.
    uses
        Of a photo while it is at hand, where not all fit.
    """

    def __init__(self, sizes: Sequence[int], room: int, uses: int) -> None:
        self._sizes = tuple(sizes)
        self.all_fit = sum(sizes) <= room
        self._room = room
        self._uses = 1 if self.all_fit else uses
        self._left: list[int] = []
        self._at_hand: dict[int, int] = {}
        self.upcoming: list[int] = []

    def look_ahead(self, n: int, generator: torch.Generator) -> None:
        """Draw until `n` samples are known in advance."""
        while len(self.upcoming) < n:
            self._fill(generator)
            drawn = int(torch.randint(len(self._at_hand), (), generator=generator))
            number = [*self._at_hand][drawn]
            self.upcoming.append(number)
            self._at_hand[number] -= 1
            if not self._at_hand[number]:
                del self._at_hand[number]

    def needed(self) -> list[int]:
        """Photos that come up again for certain, the soonest first."""
        return [*dict.fromkeys([*self.upcoming, *self._at_hand])]

    def _fill(self, generator: torch.Generator) -> None:
        """Take photos to hand while there is room; where all fit, a new round waits for the end of the last one."""
        if self.all_fit and self._at_hand:
            return
        while True:
            if not self._left:
                self._left = torch.randperm(len(self._sizes), generator=generator).tolist()
            number = self._left[0]
            if self._at_hand and not self.all_fit:
                at_hand = {*self._at_hand, number}
                if sum(self._sizes[each] for each in at_hand) > self._room:
                    return
            self._at_hand[number] = self._at_hand.get(number, 0) + self._uses
            del self._left[0]
            if self.all_fit and not self._left:
                return

    def state_dict(self) -> State:
        """What goes into a checkpoint."""
        return {
            "upcoming": [*self.upcoming],
            "left": [*self._left],
            "at_hand": [*self._at_hand],
            "uses_left": [*self._at_hand.values()],
        }

    def load_state_dict(self, state: State) -> None:
        """Go on from a checkpoint.

        Raises
        ------
        ValueError
            It is of other photos.
        """
        if not {*state["upcoming"], *state["left"], *state["at_hand"]} <= {*range(len(self._sizes))}:
            raise ValueError(f"state: expected photos 0 to {len(self._sizes) - 1}; it is of other photos")
        self.upcoming, self._left = [*state["upcoming"]], [*state["left"]]
        self._at_hand = dict(zip(state["at_hand"], state["uses_left"], strict=True))
