"""MAVLink missions: items as ArduPilot and PX4 run them, and the files of QGroundControl and Mission Planner."""
