"""The ground station: use cases and jobs (`services`), command line (`cli`), window (`gui`), for programs `api`."""

__version__ = "0.1.0"
"""Of the whole distribution: the only place where it stands; the build reads it from here."""
