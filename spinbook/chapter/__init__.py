"""A chapter: Markdown read, every code fence classified, cells in order."""
