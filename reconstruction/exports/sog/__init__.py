"""SOG files (PlayCanvas)."""
