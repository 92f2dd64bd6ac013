"""Every mission format behind one door."""
