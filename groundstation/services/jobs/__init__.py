"""Long work: jobs on threads, and the process in which planning runs."""
