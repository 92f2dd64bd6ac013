"""The Photos tab: what the photos are worth, the panels found in them, and corrections by hand."""
