"""The map: shapes of site and plan, offline tiles, and Web Mercator."""
