"""A rendering of many photos: its jobs, its workers, and the folder that they fill."""
