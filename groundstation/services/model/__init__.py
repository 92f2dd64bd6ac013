"""Use cases of finished models: objects, records, pictures, metrics and exports."""
