"""Use cases of missions: files, comparison with the plan, waypoints, and the flight brief."""
