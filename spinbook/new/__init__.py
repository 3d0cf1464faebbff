"""`spinbook new`: a small course of an author's own, or one more exercise, to start from."""
