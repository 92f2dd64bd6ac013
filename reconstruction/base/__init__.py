"""What all of reconstruction stands on: cameras of photos, rays against meshes, files of tensors."""
