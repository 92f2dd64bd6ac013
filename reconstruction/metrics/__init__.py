"""How good found panels are: the paper's three kinds of numbers, annotated photos, and other methods' masks."""
