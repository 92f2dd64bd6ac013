"""Missions: what an aircraft is told, in DJI's and MAVLink's words, written from plans and read back into them."""
