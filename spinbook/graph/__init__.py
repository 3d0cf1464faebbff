"""The node graph: which nodes publish and subscribe, recorded by a process that takes no part itself."""
