"""The recorded node graph: who publishes and who subscribes, seen by a process that takes no part itself."""
