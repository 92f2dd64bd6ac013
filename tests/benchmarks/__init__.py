"""Benchmarks: one module each, run by `python -m tests.benchmarks`, written into docs/benchmarks.md."""
