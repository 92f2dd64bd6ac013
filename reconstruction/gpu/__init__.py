"""Graphics cards by WebGPU: shaders in WGSL, and what runs them. Nothing here knows of splats or photos."""
