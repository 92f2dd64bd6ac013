"""Photos of virtual scenes: cameras, rendering, and folders of photos with their truth."""
