"""Use cases of training: what is asked, the process that trains and renders, and what the window is told of it."""
