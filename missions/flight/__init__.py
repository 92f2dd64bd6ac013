"""Flights that were flown: where the aircraft was, what it photographed, and how that compares with the plan."""
