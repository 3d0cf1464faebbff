"""`spinbook build`: chapters become notebooks, and notebooks are run."""
