"""Flight logs of autopilots and ground stations, read into flight records."""
