"""Scenes with known truth: what stands there, what it is made of, and photographs of it."""
