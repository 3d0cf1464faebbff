"""`spinbook handout`: what students get, as a folder and as one zip."""
