"""`spinbook import`: an existing book becomes a course."""
