"""Records in IFC files: read, extended, and written anew."""
