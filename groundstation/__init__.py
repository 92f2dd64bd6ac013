"""The ground station: use cases and jobs (`services`), command line (`cli`), window (`gui`)."""
