"""Use cases, jobs and settings of the ground station; knows nothing of Qt."""
