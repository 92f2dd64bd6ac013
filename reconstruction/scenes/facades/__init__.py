"""Made-up photos of glass facades with their truth: what tests and scores of the segmentation are measured on."""
