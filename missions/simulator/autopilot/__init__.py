"""The simulated autopilot: schedulers, modes, failsafes, commands, and what it tells."""
