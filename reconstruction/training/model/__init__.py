"""The joint model of splats and mirrored light: its parameters, files, pictures and metrics."""
