"""What every part of the window shares: the context, languages and translation, imports and jobs on other threads."""
