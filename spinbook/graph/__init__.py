"""The node graph as it really is: who publishes and who subscribes, seen by a process that takes no part itself."""
