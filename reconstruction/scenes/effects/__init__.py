"""Effects of photographs of glass: each decides from scene and flight whether it is worth its cost."""
