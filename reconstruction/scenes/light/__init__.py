"""Light in virtual scenes: what rays meet, and what they bring."""
