"""Use cases of flying: a sortie on a link or in simulation, what the pilot reads, and the report afterwards."""
