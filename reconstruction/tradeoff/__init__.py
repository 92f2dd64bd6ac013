"""What accuracy costs in time: settings of searches, rendered photos and trainings, each turned for itself."""
