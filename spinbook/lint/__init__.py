"""`spinbook lint`: what will not run in the chapters, and why, without running anything."""
