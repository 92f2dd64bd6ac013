"""Sites: panels, building, obstacles and airspace; their files, imports, and the space an aircraft may fly in."""
