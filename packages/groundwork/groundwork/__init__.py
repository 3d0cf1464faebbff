"""What the grader and the generator share: an author's error, files that are written whole, and trusted programs."""
