"""Use cases of rendered photos: of a viewpoint, of a flight, and what accuracy costs there."""
