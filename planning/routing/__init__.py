"""Routing: the order in which viewpoints are visited, and how they are shared out among sorties.

Everything here works on matrices of travel times or lengths between points; where the legs run is decided elsewhere.
"""
