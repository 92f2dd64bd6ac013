"""Command line: one module a command, each a thin shell around a use case."""
