"""DJI's wayline format (WPML): KMZ files with what the user edits (template) and what the aircraft flies (waylines)."""
