"""How aircraft move: times of legs and turns, speed profiles, rounded corners."""
