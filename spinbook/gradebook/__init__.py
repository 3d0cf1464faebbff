"""The gradebook of a course, from the results of its exercises."""
