"""One module a command: `add_parser(subparsers)` describes it, its `run(options)` returns the exit status.

Heavy imports belong inside `run`, so that `-h` answers at once.
"""
