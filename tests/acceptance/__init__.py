"""A user's whole day in the real window, by mouse and keyboard alone."""
