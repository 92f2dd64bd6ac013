from __future__ import annotations

from itertools import pairwise

import pytest

from missions.mavlink.transfer.exchange import Ending, RetryTimer, Timing

TIMING = Timing()


def begun() -> RetryTimer:
    patience = RetryTimer(TIMING)
    patience.begin(0.0)
    patience.ask(0.0)
    return patience


def answered(patience: RetryTimer, start_s: float, delay_s: float, n: int) -> float:
    """Let n questions be asked and answered after a delay each; returns the time."""
    for _ in range(n):
        patience.ask(start_s)
        start_s += delay_s
        patience.advance(start_s)
    return start_s


def test_repeats_come_later_and_later_up_to_a_second() -> None:
    patience, now_s, pauses = begun(), 0.0, []
    while patience.gave_up(now_s) is None:
        pauses.append(patience.next_deadline_s - now_s)
        now_s = patience.next_deadline_s
        patience.repeat(now_s)
    assert pauses[0] == TIMING.first_wait_s
    assert all(later >= earlier for earlier, later in pairwise(pauses[:-1]))
    assert max(pauses) == TIMING.longest_pause_s
    assert now_s == TIMING.silence_s


@pytest.mark.parametrize("delay_s", [0.001, 0.2, 0.45])
def test_wait_follows_the_delay_of_the_link(delay_s: float) -> None:
    patience = begun()
    now_s = answered(patience, 0.0, delay_s, 5)
    patience.ask(now_s)
    wait_s = patience.next_deadline_s - now_s
    assert wait_s == pytest.approx(max(TIMING.shortest_wait_s, 1.5 * delay_s))


def test_answers_that_come_late_after_a_loss_do_not_make_the_link_seem_slow() -> None:
    patience = begun()
    now_s = answered(patience, 0.0, 0.05, 3)
    now_s = answered(patience, now_s, 0.9, 1)
    patience.ask(now_s)
    assert patience.next_deadline_s - now_s < 0.2


def test_link_that_becomes_slower_than_the_wait_is_noticed() -> None:
    patience = begun()
    now_s = answered(patience, 0.0, 0.05, 3)
    for _ in range(100):
        patience.ask(now_s)
        deadline_s = now_s + 0.8
        while patience.next_deadline_s < deadline_s:
            patience.repeat(patience.next_deadline_s)
        now_s = deadline_s
        patience.advance(now_s)
    patience.ask(now_s)
    assert patience.next_deadline_s - now_s > 0.8


def test_answer_to_what_was_sent_before_says_nothing_of_the_delay() -> None:
    patience = begun()
    now_s = answered(patience, 0.0, 0.5, 3)
    patience.ask(now_s, is_new=False)
    patience.advance(now_s + 0.001)
    patience.ask(now_s + 0.001)
    assert patience.next_deadline_s - now_s > 0.7


def test_silence_and_standstill_are_told_apart() -> None:
    patience = begun()
    assert patience.gave_up(14.9) is None
    assert patience.gave_up(15.0) is Ending.SILENT
    for second in range(0, 60, 5):
        patience.hear(float(second))
    assert patience.gave_up(59.9) is None
    assert patience.gave_up(60.0) is Ending.STALLED


def test_slow_link_is_given_as_many_repeats_before_it_counts_as_silent() -> None:
    patience = begun()
    now_s = answered(patience, 0.0, 1.6, 3)
    assert patience.gave_up(now_s + 30.0) is None
    assert patience.gave_up(now_s + 36.1) is Ending.SILENT


def test_busy_vehicle_is_asked_again_each_second_for_some_time() -> None:
    patience = begun()
    assert all(patience.asks_again(float(second)) for second in range(10))
    assert patience.next_deadline_s == 10.0
    assert not patience.asks_again(10.0)
