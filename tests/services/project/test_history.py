"""Undo and redo behave like a list with a place in it, whatever the user does."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.project.session import MAX_STEPS, History

ACTIONS = st.lists(st.one_of(st.just("undo"), st.just("redo"), st.just("amend"), st.integers(0, 99)), max_size=60)


class SlowHistory:
    """The same in the plainest way: everything to the left, everything to the right."""

    def __init__(self, value):
        self.left, self.value, self.right = [], value, []

    def change(self, value):
        self.left.append(self.value)
        self.value, self.right = value, []

    def undo(self):
        if self.left:
            self.right.insert(0, self.value)
            self.value = self.left.pop()

    def redo(self):
        if self.right:
            self.left.append(self.value)
            self.value = self.right.pop(0)


@given(ACTIONS)
def test_history_agrees_with_two_plain_stacks(actions):
    history, slow = History(-1), SlowHistory(-1)
    for number, action in enumerate(actions):
        if action == "undo":
            history.undo()
            slow.undo()
        elif action == "redo":
            history.redo()
            slow.redo()
        elif action == "amend":
            history.amend(1000 + number)
            slow.value = 1000 + number
        else:
            history.change(f"set {action}", action)
            slow.change(action)
        assert history.value == slow.value
        assert bool(history.undo_label) == bool(slow.left)
        assert bool(history.redo_label) == bool(slow.right)


def test_labels_name_what_would_be_taken_back_and_done_again():
    history = History(0)
    history.change("one", 1)
    history.change("two", 2)
    history.undo()
    assert (history.undo_label, history.redo_label) == ("one", "two")


def test_only_so_many_steps_are_kept_and_the_newest_are():
    history = History(0)
    for value in range(1, 2 * MAX_STEPS):
        history.change("step", value)
    for _ in range(3 * MAX_STEPS):
        history.undo()
    assert history.value == 2 * MAX_STEPS - 1 - MAX_STEPS


def test_a_step_needs_a_label():
    with pytest.raises(ValueError, match="label"):
        History(0).change("", 1)
