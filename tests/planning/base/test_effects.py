"""Effects decide by their size in the scene; the user may overrule them; the decision says why."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from planning.base.effects import Assessment, Decision, EffectSetting, decide


@dataclass(frozen=True)
class Breeze:
    """An effect as large as its scene, which is a number."""

    name: str = "breeze"
    unit: str = "m"
    tolerance: float = 0.5

    def assess(self, scene: float) -> Assessment:
        return Assessment(scene, f"the air moves by {scene:g}", 2.0)


@pytest.mark.parametrize(("size", "on"), [(0.0, False), (0.5, False), (0.5001, True), (9.0, True)])
def test_the_scene_decides_by_what_is_more_than_the_tolerance(size: float, on: bool) -> None:
    decision = decide(Breeze(), size)
    assert (decision.on, decision.decided_by, decision.size, decision.tolerance) == (on, "scene", size, 0.5)


@pytest.mark.parametrize(("wish", "on"), [("on", True), ("off", False)])
@pytest.mark.parametrize("size", [0.0, 9.0])
def test_the_user_overrules_the_scene_and_still_reads_what_it_holds(wish: EffectSetting, on: bool, size: float) -> None:
    decision = decide(Breeze(), size, wish)
    assert (decision.on, decision.decided_by, decision.size) == (on, "user", size)
    assert f"the air moves by {size:g}" in decision.reason


def test_a_decision_reads_as_one_line() -> None:
    decision = Decision("breeze", True, "scene", "the air moves by 9", 9.0, 0.5, "m", 2.0)
    assert str(decision) == "breeze: on - the air moves by 9 (9 m, tolerance 0.5; costs about 2.0 s)"
    asked = decide(Breeze(), 9.0, "off")
    assert str(asked).startswith("breeze: off, as you asked - the air moves by 9")
