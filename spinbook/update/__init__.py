"""`spinbook update`: a newer handout, with the student's work kept."""
