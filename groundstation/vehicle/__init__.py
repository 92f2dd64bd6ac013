"""A flying vehicle: its telemetry, the list before take-off, and one sortie from upload to landing. Knows no Qt."""
