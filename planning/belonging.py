"""Whether photos, logs and missions belong to a site: limits that all of them share."""

from __future__ import annotations

MAX_DISTANCE_M = 5000.0
"""What never comes this close to the site is of another place: no facade is photographed from so far away."""

HEIGHT_DIFFERENCE_M = 2.0
"""Worth a word if both ways to count heights differ by more: receivers and barometers wander by less in a flight."""
