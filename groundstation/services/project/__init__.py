"""Projects: the document with its history, and the folder that it is kept in."""
