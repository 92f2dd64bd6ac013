"""The mission, before any file format: built from a plan, resumed, and read back as a plan."""
