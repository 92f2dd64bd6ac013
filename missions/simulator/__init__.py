"""A simulated multirotor: flies missions over MAVLink as ArduPilot or PX4 would, with the effects a scene calls for."""
