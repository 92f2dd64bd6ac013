"""Methods that a model can be trained with."""
