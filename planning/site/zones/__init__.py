"""Geo-zones: where flights are prohibited, restricted or tied to conditions, as their publishers say it."""
