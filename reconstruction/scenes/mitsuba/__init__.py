"""The same scenes rendered by Mitsuba 3, as the judge of our renderer."""
