"""Fronto-parallel views of facades: planes, cylinders, and the maps between a photo and the unrolled facade."""
