"""Live telemetry of a flying vehicle. This layer holds no code yet: it comes with the flight itself."""
